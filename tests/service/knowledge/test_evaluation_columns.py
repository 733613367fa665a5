"""Cells of the evaluation table: the columns of the paper's Table 1, in the user's units."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from kbe.evaluation import evaluation
from kbe.statistics import DeviationStatistics, Evaluated
from service.knowledge.evaluation_columns import (
    EvaluationLine,
    arrow,
    change,
    deviation,
    lines,
    screen_columns,
)
from service.knowledge.evaluation_table import EvaluationTable
from service.rendering.columns import shown, visible
from service.requests.knowledge import EvaluationRequest
from service.verbs.kbe.table.result import EvaluationResult, key_figures
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.cuts import SLOT, deviating, in_run

PAPER = replace(
    SLOT,
    context=replace(SLOT.context, machine="Machine tool_ID", material="ST37", tool="35"),
    feature=replace(SLOT.feature, length=150.0, width=100.0, total_depth=20.0),
    cutting_speed=35_000.0 / 60.0,
)
FINISH = replace(
    PAPER,
    workingstep="WS FINISH",
    is_finishing=True,
    step_depth=EvaluatedQuantity(predicted=1.5, measured=1.5),
    feed_per_tooth=EvaluatedQuantity(predicted=0.1, measured=0.1),
)


def cells(outcomes: Sequence[ProcessOutcome]) -> list[dict[tuple[str, str], str]]:
    rows = evaluation(outcomes)
    found = list(lines(rows))
    return [
        {
            (column.group, column.heading): column.text(line, arrow="→", nothing="–").strip()
            for column in visible(screen_columns(rows), found)
        }
        for line in found
    ]


def test_the_first_row_is_that_of_the_paper() -> None:
    rough, fine = cells([PAPER, FINISH])
    assert rough["", "Machine_ID"] == "Machine tool_ID"
    assert rough["", "Feature_ID"] == "Slot_2"
    assert rough["Geometrical data", "L/X mm"] == "150/100"
    assert rough["Geometrical data", "a_t mm"] == "20"
    assert rough["Geometrical data", "a_s mm"] == "3"
    assert rough["Workpiece material", "ID"] == "ST37"
    assert rough["Workpiece material", "k_c N/mm²"] == "1000"
    assert rough["Cutting tool", "ID"] == "35"
    assert rough["Cutting tool", "V_c m/min"] == "35"
    assert rough["Roughing f_z, mm", "predicted"] == "0.4"
    assert rough["Roughing f_z, mm", "evaluated"] == "0.33"
    assert fine["Finishing, mm", "f_z"] == "0.1"
    assert fine["Finishing, mm", "a_s"] == "1.5"
    assert rough["Cutting", "Type"] == "d_s1"
    assert rough["Cutting", "Strategy"] == "unidirectional"


def test_columns_of_the_other_side_stay_empty() -> None:
    rough, fine = cells([PAPER, FINISH])
    assert fine["Roughing f_z, mm", "predicted"] == fine["Geometrical data", "a_s mm"] == ""
    assert rough["Finishing, mm", "f_z"] == rough["Finishing, mm", "a_s"] == ""


def test_programs_are_named_where_there_is_more_than_one() -> None:
    [one] = cells([PAPER])
    assert ("", "Program") not in one
    two = cells([PAPER, replace(PAPER, program="other.stpnc")])
    assert {each["", "Program"] for each in two} == {"bracket.stpnc", "other.stpnc"}


def test_deviations_have_mean_scatter_and_trend() -> None:
    still = [replace(in_run(day), force=deviating(0.1)) for day in range(2)]
    assert cells([*map(paper, still)])[0]["Deviation from plan, %", "force"] == "+10 ± 0"
    [rising] = lines(
        evaluation([
            replace(in_run(day), force=deviating(0.02 * day + 0.001 * (-1) ** day))
            for day in range(10)
        ])
    )
    seen = rising.side.deviations[Evaluated.FORCE]
    assert f"{deviation(seen)}{arrow(seen)}" == "+9 ± 6 ↑"
    assert arrow(falling(seen)) == " ↓"


def paper(cut: ProcessOutcome) -> ProcessOutcome:
    return replace(cut, context=PAPER.context)


def falling(seen: DeviationStatistics) -> DeviationStatistics:
    assert seen.trend is not None
    return replace(seen, trend=replace(seen.trend, per_run=-seen.trend.per_run))


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "–"), (1000.0, "1000"), (12345.6, "12346"), (0.3333, "0.333"), (35.0, "35")],
)
def test_numbers_have_the_digits_that_matter(value: float | None, text: str) -> None:
    assert shown(value, ".3g", nothing="–") == text


def test_what_was_is_told_where_it_differs() -> None:
    def told(quantity: EvaluatedQuantity) -> str:
        return shown(change(quantity), ".3g", arrow="→", nothing="–")

    assert told(EvaluatedQuantity(predicted=0.1, measured=0.1000001)) == "0.1"
    assert told(EvaluatedQuantity(predicted=0.1, measured=0.08)) == "0.1 → 0.08"
    assert told(EvaluatedQuantity(predicted=0.1)) == "0.1"
    assert told(EvaluatedQuantity(measured=0.08)) == "0.08"
    assert told(EvaluatedQuantity()) == "–"


def test_a_side_in_two_rows_counts_once() -> None:
    bound = replace(
        PAPER, force=EvaluatedQuantity(predicted=1000.0, measured=1200.0), force_bound=1000.0
    )
    other = replace(FINISH, context=replace(FINISH.context, tool="MILL 10"))
    rows = evaluation([bound, FINISH, other])
    assert len(rows) == 2
    table = EvaluationTable(
        request=EvaluationRequest(),
        place="kb.db",
        outcomes=3,
        rows=rows,
        left_out=0,
        made_at=PAPER.recorded_at,
    )
    assert dict(key_figures(table))["violated"] == "1"
    # Two remarks, and the legend.
    page = EvaluationResult(evaluation=table).page()
    assert page.count("passed its bound") + page.count("exceeded its bound") == 3


def test_lines_know_their_side() -> None:
    found: list[EvaluationLine] = list(lines(evaluation([PAPER, FINISH])))
    assert [(each.number, each.which, each.is_finishing) for each in found] == [
        (1, "rough", False),
        (1, "finish", True),
    ]
