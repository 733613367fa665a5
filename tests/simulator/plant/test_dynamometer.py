from math import exp

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import Floats
from simulator.plant.dynamometer import Acquisition, Instrument
from tests.every_case import every_case

TRUTH = np.linspace(100.0, 200.0, 8)


def shown(
    instrument: Instrument, truth: Floats = TRUTH, *, seed: int = 1, is_lost: bool = False
) -> Floats:
    acquisition = Acquisition(instrument, np.random.default_rng(seed))
    return acquisition.shown(truth, time=10.0, interval=0.001, is_lost=is_lost)


def test_a_perfect_instrument_shows_the_truth() -> None:
    np.testing.assert_array_equal(shown(Instrument()), TRUTH)


def test_the_zero_drifts_with_time() -> None:
    np.testing.assert_allclose(shown(Instrument(drift=0.5)), TRUTH + 5.0)


@given(st.floats(0.01, 50.0))
def test_the_converter_shows_whole_steps_next_to_the_truth(step: float) -> None:
    values = shown(Instrument(step=step))
    np.testing.assert_allclose(values / step, np.round(values / step), atol=1e-9)
    assert np.abs(values - TRUTH).max() <= 0.5 * step * (1.0 + 1e-9)


def test_the_answer_to_a_step_is_that_of_a_first_order_lag() -> None:
    values = shown(Instrument(lag=0.002), np.full(8, 100.0))
    expected = [100.0 * (1.0 - exp(-0.001 * (row + 1) / 0.002)) for row in range(8)]
    np.testing.assert_allclose(values, expected)


def test_noise_has_its_standard_deviation() -> None:
    values = shown(Instrument(noise=0.03, floor=2.0), np.full(100_000, 100.0))
    assert values.mean() == pytest.approx(100.0, abs=0.05)
    assert values.std() == pytest.approx((3.0**2 + 2.0**2) ** 0.5, rel=0.02)


def test_the_share_of_lost_samples_is_as_said() -> None:
    values = shown(Instrument(missing=0.2), np.ones(100_000))
    assert np.isnan(values).mean() == pytest.approx(0.2, abs=0.01)


def test_what_is_drawn_does_not_depend_on_what_was_lost() -> None:
    instrument = Instrument(noise=0.1, missing=0.3)
    one, other = (Acquisition(instrument, np.random.default_rng(7)) for _ in range(2))
    one.shown(TRUTH, time=0.0, interval=0.001, is_lost=True)
    other.shown(TRUTH, time=0.0, interval=0.001, is_lost=False)
    first, second = (
        each.shown(TRUTH, time=0.1, interval=0.001, is_lost=False) for each in (one, other)
    )
    np.testing.assert_array_equal(first, second)


def test_nothing_arrives_from_a_silent_instrument() -> None:
    assert np.isnan(shown(Instrument(), is_lost=True)).all()


@every_case("change", [{"noise": -0.1}, {"missing": 1.0}, {"lag": -1.0}])
def test_impossible_instruments_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must"):
        Instrument(**change)
