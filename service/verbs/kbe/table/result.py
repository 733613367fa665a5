"""Results of ``kbe table``: the evaluation table of outcomes, or a summary of it."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from kbe.queries import NAMES
from kbe.remarks import EvaluationGrade, Remark
from kbe.statistics import Evaluated
from service.knowledge.evaluation_columns import (
    COLUMNS,
    FILE_COLUMNS,
    LEGEND,
    STATISTICS,
    SUMMARY,
    EvaluationLine,
    lines,
    screen_columns,
)
from service.knowledge.evaluation_table import EvaluationTable, Summary
from service.outputs.output_format import OutputFormat
from service.rendering.columns import clock, record
from service.rendering.text import RED, YELLOW
from service.rendering.view import Fact, Item, ResultView, Table, TextLine
from service.requests.knowledge import EvaluationRequest
from service.storage.results import TABLE
from service.verbs.kbe.quantities import NOTHING
from service.verbs.result import Result
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted

COLOURS = {EvaluationGrade.VIOLATED: RED, EvaluationGrade.WASTED: YELLOW}
"""Colours of text lines by grade."""

OF_ROW = tuple(each for each in COLUMNS if each.is_of_row)
OF_SIDE = tuple(each for each in COLUMNS if not each.is_of_row)


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationResult(Result):
    """Evaluation table of outcomes."""

    evaluation: EvaluationTable

    def view(self) -> ResultView:
        """Return lines of roughing and finishing, remarks, key figures and legend."""
        found, request = self.evaluation, self.evaluation.request
        sides = tuple(lines(found.rows))
        return ResultView([
            Fact(key="place", value=found.place),
            Fact(key="made_at", value=found.made_at.isoformat()),
            Fact(key="by", value=request.grouping.value),
            Fact(key="only", value=request.only.value),
            Fact(key="sort", value=request.sort.value),
            Fact(key="outcomes", value=found.outcomes),
            Fact(key="rows_left_out", value=found.left_out),
            Fact(key="rows", value=lambda: _rows_json(sides)),
            Table(
                key="lines", columns=FILE_COLUMNS, rows=sides, is_shown=False, is_in_json=False
            ),
            *_shown(found, sides),
        ])

    def kept(self, folder: Path) -> dict[str, Any]:
        """Write the lines as CSV and Parquet."""
        for form in (OutputFormat.CSV, OutputFormat.PARQUET):
            self.save(folder / f"{TABLE}.{form.value}")
        return self.record()

    def page(self) -> str:
        """Return one self-contained HTML page that can be mailed, printed and kept."""
        from service.rendering.pages import rendered  # noqa: PLC0415 (Jinja is slow to import)

        found = self.evaluation
        sides = tuple(lines(found.rows))
        return rendered(
            "evaluation.html.jinja",
            place=found.place,
            made_at=f"{found.made_at:%Y-%m-%d %H:%M} UTC",
            filters=_filters(found.request),
            figures=key_figures(found),
            columns=screen_columns(found.rows),
            lines=sides,
            remarks=_remarks(sides),
            legend=LEGEND,
        )


def _shown(table: EvaluationTable, sides: Sequence[EvaluationLine]) -> Iterator[Item]:
    """Items shown to people."""
    if sides:
        yield Table(
            columns=screen_columns(table.rows),
            rows=sides,
            nothing=NOTHING,
            row_of=lambda line: line.number,
            colour=lambda line: COLOURS.get(line.side.grade, ""),
        )
        yield TextLine(text="")
    remarks = _remarks(sides)
    for line, remark in remarks:
        yield TextLine(text=f"{line.number} {line.which}: {remark}", is_wrapped=True)
    if remarks:
        yield TextLine(text="")
    figures = ", ".join(f"{name} {value}" for name, value in key_figures(table))
    # Without outcomes it was told why; only files repeat the figures then.
    is_told = not table.outcomes
    for text in (f"{table.place}: {figures}", "", LEGEND):
        yield TextLine(text=text, is_wrapped=bool(text), is_reported=is_told)


def _remarks(sides: Sequence[EvaluationLine]) -> list[tuple[EvaluationLine, Remark]]:
    """Remarks with the lines that they are about."""
    return [(line, remark) for line in sides for remark in line.side.remarks]


def key_figures(table: EvaluationTable) -> tuple[tuple[str, str], ...]:
    """Key figures of the table, as names and values; a side in two rows counts once."""
    sides = list({id(side): side for row in table.rows for side in row.sides}.values())
    grades = [side.grade for side in sides]
    hidden = f" and {table.left_out} not shown" if table.left_out else ""
    pending = {side.context for side in sides if side.is_pending}
    return (
        ("outcomes", str(table.outcomes)),
        ("rows", f"{len(table.rows)}{hidden}"),
        ("violated", str(grades.count(EvaluationGrade.VIOLATED))),
        ("wasted", str(grades.count(EvaluationGrade.WASTED))),
        ("k_c factors pending", str(len(pending))),
        ("time to win", clock(sum(side.bound.time_to_win for side in sides))),
    )


def _filters(request: EvaluationRequest) -> Iterator[str]:
    """Yield the filters of the request as text."""
    for name in (*NAMES, "since", "until"):
        value = getattr(request, name)
        if value is not None:
            shown = value if name in NAMES else f"{value:%Y-%m-%d %H:%M %z}"
            yield f"{name.replace('_', ' ')} {shown}"
    yield f"rows: {request.only.value}"


def _rows_json(sides: Sequence[EvaluationLine]) -> list[dict[str, Any]]:
    """Return rows that contain their sides."""
    of_row = groupby(sides, key=lambda line: line.number)
    return [_row_json(list(each)) for _, each in of_row]


def _row_json(sides: Sequence[EvaluationLine]) -> dict[str, Any]:
    """Return a row with its sides as a JSON object."""
    by_kind = {each.is_finishing: _side_json(each) for each in sides}
    return {
        **record(OF_ROW, sides[0]),
        "grade": sides[0].row.grade.value,
        "roughing": by_kind.get(False),
        "finishing": by_kind.get(True),
    }


def _side_json(line: EvaluationLine) -> dict[str, Any]:
    return {
        **record(OF_SIDE, line),
        "deviations": {
            which.value: record(STATISTICS, line.side.deviations[which]) for which in Evaluated
        },
        "remarks": [asdict(each) for each in line.side.remarks],
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryResult(Result):
    """Counts and spreads by machine, material, tool and kind of feature."""

    summary: Summary

    def view(self) -> ResultView:
        """Return a line for each combination."""
        found = self.summary
        count = counted(sum(group.outcomes for group in found.groups), "outcome")
        note = "mean ± standard deviation of measured over planned, minus one"
        is_shown = bool(found.groups)
        return ResultView([
            Fact(key="place", value=found.place),
            Fact(key="made_at", value=found.made_at.isoformat()),
            Table(
                key="groups", columns=SUMMARY, rows=found.groups, nothing=NOTHING,
                is_shown=is_shown,
            ),
            TextLine(text=f"{found.place}: {count}; {note}", is_reported=not is_shown),
        ])  # fmt: skip

    def page(self) -> str:
        """Refuse a page, which only the table has.

        Raises
        ------
        StepNcError
        """
        raise StepNcError("write a summary to a CSV, JSON, Parquet or text file")
