"""Drift: false alarms as often as stated, changes found, and what they go with told."""

import numpy as np
import pytest

from extras.learning.drift import drift_of

Draw = np.ndarray[tuple[int], np.dtype[np.float64]]


def drawn(count: int, rng: np.random.Generator) -> Draw:
    """Residuals, skewed, with mean 0 and a standard deviation of 1 %."""
    return 0.01 * (rng.standard_gamma(4.0, count) / 2.0 - 2.0)


REFERENCE = drawn(300, np.random.default_rng(8)).tolist()


def test_false_alarms_are_as_rare_as_stated() -> None:
    rng = np.random.default_rng(1)
    alarms = sum(
        drift_of(drawn(20, rng), drawn(300, rng).tolist(), {}, false_alarm=0.1, seed=seed).alarm
        is not None
        for seed in range(120)
    )
    # 12 are expected; 4 to 22 have 99.5 % of the binomial distribution.
    assert 4 <= alarms <= 22


@pytest.mark.parametrize(("shift", "within"), [(0.02, 12), (-0.02, 12), (0.05, 4)])
def test_a_shift_is_found_soon_after_it_began(shift: float, within: int) -> None:
    rng = np.random.default_rng(2)
    residuals = drawn(80, rng)
    residuals[40:] += shift
    drift = drift_of(residuals, REFERENCE, {}, false_alarm=0.01, seed=1)
    assert drift.alarm is not None
    assert 40 <= drift.alarm <= 40 + within
    assert abs(drift.since - 40) <= 4
    assert drift.before is not None
    assert drift.after.low < drift.expected + shift < drift.after.high
    assert drift.before.low < drift.expected < drift.before.high


def test_what_a_drift_goes_with_is_told() -> None:
    rng = np.random.default_rng(3)
    feed, depth, order = rng.uniform(30, 90, 60), rng.uniform(2, 4, 60), np.arange(60.0)
    settings = {"feed": feed, "depth": depth, "order": order}
    residuals = drawn(60, rng) + 0.001 * (feed - 30.0)
    (found,) = drift_of(residuals, REFERENCE, settings, false_alarm=0.01, seed=1).associations
    assert found.name == "feed"
    assert found.change == pytest.approx(0.06, rel=0.2)
    assert 0.0 < found.chance < 0.001
    aging = drawn(60, rng) + 0.002 * np.maximum(order - 20.0, 0.0)
    drift = drift_of(aging, REFERENCE, settings, false_alarm=0.01, seed=1)
    assert [each.name for each in drift.associations] == ["order"]
    offset = drift_of(drawn(60, rng) + 0.1, REFERENCE, settings, false_alarm=0.01, seed=1)
    assert (offset.alarm, offset.associations) == (1, ())


def test_associations_by_chance_are_rare() -> None:
    rng = np.random.default_rng(4)
    found = 0
    for seed in range(60):
        settings = {str(name): rng.uniform(0, 1, 30) for name in range(6)}
        drift = drift_of(drawn(30, rng), REFERENCE, settings, false_alarm=0.01, seed=seed)
        found += bool(drift.associations)
    assert found <= 9, "3 of 60 are expected"


def test_a_model_without_residuals_alarms_at_any_difference() -> None:
    exact = (0.0, 0.0, 0.0)
    same = drift_of(np.zeros(10), exact, {}, false_alarm=0.01, seed=1)
    other = drift_of(np.full(10, 1e-4), exact, {}, false_alarm=0.01, seed=1)
    assert (same.alarm, other.alarm) == (None, 0)
