"""Counts, means and spreads of outcomes: the database agrees with the statistics module."""

import statistics
from dataclasses import replace
from datetime import timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.queries import Spread, spread
from kbe.store import Store
from stepnc_model.outcome import Context, EvaluatedQuantity, ProcessOutcome

MEASURED = (880.0, 1010.0, None, 925.0, 800.0)
"""N, where 800 was predicted"""


def test_group_counts_and_averages(store: Store, outcome: ProcessOutcome) -> None:
    store.add([
        replace(
            outcome,
            force=EvaluatedQuantity(predicted=800.0, measured=force),
            feed=EvaluatedQuantity(measured=14.0),
            recorded_at=outcome.recorded_at + timedelta(hours=(3 * index) % 5),
            sequence=index,
        )
        for index, force in enumerate(MEASURED)
    ])
    (group,) = store.groups()
    assert group.context == outcome.context
    assert group.feature_kind == "closed_pocket"
    assert group.outcomes == 5
    assert group.first == outcome.recorded_at
    assert group.last == outcome.recorded_at + timedelta(hours=4)
    deviations = [force / 800.0 - 1.0 for force in MEASURED if force is not None]
    assert group.force.count == 4
    assert group.force.mean == pytest.approx(statistics.mean(deviations))
    assert group.force.deviation == pytest.approx(statistics.stdev(deviations))
    assert group.time.mean == pytest.approx(0.1)
    assert group.feed == group.roughness == Spread(count=0, mean=None, deviation=None)


def test_groups_are_told_apart_and_in_order(store: Store, outcome: ProcessOutcome) -> None:
    """Order of code points in both databases, whatever the language of the server."""
    keys = [("vmc", "C45", "e16", kind) for kind in ("slot", "Slot", "über", "planar_face")]
    keys += [("hmc", "C45", "e16", "slot"), ("vmc", "Al", "e16", "slot")]
    for machine, material, tool, kind in keys:
        context = Context(machine=machine, material=material, tool=tool)
        feature = replace(outcome.feature, kind=kind)
        one = replace(outcome, context=context, feature=feature, run=f"{context} {kind}")
        store.add([one, replace(one, sequence=1)])
    found = store.groups()
    assert [
        (group.context.machine, group.context.material, group.context.tool, group.feature_kind)
        for group in found
    ] == sorted(keys)
    assert {group.outcomes for group in found} == {2}


def test_store_without_outcomes_has_no_groups(store: Store) -> None:
    assert store.groups() == ()


@given(values=st.lists(st.floats(-1.0, 10.0), min_size=2, max_size=50))
def test_spread_is_that_of_the_statistics_module(values: list[float]) -> None:
    found = spread(len(values), sum(values), sum(value * value for value in values))
    assert found.mean == pytest.approx(statistics.fmean(values), abs=1e-12)
    # The square root of what rounding leaves of squares up to 100.
    assert found.deviation == pytest.approx(statistics.stdev(values), rel=1e-6, abs=1e-5)


def test_one_outcome_has_no_spread() -> None:
    assert spread(1, 0.25, 0.0625) == Spread(count=1, mean=0.25, deviation=None)
