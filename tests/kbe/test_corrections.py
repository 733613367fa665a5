"""What is learned of k_c: recovered from synthetic runs, with intervals as wide as they say."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import exp, inf, log, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.corrections import (
    NEVER,
    Admission,
    ExclusionReason,
    FactorPrior,
    Forgetting,
    LearnedFactor,
    Learning,
    learned,
    own_variance,
    refusal,
)
from kbe.factor import distribution, factor_at
from stepnc_model.outcome import Context, ForceRatio, LearnedCorrection, ProcessOutcome
from tests.kbe.cuts import CONTEXT, SLOT, after, in_run, with_ratio

UNFORGETTING = Learning(forgetting=NEVER)
TRUTH = log(1.3)
SCATTER = 0.05
REPETITIONS = 500
THREE_DEVIATIONS = 3.0 * sqrt(0.9 * 0.1 / REPETITIONS)
"""of the share that 500 intervals of 90 % cover"""


def runs_of(ratios: Sequence[float], *, deviation: float = 0.0) -> list[ProcessOutcome]:
    """One outcome a day."""
    return [
        with_ratio(in_run(number), ratio, deviation=deviation)
        for number, ratio in enumerate(ratios)
    ]


def only(outcomes: Sequence[ProcessOutcome], learning: Learning | None = None) -> LearnedFactor:
    (found,) = learned(outcomes, at=after(len(outcomes)), learning=learning)
    return found


def correction_of(
    outcomes: Sequence[ProcessOutcome], learning: Learning | None = None
) -> LearnedCorrection:
    found = only(outcomes, learning).correction
    assert found is not None
    return found


def repeated(
    count: int, draw: Callable[[np.random.Generator, int], list[ProcessOutcome]]
) -> tuple[list[LearnedFactor], np.random.Generator]:
    """What is learned in each of 500 repetitions of some runs."""
    random = np.random.default_rng(count)
    found = [only(draw(random, count), UNFORGETTING) for _ in range(REPETITIONS)]
    return found, random


def one_cut_a_run(random: np.random.Generator, count: int) -> list[ProcessOutcome]:
    return runs_of(list(random.normal(TRUTH, SCATTER, count)))


@pytest.fixture(scope="module", params=[3, 4, 5])
def few_runs(request: pytest.FixtureRequest) -> tuple[list[LearnedFactor], np.random.Generator]:
    return repeated(request.param, one_cut_a_run)


def test_truth_is_found_after_few_runs(
    few_runs: tuple[list[LearnedFactor], np.random.Generator],
) -> None:
    """As well as a mean of n runs can: 5 % scatter leaves 5 %/√n, within 3 % by the normal law.

    The prior pulls by less than 1 %.
    """
    found, _ = few_runs
    count = found[0].report.runs
    errors = np.array([each.mean.centre - TRUTH for each in found])
    assert np.sqrt(np.mean(errors**2)) < 1.1 * SCATTER / sqrt(count)
    assert abs(errors.mean()) < 0.01
    near = float((np.abs(np.expm1(errors)) < 0.03).mean())
    assert near > 2.0 * stats.norm.cdf(0.03 * sqrt(count) / SCATTER) - 1.0 - 0.06


def test_interval_covers_the_truth_nine_times_in_ten(
    few_runs: tuple[list[LearnedFactor], np.random.Generator],
) -> None:
    """At least: here the prior's guess of the scatter is right, which no interval can know."""
    found, _ = few_runs
    covered = np.mean([0.05 <= each.mean.below(TRUTH) <= 0.95 for each in found])
    assert 0.9 - THREE_DEVIATIONS < covered < 0.98


def test_correction_covers_the_next_run_nine_times_in_ten(
    few_runs: tuple[list[LearnedFactor], np.random.Generator],
) -> None:
    found, random = few_runs
    laws = [distribution(each.correction) for each in found if each.correction]
    coming = random.normal(TRUTH, SCATTER, len(laws))
    covered = np.mean([
        0.05 <= law.below(run) <= 0.95 for law, run in zip(laws, coming, strict=True)
    ])
    assert len(laws) == REPETITIONS
    assert 0.9 - THREE_DEVIATIONS < covered < 0.98


def test_coverage_is_exact_when_truths_are_as_the_prior_says() -> None:
    random = np.random.default_rng(8)
    prior = FactorPrior()
    learning = Learning(forgetting=NEVER, admission=Admission(wildest=inf))
    held = 0
    for _ in range(REPETITIONS):
        variance = prior.scatter**2 * prior.degrees / random.chisquare(prior.degrees)
        # The prior of the factor is as wide as the scatter makes it: conjugate.
        truth = random.normal(0.0, prior.deviation * sqrt(variance) / prior.scatter)
        found = only(runs_of(list(random.normal(truth, sqrt(variance), 4))), learning)
        held += 0.05 <= found.mean.below(truth) <= 0.95
    assert held / REPETITIONS == pytest.approx(0.9, abs=THREE_DEVIATIONS)


def test_noise_of_the_readings_does_not_spoil_the_interval() -> None:
    """Own error as large as the scatter: 0.2 in 307 readings, worth 16."""

    def noisy(random: np.random.Generator, count: int) -> list[ProcessOutcome]:
        own = sqrt(own_variance(reading(0.0, deviation=0.2, readings=307), Admission()))
        assert own == pytest.approx(SCATTER, rel=0.01)
        ratios = random.normal(TRUTH, SCATTER, count) + random.normal(0.0, own, count)
        return [
            with_ratio(in_run(number), float(ratio), deviation=0.2, readings=307)
            for number, ratio in enumerate(ratios)
        ]

    found, random = repeated(5, noisy)
    laws = [distribution(each.correction) for each in found if each.correction]
    coming = random.normal(TRUTH, SCATTER, len(laws))
    covered = np.mean([
        0.05 <= law.below(run) <= 0.95 for law, run in zip(laws, coming, strict=True)
    ])
    assert 0.9 - THREE_DEVIATIONS < covered < 0.98


def test_workingsteps_of_a_run_are_no_independent_witnesses() -> None:
    """Eight that share what is peculiar to their run: taken as 8, intervals would be 3 times
    too narrow and cover about half.
    """

    def eight_cuts_a_run(random: np.random.Generator, count: int) -> list[ProcessOutcome]:
        return [
            with_ratio(replace(in_run(run), workingstep=f"WS {step}"), float(ratio))
            for run, ratio in enumerate(random.normal(TRUTH, SCATTER, count))
            for step in range(8)
        ]

    found, _ = repeated(4, eight_cuts_a_run)
    covered = np.mean([0.05 <= each.mean.below(TRUTH) <= 0.95 for each in found])
    assert 0.9 - THREE_DEVIATIONS < covered < 0.98
    assert found[0].report.runs == 4
    assert found[0].report.used == 32
    assert found[0].report.effective_runs == pytest.approx(4.0)


def test_workingsteps_that_differ_widen_the_correction() -> None:
    same = [
        with_ratio(replace(in_run(run), workingstep=f"WS {step}"), TRUTH)
        for run in range(6)
        for step in range(2)
    ]
    different = [
        with_ratio(cut, TRUTH + (0.2 if cut.workingstep == "WS 1" else -0.2)) for cut in same
    ]
    assert correction_of(different).log_scale > 2.0 * correction_of(same).log_scale
    found = correction_of(different).log_centre
    assert found == pytest.approx(correction_of(same).log_centre, abs=1e-9)


def test_corrections_do_not_compound() -> None:
    """Plans with the accepted factor run slower, their forces meet the plan, the factor stays.

    Force ``F = k·f^0.75`` with k of the catalogue; what is cut has 1.3 k.
    """
    bound, catalogue, exponent = 1500.0, 1000.0, 0.75
    outcomes: list[ProcessOutcome] = []
    factors, forces = [1.0], []
    for run in range(12):
        feed = (bound / (factors[-1] * catalogue)) ** (1.0 / exponent)
        expected = catalogue * feed**exponent
        measured = 1.3 * catalogue * feed**exponent
        forces.append(measured)
        outcomes.append(with_ratio(in_run(run), log(measured / expected)))
        if run % 4 == 3:
            factors.append(factor_at(correction_of(outcomes, UNFORGETTING), quantile=0.5))
    assert forces[0] == pytest.approx(1.3 * bound)
    assert forces[-1] == pytest.approx(bound, rel=0.01)
    assert factors[1:] == pytest.approx([1.3, 1.3, 1.3], rel=0.006)


def test_first_run_moves_the_factor_and_says_how_little_it_knows() -> None:
    one, five = (correction_of(runs_of([TRUTH] * count)) for count in (1, 5))
    assert exp(one.log_centre) == pytest.approx(1.3, rel=0.02)
    assert one.confidence < five.confidence
    assert (one.outcomes, five.outcomes) == (1, 5)
    assert one.accepted_by == ""
    assert one.proposed_at == after(1)


def test_confidence_is_the_probability_within_ten_percent() -> None:
    found = correction_of(runs_of([0.2, 0.25, 0.3]))
    law = stats.t(found.degrees, found.log_centre, found.log_scale)
    centre = exp(found.log_centre)
    wanted = law.cdf(log(1.1 * centre)) - law.cdf(log(0.9 * centre))
    assert found.confidence == pytest.approx(wanted)


def test_learned_scatter_is_that_of_many_runs() -> None:
    random = np.random.default_rng(2)
    found = only(runs_of(list(random.normal(TRUTH, 0.1, 300))), UNFORGETTING)
    assert found.report.scatter == pytest.approx(0.1, rel=0.1)


def test_changed_material_is_followed() -> None:
    """After a half-life of runs with another k_c the old ones weigh as much as the new."""
    ratios = [0.0] * 40 + [TRUTH] * 10
    forgetting = Learning(forgetting=Forgetting(runs=10.0, days=1e9))
    found = correction_of(runs_of(ratios), forgetting).log_centre
    weights = 0.5 ** (np.arange(49, -1, -1) / 10.0)
    kappa = 1.0 / 16.0
    # The prior does not fade, the weights of the runs do.
    assert found == pytest.approx(weights @ ratios / (weights.sum() + kappa), rel=1e-7)
    assert found == pytest.approx(0.5 * TRUTH, rel=0.05)


def test_knowledge_fades_towards_the_prior_and_not_beyond() -> None:
    outcomes = runs_of([TRUTH] * 5)
    scales = []
    for days in (5, 185, 365, 100_000):
        (found,) = learned(outcomes, at=after(days))
        scales.append(found.mean.scale)
    assert scales == sorted(scales)
    (never,) = learned(outcomes, at=after(100_000))
    assert never.mean.centre == pytest.approx(0.0, abs=1e-9)
    assert never.mean.scale == pytest.approx(FactorPrior().deviation)
    assert never.mean.degrees == pytest.approx(FactorPrior().degrees)


def test_clock_set_back_forgets_nothing() -> None:
    assert Forgetting(runs=10.0, days=1.0).share(runs=0.0, days=-3.0) == 1.0
    assert Forgetting(runs=10.0, days=180.0).share(runs=10.0, days=0.0) == 0.5
    assert Forgetting(runs=10.0, days=180.0).share(runs=10.0, days=180.0) == 0.25
    assert NEVER.share(runs=1e6, days=1e6) == 1.0


def reading(log_mean: float, *, deviation: float = 0.1, readings: int = 400) -> ForceRatio:
    return ForceRatio(log_mean=log_mean, log_deviation=deviation, readings=readings)


@pytest.mark.parametrize(
    ("ratio", "reason"),
    [
        (None, ExclusionReason.NO_RATIO),
        (reading(float("nan")), ExclusionReason.NOT_FINITE),
        (reading(0.1, deviation=float("inf")), ExclusionReason.NOT_FINITE),
        (reading(0.1, readings=19), ExclusionReason.FEW_READINGS),
        (reading(0.1, readings=20), None),
        (reading(log(5.1)), ExclusionReason.WILD),
        (reading(-log(5.1)), ExclusionReason.WILD),
        (reading(log(4.9)), None),
    ],
)
def test_what_is_left_out_has_a_reason(
    ratio: ForceRatio | None, reason: ExclusionReason | None
) -> None:
    assert refusal(ratio, Admission()) is reason


def test_left_out_outcomes_are_counted_and_change_nothing() -> None:
    good = runs_of([0.2, 0.3])
    bad = [
        in_run(0),
        with_ratio(in_run(0), 0.2, readings=3),
        with_ratio(in_run(1), 9.0),
        with_ratio(in_run(1), -9.0),
    ]
    (found,) = learned([*bad, *good], at=after(2))
    assert found.report.left_out == {
        ExclusionReason.NO_RATIO: 1,
        ExclusionReason.FEW_READINGS: 1,
        ExclusionReason.WILD: 2,
    }
    assert found.report.used == 2
    assert found.correction == only(good).correction


def test_context_without_usable_outcome_has_no_proposal() -> None:
    found = only([in_run(0)])
    assert found.correction is None
    assert found.report.left_out == {ExclusionReason.NO_RATIO: 1}
    assert found.report.runs == 0
    assert found.mean.scale == pytest.approx(FactorPrior().deviation)


def test_correlated_readings_are_worth_less() -> None:
    """[1]: with ρ = 0.9 19 readings are worth one; and one is worth one."""
    admission = Admission(correlation=0.9)
    assert own_variance(reading(0.0, readings=1900), admission) == pytest.approx(0.01 / 100)
    assert own_variance(reading(0.0, readings=1), admission) == pytest.approx(0.01)
    white = Admission(correlation=0.0)
    assert own_variance(reading(0.0, readings=400), white) == pytest.approx(0.01 / 400)


def test_effective_number_of_readings_is_that_of_a_simulated_series() -> None:
    """A first-order autoregression with ρ = 0.9: variance of the mean of 400 readings."""
    random = np.random.default_rng(1)
    series = np.empty((3000, 400))
    series[:, 0] = random.normal(size=3000)
    for step in range(1, 400):
        series[:, step] = 0.9 * series[:, step - 1] + random.normal(0.0, sqrt(0.19), 3000)
    wanted = float(series.mean(axis=1).var())
    found = own_variance(reading(0.0, deviation=1.0, readings=400), Admission())
    # The formula is that of long series: 2.5 % off at 400; 3000 means know theirs to 2.6 %.
    assert found == pytest.approx(wanted, rel=0.08)


def test_precise_outcome_weighs_more() -> None:
    precise = with_ratio(in_run(0), 0.3, deviation=0.01)
    vague = with_ratio(in_run(1), 0.0, deviation=0.5)
    assert correction_of([precise, vague], UNFORGETTING).log_centre > 0.2


@given(order=st.permutations(range(6)))
def test_order_of_arrival_does_not_matter(order: list[int]) -> None:
    outcomes = runs_of([0.1, 0.2, 0.3, 0.25, 0.15, 0.4], deviation=0.3)
    assert correction_of([outcomes[index] for index in order]) == correction_of(outcomes)


def test_contexts_are_learned_apart_and_in_order() -> None:
    other = Context(machine="haas", material="C45", tool="MILL 18")
    steel = runs_of([0.3] * 3)
    theirs = [replace(cut, context=other) for cut in runs_of([-0.2] * 3)]
    found = learned([*steel, *theirs], at=after(3))
    assert [each.context for each in found] == [other, CONTEXT]
    assert found[0].mean.centre < 0.0 < found[1].mean.centre
    assert learned([], at=after(0)) == ()


def test_slot_of_the_tests_has_no_ratio() -> None:
    """So that what these tests learn, they gave."""
    assert SLOT.force_ratio is None
