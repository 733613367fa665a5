"""The evaluation table."""

import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.evaluation import (
    EvaluationRow,
    Grouping,
    Knowledge,
    RowFilter,
    SortKey,
    evaluation,
    ordered,
    selected,
)
from kbe.remarks import EvaluationGrade
from kbe.statistics import Evaluated
from stepnc_model.outcome import Context, EvaluatedQuantity, FeatureFacts, ProcessOutcome
from tests.every_case import every_case
from tests.kbe.cuts import CONTEXT, SLOT, correction, deviating, in_run

FINE = replace(
    SLOT,
    workingstep="WS SLOT 2 FINISH",
    is_finishing=True,
    mode="QC",
    step_depth=EvaluatedQuantity(predicted=1.5, measured=1.5),
    feed_per_tooth=EvaluatedQuantity(predicted=0.1, measured=0.1),
)
POCKET = FeatureFacts(id="Pocket_1", kind="closed_pocket", length=120.0, width=150.0)


def with_tool(cut: ProcessOutcome, tool: str) -> ProcessOutcome:
    return replace(cut, context=replace(cut.context, tool=tool))


def tools(row: EvaluationRow) -> tuple[str | None, str | None]:
    rough, fine = row.roughing, row.finishing
    return rough.context.tool if rough else None, fine.context.tool if fine else None


def test_row_of_the_paper_has_both_sides() -> None:
    (row,) = evaluation([SLOT, FINE])
    assert (row.key.machine, row.key.feature, row.key.material) == ("vmc15", "Slot_2", "C45")
    assert (row.kind, row.length, row.width, row.total_depth) == ("slot", 150.0, 100.0, 20.0)
    assert row.roughing is not None
    assert row.finishing is not None
    assert row.roughing.feed_per_tooth == EvaluatedQuantity(predicted=0.4, measured=0.33)
    assert row.finishing.feed_per_tooth.predicted == 0.1
    assert row.finishing.step_depth.predicted == 1.5
    assert row.sides == (row.roughing, row.finishing)


def test_tools_that_met_share_a_row() -> None:
    fine = with_tool(FINE, "BALL 6")
    (row,) = evaluation([SLOT, fine])
    assert tools(row) == ("MILL 18", "BALL 6")


def test_tools_that_never_met_do_not() -> None:
    """The finishing tool of run 1 has cut nothing that the roughing tool of run 0 had."""
    fine = with_tool(in_run(1, FINE), "BALL 6")
    assert [tools(row) for row in evaluation([in_run(0), fine])] == [
        (None, "BALL 6"),
        ("MILL 18", None),
    ]


def test_side_that_met_two_stands_in_two_rows() -> None:
    outcomes = [
        in_run(0),
        with_tool(in_run(0, FINE), "BALL 6"),
        in_run(1),
        with_tool(in_run(1, FINE), "BALL 8"),
    ]
    first, second = evaluation(outcomes)
    assert [tools(first), tools(second)] == [("MILL 18", "BALL 6"), ("MILL 18", "BALL 8")]
    assert first.roughing == second.roughing
    assert first.roughing is not None
    assert first.roughing.runs == 2


def test_features_of_a_kind_pair_only_at_the_same_feature() -> None:
    other = FeatureFacts(id="Slot_3", kind="slot", length=80.0)
    elsewhere = with_tool(replace(FINE, feature=other), "BALL 6")
    found = evaluation([SLOT, elsewhere], grouping=Grouping.KIND)
    assert [tools(row) for row in found] == [(None, "BALL 6"), ("MILL 18", None)]


def test_kind_takes_features_of_all_programs_together() -> None:
    other = FeatureFacts(id="Slot_3", kind="slot", length=80.0, width=100.0, total_depth=20.0)
    outcomes = [SLOT, replace(SLOT, feature=other, program="plate.stpnc")]
    (row,) = evaluation(outcomes, grouping=Grouping.KIND)
    assert (row.key.feature, row.key.program) == ("slot", "")
    # What is not the same in all is not told.
    assert (row.length, row.width, row.total_depth) == (None, 100.0, 20.0)
    assert row.roughing is not None
    assert row.roughing.outcomes == 2
    assert len(evaluation(outcomes)) == 2


def test_same_id_in_two_programs_is_two_features() -> None:
    rows = evaluation([SLOT, replace(SLOT, program="plate.stpnc")])
    assert [row.key.program for row in rows] == ["bracket.stpnc", "plate.stpnc"]


def other_contexts() -> list[ProcessOutcome]:
    return [
        SLOT,
        replace(SLOT, feature=POCKET),
        replace(SLOT, context=Context(machine="haas", material="C45", tool="MILL 18")),
        replace(SLOT, context=Context(machine="vmc15", material="AlMg3", tool="MILL 18")),
        with_tool(SLOT, "MILL 10"),
        FINE,
    ]


@given(order=st.permutations(range(6)))
def test_rows_do_not_depend_on_the_order_of_groups(order: list[int]) -> None:
    outcomes = other_contexts()
    assert evaluation([outcomes[index] for index in order]) == evaluation(outcomes)


def test_every_outcome_is_in_the_table() -> None:
    rows = evaluation(other_contexts())
    assert len(rows) == 5
    sides = {
        (row.key, side.context, side is row.finishing): side
        for row in rows
        for side in row.sides
    }
    assert sum(side.outcomes for side in sides.values()) == 6


def test_empty_knowledge_base_has_an_empty_table() -> None:
    assert evaluation([]) == ()


def test_factor_of_the_context_is_shown() -> None:
    knowledge = Knowledge(proposed={CONTEXT: correction(log(1.2))})
    row, other = evaluation([SLOT, with_tool(SLOT, "NEW")], knowledge=knowledge)
    assert row.roughing is not None
    assert row.roughing.factor is not None
    assert row.roughing.factor.centre == pytest.approx(1.2)
    assert other.roughing is not None
    assert other.roughing.factor is None


def named(
    feature: str, runs: int, force: float, *, bound: float = 200.0
) -> list[ProcessOutcome]:
    """Runs of one feature, all with the same deviation of the force from its 100 N."""
    facts = FeatureFacts(id=feature, kind="slot")
    return [
        replace(
            in_run(run),
            feature=facts,
            force=deviating(force),
            time=deviating(0.5 * force),
            force_bound=bound,
        )
        for run in range(runs)
    ]


def table() -> tuple[EvaluationRow, ...]:
    return evaluation([
        *named("a", 2, 0.01),
        *named("b", 9, -0.3, bound=100.0),
        *named("c", 1, 0.2, bound=100.0),
        *named("d", 4, 0.12),
        replace(SLOT, feature=FeatureFacts(id="e", kind="slot")),
    ])


@every_case(
    ("key", "wanted"),
    [
        (SortKey.NAME, "abcde"),
        (SortKey.GRADE, "cbdae"),
        (SortKey.RUNS, "bdace"),
        (SortKey.LATEST, "bdace"),
        (SortKey.FORCE, "bcdae"),
        (SortKey.TIME, "bcdae"),
        (SortKey.FEED, "abcde"),
        (SortKey.ROUGHNESS, "abcde"),
        (SortKey.TIME_TO_WIN, "bacde"),
    ],
)
def test_order_of_rows(key: SortKey, wanted: str) -> None:
    assert "".join(row.key.feature for row in ordered(table(), key)) == wanted
    backwards = ordered(table()[::-1], key)
    assert backwards == ordered(table(), key)


def test_grade_of_a_row_is_the_worse_of_its_sides() -> None:
    rough = replace(SLOT, force=deviating(0.3))
    fine = replace(FINE, force=deviating(0.01))
    (row,) = evaluation([rough, fine])
    assert row.grade is EvaluationGrade.D
    (measured,) = evaluation([SLOT, fine])
    assert measured.grade is EvaluationGrade.A


@every_case(
    ("keep", "wanted"),
    [
        (RowFilter.ALL, "abcde"),
        (RowFilter.VIOLATED, "c"),
        (RowFilter.WASTED, "b"),
        (RowFilter.WITH_REMARKS, "bcd"),
        (RowFilter.WITH_TREND, ""),
        (RowFilter.FACTOR_PENDING, ""),
    ],
)
def test_filtered_rows(keep: RowFilter, wanted: str) -> None:
    assert "".join(row.key.feature for row in selected(table(), keep)) == wanted


def test_trend_and_pending_factor_are_found() -> None:
    worn = [replace(in_run(run), force=deviating(0.02 * run)) for run in range(8)]
    knowledge = Knowledge(proposed={CONTEXT: correction(log(1.2))})
    rows = evaluation(worn, knowledge=knowledge)
    assert selected(rows, RowFilter.WITH_TREND) == rows
    assert selected(rows, RowFilter.FACTOR_PENDING) == rows
    assert selected(evaluation(worn), RowFilter.FACTOR_PENDING) == ()


def many(count: int) -> Iterator[ProcessOutcome]:
    for run in range(count):
        yield replace(in_run(run), force=deviating(0.1 * (run % 7)))


def test_memory_does_not_grow_with_the_stream() -> None:
    """What is held for 3000 outcomes is what is held for 1200: all samples are full."""
    peaks = []
    for count in (1200, 3000):
        tracemalloc.start()
        (row,) = evaluation(many(count))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert row.roughing is not None
        assert row.roughing.deviations[Evaluated.FORCE].count == count
    assert peaks[1] < 1.2 * peaks[0]
