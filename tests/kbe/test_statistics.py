"""Deviations of the four quantities."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.statistics import DeviationStatistics, DeviationTally, Evaluated, quantity_of
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.cuts import SLOT, deviating, in_run


def forces(runs: list[list[float]]) -> list[ProcessOutcome]:
    """Runs with the deviations of the force of each of their workingsteps."""
    return [
        replace(in_run(number), force=deviating(share))
        for number, run in enumerate(runs)
        for share in run
    ]


def statistics(outcomes: list[ProcessOutcome], which: Evaluated) -> DeviationStatistics:
    """Deviations of one quantity; a run is new when its id is not that of the one before."""
    tally = DeviationTally()
    number, last = -1, None
    for outcome in outcomes:
        number += outcome.run != last
        last = outcome.run
        tally.add(quantity_of(outcome, which).deviation, run=number)
    return tally.statistics()


SHARES = st.floats(-0.5, 1.0)


@given(runs=st.lists(st.lists(SHARES, min_size=1, max_size=4), min_size=3, max_size=12))
def test_statistics_are_those_of_numpy_and_scipy(runs: list[list[float]]) -> None:
    found = statistics(forces(runs), Evaluated.FORCE)
    every = [share for run in runs for share in run]
    means = [float(np.mean(run)) for run in runs]
    assert found.count == len(every)
    assert found.mean == pytest.approx(np.mean(every), abs=1e-9)
    assert found.median == pytest.approx(np.median(every), abs=1e-9)
    assert found.high == pytest.approx(np.quantile(every, 0.95), abs=1e-9)
    assert found.deviation == pytest.approx(np.std(every, ddof=1), abs=1e-6)
    assert found.standard_error == pytest.approx(stats.sem(means), abs=1e-6)
    assert found.runs == len(runs)
    assert found.trend is not None
    wanted = stats.linregress(np.arange(len(runs)), means)
    assert found.trend.per_run == pytest.approx(wanted.slope, abs=1e-9)


def test_force_that_rises_is_a_trend() -> None:
    """Two percent a run, with 1 % of scatter, over 12 runs."""
    noise = np.random.default_rng(3).normal(0.0, 0.01, 12)
    found = statistics(
        forces([[0.02 * run + noise[run]] for run in range(12)]), Evaluated.FORCE
    )
    assert found.trend is not None
    assert found.trend.is_significant
    assert abs(found.trend.per_run - 0.02) < 3.0 * found.trend.standard_error


def test_missing_values_are_counted_and_leave_their_runs_in_place() -> None:
    """Runs 0, 2 and 3 of a line through all four: the slope is still that of the line."""
    outcomes = forces([[0.0], [0.9], [0.2], [0.3]])
    outcomes[1] = replace(outcomes[1], force=EvaluatedQuantity(predicted=100.0))
    found = statistics(outcomes, Evaluated.FORCE)
    assert (found.count, found.missing, found.runs) == (3, 1, 3)
    assert found.trend is not None
    assert found.trend.per_run == pytest.approx(0.1)


@pytest.mark.parametrize("value", [None, float("nan"), float("inf")])
def test_what_is_no_number_is_missing(value: float | None) -> None:
    tally = DeviationTally()
    tally.add(value, run=0)
    found = tally.statistics()
    assert (found.count, found.missing) == (0, 1)
    assert found.mean is None
    assert found.median is None
    assert found.deviation is None
    assert found.standard_error is None
    assert found.trend is None


def test_runs_above_the_plan_are_counted_by_their_means() -> None:
    found = statistics(forces([[0.3, -0.1], [0.1, -0.3], [0.2]]), Evaluated.FORCE)
    assert (found.runs, found.runs_above) == (3, 2)


def test_tally_can_be_asked_at_any_time() -> None:
    tally = DeviationTally()
    for run, value in ((0, 0.1), (0, 0.3), (1, 0.2), (2, 0.5)):
        tally.add(value, run=run)
        assert tally.statistics() == tally.statistics()
    whole = statistics(forces([[0.1, 0.3], [0.2], [0.5]]), Evaluated.FORCE)
    found = tally.statistics()
    assert found.runs == whole.runs
    assert found.standard_error == pytest.approx(whole.standard_error)


def test_each_quantity_has_its_own() -> None:
    shares = {which: 0.1 * place for place, which in enumerate(Evaluated)}
    outcome = replace(
        SLOT,
        roughness=deviating(shares[Evaluated.ROUGHNESS]),
        time=deviating(shares[Evaluated.TIME]),
        force=deviating(shares[Evaluated.FORCE]),
        feed=deviating(shares[Evaluated.FEED]),
    )
    for which, share in shares.items():
        assert quantity_of(outcome, which).deviation == pytest.approx(share)
        assert statistics([outcome], which).mean == pytest.approx(share)
