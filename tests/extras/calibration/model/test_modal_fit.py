"""Modes put into a frequency response come back out of it."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extras.calibration.model.modal_fit import FrequencyResponse, ModalFit, fitted_modes
from simulator.errors import CalibrationError

Mode = tuple[float, float, float]
"""Hz, ζ, N/mm"""

# Two modes of an end mill, far apart and of very different damping.
TWO: tuple[Mode, ...] = ((452.8, 0.12, 7_900.0), (1448.5, 0.017, 14_700.0))


def response(
    modes: Sequence[Mode], *, noise: float = 0.0, offset: float = 0.0, sign: float = 1.0
) -> FrequencyResponse:
    frequency = np.arange(2.0, 4_001.0, 2.0)
    total = np.full(frequency.shape, offset, dtype=np.complex128)
    for natural, damping, stiffness in modes:
        ratio = frequency / natural
        total += 1.0 / stiffness / (1.0 - ratio**2 + sign * 2j * damping * ratio)
    random = np.random.default_rng(1)
    spread = noise * np.abs(total).max()
    total += spread * (
        random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size)
    )
    return FrequencyResponse(name="tap", frequency=frequency, receptance=total)


def numbers(fit: ModalFit) -> list[Mode]:
    return [(mode.natural_frequency, mode.damping_ratio, mode.stiffness) for mode in fit.modes]


def test_modes_come_back() -> None:
    fit = fitted_modes(response(TWO))
    for found, put in zip(numbers(fit), TWO, strict=True):
        assert found == pytest.approx(put, rel=1e-4)
    assert fit.residual < 1e-5
    assert fit.unexplained < 1e-4


def test_noise_and_a_mode_beyond_the_range_hardly_move_them() -> None:
    fit = fitted_modes(response(TWO, noise=0.005, offset=5e-6))
    for found, put in zip(numbers(fit), TWO, strict=True):
        assert found == pytest.approx(put, rel=0.03)
    assert fit.residual < fit.unexplained < 0.1


@settings(max_examples=25, deadline=None)
@given(
    first=st.tuples(st.floats(200.0, 900.0), st.floats(0.01, 0.06), st.floats(3e3, 3e4)),
    apart=st.floats(1.7, 3.5),
    ratio=st.floats(0.4, 2.5),
)
def test_any_two_modes_that_stand_apart_come_back(
    first: Mode, apart: float, ratio: float
) -> None:
    second = (apart * first[0], first[1], ratio * first[2])
    fit = fitted_modes(response((first, second)), count=2)
    for found, put in zip(numbers(fit), (first, second), strict=True):
        assert found == pytest.approx(put, rel=1e-3)


def test_as_many_modes_as_asked_for() -> None:
    assert len(fitted_modes(response(TWO), count=1).modes) == 1
    with pytest.raises(CalibrationError, match="2 peaks found, but 3 modes were requested"):
        fitted_modes(response(TWO), count=3)


def test_one_mode_of_two_leaves_much_unexplained() -> None:
    assert fitted_modes(response(TWO), count=1).unexplained > 0.1


def test_a_response_of_the_other_sign_is_refused() -> None:
    with pytest.raises(CalibrationError, match="imaginary part is positive"):
        fitted_modes(response(TWO, sign=-1.0), path="tap.csv")


def test_a_range_without_a_peak_is_refused() -> None:
    flat = response(((40_000.0, 0.02, 1e4),))
    with pytest.raises(CalibrationError, match="no peak"):
        fitted_modes(flat)
