"""What a group gives reason to do."""

from dataclasses import replace
from math import log

import pytest

from kbe.remarks import Action, BoundUse, Evidence, Remark, is_pending, remarks
from kbe.statistics import DeviationStatistics, DeviationTally, Evaluated, Trend
from stepnc_model.outcome import LearnedCorrection
from tests.kbe.cuts import correction

NOTHING = DeviationTally().statistics()


def seen(mean: float, *, runs: int = 12, above: int | None = None) -> DeviationStatistics:
    default = runs if mean > 0.0 else 0
    return replace(
        NOTHING,
        count=runs,
        mean=mean,
        deviation=0.02,
        runs=runs,
        runs_above=default if above is None else above,
    )


def evidence(
    deviations: dict[Evaluated, DeviationStatistics] | None = None,
    *,
    bound: BoundUse | None = None,
    proposed: LearnedCorrection | None = None,
    accepted: LearnedCorrection | None = None,
) -> Evidence:
    return Evidence(
        deviations=dict.fromkeys(Evaluated, NOTHING) | (deviations or {}),
        bound=bound or BoundUse(),
        proposed=proposed,
        accepted=accepted,
    )


def only(given: Evidence) -> Remark:
    (found,) = remarks(given)
    return found


def test_group_that_keeps_its_plan_needs_no_words() -> None:
    kept = dict.fromkeys(Evaluated, seen(0.03))
    assert remarks(evidence(kept, proposed=correction(log(1.03)))) == ()


def test_force_above_plan_asks_for_the_factor() -> None:
    found = only(
        evidence({Evaluated.FORCE: seen(0.23)}, proposed=correction(log(1.23), log_scale=0.03))
    )
    assert found.action is Action.ACCEPT_FACTOR
    # t of 8 degrees at 0.95 is 1.860: 1.23·exp(±0.0558).
    assert str(found) == (
        "force 23 % above plan in 12 of 12 runs: accept the k_c factor 1.23 (1.16 to 1.30)"
    )


def test_feed_that_the_controller_lowered_asks_for_the_factor_as_well() -> None:
    """The force was kept, so only feed and factor tell."""
    low = {Evaluated.FEED: seen(-0.2, above=2), Evaluated.FORCE: seen(0.01)}
    found = only(evidence(low, proposed=correction(log(1.2))))
    assert found.action is Action.ACCEPT_FACTOR
    assert found.observed == "feed 20 % below plan in 10 of 12 runs"


def test_factor_alone_is_told_against_what_plans_take() -> None:
    found = only(evidence(proposed=correction(log(1.3)), accepted=correction(log(1.1))))
    assert found.observed == "force 1.30 × catalogue, but plans use factor 1.10"


def test_few_outcomes_ask_for_more() -> None:
    found = only(evidence(proposed=correction(log(1.3), outcomes=1)))
    assert found.action is Action.WAIT
    assert found.advice.startswith("collect 2 more to confirm the k_c factor 1.30")


def test_accepted_factor_is_pending_no_more() -> None:
    given = evidence(proposed=correction(log(1.31)), accepted=correction(log(1.3)))
    assert not is_pending(given)
    assert remarks(given) == ()


@pytest.mark.parametrize(
    ("proposed", "accepted", "action"),
    [
        (None, None, Action.RECORD_RATIO),
        (correction(log(1.3)), correction(log(1.3)), Action.PLAN_AGAIN),
        (correction(log(1.01)), None, Action.CHECK_FEED),
    ],
)
def test_force_off_its_plan_without_a_new_factor(
    proposed: LearnedCorrection | None, accepted: LearnedCorrection | None, action: Action
) -> None:
    given = evidence({Evaluated.FORCE: seen(0.3)}, proposed=proposed, accepted=accepted)
    assert only(given).action is action


def test_violation_is_told_first() -> None:
    bound = BoundUse(known=9, violated=2, highest=1.12)
    found = remarks(evidence({Evaluated.FORCE: seen(0.3)}, bound=bound))
    assert found[0].action is Action.PLAN_SAFER
    assert "in 2 of 9 cuts, by 12 % at worst" in found[0].observed


def test_waste_is_told_with_its_time() -> None:
    found = only(evidence(bound=BoundUse(known=9, wasted=6, highest=0.7, time_to_win=30.0)))
    assert found.action is Action.PLAN_BOLDER
    assert (
        found.observed
        == "force below 80 % of its bound in 6 of 9 cuts, about 5.0 s each could be saved"
    )


@pytest.mark.parametrize(
    ("factor", "action"), [(0.7, Action.PLAN_AGAIN), (1.3, Action.PLAN_BOLDER)]
)
def test_waste_is_cured_by_a_factor_only_when_it_is_lower(
    factor: float, action: Action
) -> None:
    given = evidence(bound=BoundUse(known=9, wasted=9), proposed=correction(log(factor)))
    assert remarks(given)[1].action is action


def test_rough_surface_lowers_the_feed_by_its_square_root() -> None:
    """Paper 002, eq. (10): 44 % rougher, 1.2 times the feed."""
    found = only(evidence({Evaluated.ROUGHNESS: seen(0.44)}))
    assert found.action is Action.LOWER_FEED
    assert found.advice == "lower the feed per tooth by 17 %"


def test_time_off_its_plan_at_the_planned_feed_is_the_machines() -> None:
    assert only(evidence({Evaluated.TIME: seen(0.1)})).action is Action.CALIBRATE


def test_time_off_its_plan_with_the_feed_is_the_feeds() -> None:
    slow = {Evaluated.TIME: seen(0.1), Evaluated.FEED: seen(-0.1)}
    assert only(evidence(slow)).action is Action.CHECK_FEED
    fast = {Evaluated.TIME: seen(-0.1), Evaluated.FEED: seen(0.1)}
    assert only(evidence(fast)).action is Action.PLAN_BOLDER


def rising(per_run: float, *, chance: float = 0.001) -> DeviationStatistics:
    trend = Trend(per_run=per_run, standard_error=0.003, runs=12, chance=chance)
    return replace(seen(0.0), trend=trend)


@pytest.mark.parametrize(
    ("which", "per_run", "action"),
    [
        (Evaluated.FORCE, 0.021, Action.CHANGE_TOOL),
        (Evaluated.ROUGHNESS, 0.021, Action.CHANGE_TOOL),
        (Evaluated.FEED, -0.021, Action.CHANGE_TOOL),
        (Evaluated.FORCE, -0.021, Action.WAIT),
    ],
)
def test_trend_of_wear_asks_for_a_new_edge(
    which: Evaluated, per_run: float, action: Action
) -> None:
    found = only(evidence({which: rising(per_run)}))
    assert (found.about, found.action) == (which, action)
    assert "by 2.1 ± 0.3 % of the plan per run, over 12 runs" in found.observed


def test_trend_by_chance_or_too_flat_is_not_told() -> None:
    assert remarks(evidence({Evaluated.FORCE: rising(0.021, chance=0.02)})) == ()
    assert remarks(evidence({Evaluated.FORCE: rising(0.004)})) == ()


def test_a_plan_that_passes_its_own_bound_is_to_be_made_anew() -> None:
    found = remarks(evidence(bound=BoundUse(known=3, overplanned=2)))
    assert found[0].action is Action.PLAN_AGAIN
    assert "in 2 of 3 cuts: optimise the program" in str(found[0])
