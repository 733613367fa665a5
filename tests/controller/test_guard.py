from dataclasses import replace
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.guard import (
    AIMED,
    LEAST_RESUMED,
    MARGIN,
    RESUMED,
    SUDDEN_RATIO,
    OverrideBand,
    OverrideReason,
    WorkingstepBounds,
    after_hold,
    aimed,
    allowed,
    in_air,
    taught,
)
from controller.reference import Reference
from tests.every_case import every_case

BAND = OverrideBand(floor=0.2, ceiling=1.5, rise=0.25)
KEEP = WorkingstepBounds(
    set_point=1000.0, breakage=4000.0, floor=0.2, ceiling=1.5, exponent=0.8
)


def test_a_wish_within_all_bounds_is_granted() -> None:
    got = allowed(1.1, BAND, KEEP, last=1.0, actual=1.0, force=900.0)
    assert (got.override, got.holding) == (1.1, OverrideReason.NOTHING)


def test_the_override_rises_slowly_and_falls_at_once() -> None:
    up = allowed(1.5, BAND, KEEP, last=1.0, actual=1.0, force=500.0)
    assert (up.override, up.holding) == (1.25, OverrideReason.RATE)
    down = allowed(0.3, BAND, KEEP, last=1.5, actual=1.5, force=500.0)
    assert (down.override, down.holding) == (0.3, OverrideReason.NOTHING)


@pytest.mark.parametrize(("wish", "got"), [(9.0, 1.5), (0.0, 0.2), (-3.0, 0.2)])
def test_the_band_holds(wish: float, got: float) -> None:
    answer = allowed(wish, BAND, KEEP, last=1.4, actual=1.4, force=100.0)
    assert (answer.override, answer.holding) == (got, OverrideReason.BAND)


@pytest.mark.parametrize("wish", [nan, inf, -inf])
def test_what_is_no_number_counts_as_the_floor(wish: float) -> None:
    answer = allowed(wish, BAND, KEEP, last=1.0, actual=1.0, force=500.0)
    assert (answer.override, answer.holding) == (0.2, OverrideReason.BAND)


@given(
    st.floats(allow_nan=True),
    st.floats(0.2, 1.5),
    st.floats(0.01, 1.6),
    st.floats(15.0, 1e5),
)
def test_the_force_measured_now_would_stay_below_the_threshold(
    wish: float, last: float, actual: float, force: float
) -> None:
    answer = allowed(wish, BAND, KEEP, last=last, actual=actual, force=force)
    assert 0.0 <= answer.override <= 1.5
    then = force * (answer.override / actual) ** KEEP.exponent
    assert then <= MARGIN * KEEP.threshold(BAND) * (1.0 + 1e-9)


def test_the_threshold_is_that_of_overload_or_of_half_the_strength() -> None:
    assert KEEP.threshold(BAND) == 1500.0
    weak = WorkingstepBounds(
        set_point=1000.0, breakage=2000.0, floor=0.2, ceiling=1.5, exponent=0.8
    )
    assert weak.threshold(BAND) == 1000.0


def test_without_chips_the_feed_is_at_most_the_programmed_one() -> None:
    assert in_air(KEEP, last=1.4).override == 1.0
    assert in_air(KEEP, last=0.7).override == 0.7
    assert in_air(KEEP, last=0.0).override == 0.2


def test_against_the_strength_a_tooth_counts_as_what_it_takes() -> None:
    """Against the set point, only as what it takes more than usual."""
    assert KEEP.load(BAND, level=900.0, force=1100.0) == 900.0
    # 2000 N are half of the strength, and count as the threshold of 1500 N.
    assert KEEP.load(BAND, level=900.0, force=2000.0) == KEEP.threshold(BAND) == 1500.0
    free = replace(KEEP, breakage=inf)
    assert free.load(BAND, level=900.0, force=2000.0) == 900.0
    unbound = replace(free, set_point=inf)
    assert unbound.load(BAND, level=900.0, force=2000.0) == 900.0


def test_a_set_point_that_falls_makes_no_overload_at_once() -> None:
    lower = replace(KEEP, set_point=300.0, settled=900.0)
    assert lower.threshold(BAND) == 1.5 * 900.0


def test_a_set_point_leaves_the_tool_a_sudden_rise() -> None:
    reference = Reference(workingstep="x", breakage=1000.0)
    assert aimed(900.0, reference) == AIMED * 1000.0 / SUDDEN_RATIO
    assert aimed(200.0, reference) == 200.0
    assert aimed(900.0, Reference(workingstep="x")) == 900.0


@given(st.floats(1500.0, 3000.0), st.floats(0.6, 1.5))
def test_a_hold_teaches_the_override_that_would_have_been_let_through(
    force: float, override: float
) -> None:
    cap = taught(BAND, KEEP, override=override, force=force)
    assert cap < override
    assert force * (cap / override) ** KEEP.exponent == pytest.approx(
        MARGIN * KEEP.threshold(BAND)
    )


def test_a_fault_teaches_no_more_than_a_sudden_rise() -> None:
    sudden = taught(BAND, KEEP, override=1.0, force=3000.0)
    assert taught(BAND, KEEP, override=1.0, force=1e9) == sudden
    low = replace(KEEP, floor=0.9)
    assert taught(BAND, low, override=1.0, force=3000.0) == 0.9


def test_after_a_force_beyond_all_the_feed_does_not_crawl() -> None:
    assert after_hold(KEEP, override=1.0, force=1e9) == LEAST_RESUMED


def test_a_hold_ends_with_an_override_that_would_have_kept_the_set_point() -> None:
    override = after_hold(KEEP, override=1.0, force=2000.0)
    assert 2000.0 * override**0.8 == pytest.approx(RESUMED * 1000.0)


@every_case(
    "change",
    [
        {"floor": 0.0},
        {"floor": 1.2},
        {"ceiling": 0.1},
        {"ceiling": inf},
        {"rise": 0.0},
        {"safe": 1.5},
        {"sensor_timeout": 0.0},
        {"overload_ratio": 1.0},
        {"holds": 0},
    ],
)
def test_impossible_bands_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must"):
        OverrideBand(**change)  # type: ignore[arg-type]


def test_below_the_least_chip_the_feed_is_not_lowered() -> None:
    """There the edge rubs; what is too much then holds the feed."""
    keep = replace(KEEP, least=0.3)
    got = allowed(0.1, BAND, keep, last=0.5, actual=0.5, force=10.0 * keep.strength)
    assert got.override == 0.3
    assert after_hold(keep, override=0.1, force=5000.0) == 0.3
    assert allowed(0.1, BAND, KEEP, last=0.5, actual=0.5, force=1e5).override < 0.3
