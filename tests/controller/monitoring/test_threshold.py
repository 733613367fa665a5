"""Moving thresholds and the warning."""

from collections.abc import Iterable
from math import exp, log, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.monitoring.threshold import (
    USUAL,
    AlarmLevel,
    Thresholds,
    ThresholdWatch,
    watched,
)
from tests.controller.shown import REVOLUTION
from tests.every_case import every_case

SET_POINT = 500.0


def watch(
    forces: Iterable[float], begun: ThresholdWatch | None = None, *, step: int = 1
) -> list[ThresholdWatch]:
    now, found = begun or ThresholdWatch(), []
    for force in forces:
        revolution = REVOLUTION._replace(force=float(force), workingstep=step)
        now = watched(now, revolution, set_point=SET_POINT)
        found.append(now)
    return found


def steady(mean: float, *, count: int = 100, seed: int = 1) -> list[ThresholdWatch]:
    noise = np.random.default_rng(seed).normal(0.0, 0.03, count)
    return watch(mean * np.exp(noise))


def test_what_is_learnt_first_is_the_plain_mean_and_variance_of_the_logarithm() -> None:
    forces = [400.0, 410.0, 390.0, 405.0, 402.0]
    last = watch(forces)[-1]
    assert last.log_mean == pytest.approx(np.log(forces).mean())
    assert last.log_variance == pytest.approx(np.log(forces).var())
    assert last.threshold() is None


def test_threshold_lies_so_many_deviations_above_the_mean() -> None:
    last = steady(400.0)[-1]
    found = last.threshold()
    assert found is not None
    assert found == pytest.approx(400.0 * exp(USUAL.deviations * 0.03), rel=0.1)


def test_force_out_of_the_ordinary_is_warned_of_below_the_set_point() -> None:
    before = steady(380.0)[-1]
    assert before.level is AlarmLevel.SAFE
    assert watch([490.0], before)[-1].level is AlarmLevel.WARNING
    assert watch([380.0], watch([490.0], before)[-1])[-1].level is AlarmLevel.SAFE


def test_far_below_the_set_point_nothing_is_warned_of() -> None:
    before = steady(100.0)[-1]
    assert watch([0.79 * SET_POINT], before)[-1].level is AlarmLevel.SAFE
    assert watch([0.81 * SET_POINT], before)[-1].level is AlarmLevel.WARNING


@given(force=st.floats(1.0, 5000.0), count=st.integers(0, 40), is_steady=st.booleans())
def test_over_the_margin_is_over_learnt_or_not(
    force: float, count: int, is_steady: bool
) -> None:
    before = steady(400.0, count=count)[-1] if count else ThresholdWatch()
    revolution = REVOLUTION._replace(force=force)
    found = watched(before, revolution, set_point=SET_POINT, is_steady=is_steady)
    assert (found.level is AlarmLevel.OVER) == (force > (1.0 + USUAL.margin) * SET_POINT)


def test_noise_alone_hardly_ever_warns() -> None:
    """At four to five deviations, however near to the set point; seeded."""
    found = steady(0.98 * SET_POINT, count=5000, seed=7)
    assert sum(each.level is not AlarmLevel.SAFE for each in found) <= 1


def test_without_noise_a_trifle_is_no_warning() -> None:
    before = watch([450.0] * 50)[-1]
    assert watch([455.0], before)[-1].level is AlarmLevel.SAFE
    over = 450.0 * exp(USUAL.deviations * USUAL.least_deviation) + 0.1
    assert watch([over], before)[-1].level is AlarmLevel.WARNING


def test_another_workingstep_is_learnt_anew() -> None:
    before = steady(300.0)[-1]
    after = watch([490.0], before, step=2)[-1]
    assert (after.level, after.revolutions, after.workingstep) == (AlarmLevel.SAFE, 1, 2)
    assert after.log_mean == pytest.approx(log(490.0))


def test_what_passes_moves_the_threshold_little_and_what_stays_is_learnt() -> None:
    before = steady(380.0)[-1]
    old = before.threshold()
    once = watch([2000.0], before)[-1].threshold()
    assert old is not None
    assert once is not None
    assert once < 1.06 * old
    stayed = watch([490.0] * 100, before)
    assert stayed[0].level is AlarmLevel.WARNING
    assert stayed[-1].level is AlarmLevel.SAFE
    assert exp(stayed[-1].log_mean) == pytest.approx(490.0, rel=0.05)


def test_nothing_is_learnt_while_depth_or_feed_change() -> None:
    before = steady(380.0)[-1]
    revolution = REVOLUTION._replace(force=490.0)
    after = watched(before, revolution, set_point=SET_POINT, is_steady=False)
    assert after == before


@pytest.mark.parametrize("force", [nan, 0.0, -3.0])
def test_revolution_without_a_force_changes_nothing(force: float) -> None:
    before = steady(380.0)[-1]
    assert watch([force], before)[-1] == before


@every_case("wrong", [{"deviations": 0.0}, {"margin": nan}, {"learning": 1}])
def test_impossible_thresholds_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be"):
        Thresholds(**wrong)  # type: ignore[arg-type]


def test_set_point_must_be_positive() -> None:
    with pytest.raises(ValueError, match="set point 0 N"):
        watched(ThresholdWatch(), REVOLUTION, set_point=0.0)
