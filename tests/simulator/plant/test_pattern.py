from math import asin, cos, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.plant.pattern import SAMPLES, Teeth, pattern

SLOT = Teeth(count=2, entry_angle=0.0, exit_angle=pi, exponent=1.0)


@given(
    st.integers(1, 8),
    st.floats(0.0, 3.0),
    st.floats(1e-4, pi),
    st.floats(0.5, 1.0),
    st.floats(0.0, 0.5),
)
def test_the_mean_of_a_revolution_is_one(
    count: int, entry: float, contact: float, exponent: float, runout: float
) -> None:
    teeth = Teeth(
        count=count,
        entry_angle=entry,
        exit_angle=min(entry + contact, pi),
        exponent=exponent,
        runout=runout,
    )
    shape = pattern(teeth)
    assert shape.shape == (count, SAMPLES)
    assert shape.mean() == pytest.approx(1.0)
    assert (shape >= 0.0).all()


def test_one_tooth_of_two_in_a_slot_takes_the_sine() -> None:
    edges = np.linspace(0.0, pi, SAMPLES + 1)
    expected = -np.diff(np.cos(edges)) / np.diff(edges) * pi / 2.0
    for row in pattern(SLOT):
        np.testing.assert_allclose(row, expected, rtol=1e-3)


def test_four_teeth_in_a_half_immersion_never_take_nothing() -> None:
    half = Teeth(count=4, entry_angle=pi / 2.0, exit_angle=pi, exponent=1.0)
    assert pattern(half).min() > 0.0


def test_runout_loads_the_highest_tooth() -> None:
    shape = pattern(Teeth(count=2, entry_angle=0.0, exit_angle=pi, exponent=1.0, runout=0.2))
    high, low = shape.mean(axis=1)
    # Chips min(sin φ + 0.4, 2·sin φ) and max(sin φ − 0.4, 0), integrated over the arc.
    begin = asin(0.4)
    expected = 0.4 * (pi - 2.0 * begin) + 2.0 * (1.0 - cos(begin))
    assert high - low == pytest.approx(expected, rel=1e-3)


def test_a_broken_tooth_leaves_its_chip_to_the_next() -> None:
    broken = Teeth(count=2, entry_angle=0.0, exit_angle=pi, exponent=1.0, broken=0)
    none, double = pattern(broken).mean(axis=1)
    assert none == 0.0
    assert double == pytest.approx(2.0)


def test_a_revolution_with_a_broken_tooth_takes_less_by_the_law_of_the_chip() -> None:
    broken = Teeth(count=2, entry_angle=0.0, exit_angle=pi, exponent=0.75, broken=1)
    assert pattern(broken).mean() == pytest.approx(0.5 * 2.0**0.75)


def test_without_an_arc_the_force_is_even() -> None:
    assert (pattern(Teeth(count=3, entry_angle=0.0, exit_angle=0.0, exponent=0.8)) == 1.0).all()
