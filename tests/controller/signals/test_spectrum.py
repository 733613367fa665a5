"""Two lines of a revolution's spectrum against numpy's transform."""

from math import isnan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from controller.signals.ports import Floats
from controller.signals.spectrum import spectrum

FORCES = st.floats(-1e4, 1e4, allow_subnormal=False)


@given(
    samples=arrays(np.float64, st.integers(3, 64), elements=FORCES),
    teeth=st.integers(1, 12),
)
def test_lines_are_those_of_the_whole_transform(samples: Floats, teeth: int) -> None:
    lines = 2.0 / len(samples) * np.abs(np.fft.rfft(samples))
    found = spectrum(samples, teeth)
    assert found.once_per_revolution == pytest.approx(lines[1], abs=1e-7)
    if 2 * teeth < len(samples):
        assert found.tooth_passing == pytest.approx(lines[teeth], abs=1e-7)
    else:
        assert isnan(found.tooth_passing)


def test_one_sample_a_tooth_cannot_show_the_passing_of_teeth() -> None:
    found = spectrum(np.array([10.0, 12.0, 10.0, 8.0]), 4)
    assert isnan(found.tooth_passing)
    assert found.once_per_revolution == pytest.approx(2.0)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_samples_show_nothing(count: int) -> None:
    found = spectrum(np.ones(count), 1)
    assert isnan(found.once_per_revolution)
    assert isnan(found.tooth_passing)
