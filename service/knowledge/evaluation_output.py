"""Evaluation table and summary as text, HTML, CSV, Parquet and JSON."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from textwrap import wrap
from typing import Any

from kbe.grade import EvaluationGrade
from kbe.remarks import Remark
from kbe.selection import NAMES, Selection
from kbe.statistics import Evaluated
from service.files import write_atomically
from service.flat_file import Format, csv_lines, write_rows
from service.knowledge.evaluated import EvaluationTable, Summary, summary, table
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
from service.knowledge.place import require_apart
from service.reading import Tell
from service.rendering import text
from service.rendering.columns import Column, R, clock
from service.rendering.records import dump, file_columns, file_rows, record, records
from service.requests.knowledge import EvaluationRequest
from service.terminal import write_out
from stepnc_model.errors import StepNcError

COLOURS = {EvaluationGrade.VIOLATED: text.RED, EvaluationGrade.WASTED: text.YELLOW}
"""Colours of text lines by grade."""

OF_ROW = tuple(each for each in COLUMNS if each.is_of_row)
OF_SIDE = tuple(each for each in COLUMNS if not each.is_of_row)


def put_table(
    place: str, request: EvaluationRequest, *, form: str, output: Path | None, tell: Tell
) -> int:
    """Evaluate outcomes and write the table to its destination; return the outcome count.

    Raises
    ------
    KnowledgeError, WriteError
        When the table cannot be computed or written.
    """
    _require_output(place, form, output)
    found = table(place, request, tell=tell)
    if form in {Format.CSV, Format.PARQUET}:
        _put_rows(FILE_COLUMNS, tuple(lines(found.rows)), form=Format(form), output=output)
    elif form == Format.JSON:
        _put(table_json(found), output)
    elif form == "html":
        _put(evaluation_page(found), output)
    elif output is not None:
        _put(table_text(found, width=sys.maxsize), output)
    elif found.outcomes:
        width = text.screen_width()
        _put(table_text(found, width=width, is_coloured=text.wants_colours()), output)
    return found.outcomes


def put_summary(place: str, selection: Selection, *, form: str, output: Path | None) -> int:
    """Summarise outcomes and write the summary to its destination; return the group count."""
    _require_output(place, form, output)
    if form == "html" or (form == "text" and output is not None):
        raise StepNcError("write a summary to a CSV, JSON or Parquet file")
    found = summary(place, selection)
    if form in {Format.CSV, Format.PARQUET}:
        _put_rows(SUMMARY, found.groups, form=Format(form), output=output)
    elif form == Format.JSON:
        _put(summary_json(found), output)
    elif found.groups:
        print_summary(found)
    return len(found.groups)


def _require_output(place: str, form: str, output: Path | None) -> None:
    """Refuse Parquet on a terminal, and the knowledge base itself as an output file."""
    if form == Format.PARQUET and output is None:
        raise StepNcError("Parquet cannot be printed; name a file with -o FILE.parquet")
    require_apart(place, output)


def _put(found: str, output: Path | None) -> None:
    if output is None:
        sys.stdout.write(found + "\n")
    else:
        write_atomically(output, f"{found}\n".encode())


def _put_rows(
    columns: Sequence[Column[R]], rows: Sequence[R], *, form: Format, output: Path | None
) -> None:
    fields, values = file_columns(columns), file_rows(columns, rows)
    if output is not None:
        write_rows(output, fields, values, form=form)
        return
    for line in csv_lines(fields, values):
        write_out(line)


def table_text(found: EvaluationTable, *, width: int, is_coloured: bool = False) -> str:
    """Return the table as text, with its remarks, key figures and legend.

    Parameters
    ----------
    found : EvaluationTable
    width : int
        Characters per line; columns that do not fit are placed in blocks below.
    is_coloured : bool
        Whether lines are coloured by grade.
    """
    sides = tuple(lines(found.rows))
    shown = text.table(
        screen_columns(found.rows) if sides else (),
        sides,
        width=width,
        nothing="–",
        row_of=lambda line: line.number,
        colour=lambda line: COLOURS.get(line.side.grade, "") if is_coloured else "",
    )
    notes = [f"{line.number} {line.which}: {remark}" for line, remark in _remarks(sides)]
    figures = ", ".join(f"{name} {value}" for name, value in key_figures(found))
    told = (
        [part for each in sentences for part in _wrapped(each, width)]
        for sentences in (notes, [f"{found.place}: {figures}"], [LEGEND])
    )
    return "\n\n".join("\n".join(part) for part in ([*shown], *told) if part)


def _remarks(sides: Sequence[EvaluationLine]) -> list[tuple[EvaluationLine, Remark]]:
    """Remarks with the lines that they are about."""
    return [(line, remark) for line in sides for remark in line.side.remarks]


def _wrapped(sentence: str, width: int) -> list[str]:
    """Wrap a sentence; further lines are indented."""
    return wrap(text.one_line(sentence), width=max(width, 20), subsequent_indent="   ")


def key_figures(found: EvaluationTable) -> tuple[tuple[str, str], ...]:
    """Key figures of the table, as names and values; a side in two rows counts once."""
    sides = list({id(side): side for row in found.rows for side in row.sides}.values())
    grades = [side.grade for side in sides]
    hidden = f" and {found.left_out} not shown" if found.left_out else ""
    pending = {side.context for side in sides if side.is_pending}
    return (
        ("outcomes", str(found.outcomes)),
        ("rows", f"{len(found.rows)}{hidden}"),
        ("violated", str(grades.count(EvaluationGrade.VIOLATED))),
        ("wasted", str(grades.count(EvaluationGrade.WASTED))),
        ("k_c factors pending", str(len(pending))),
        ("time to win", clock(sum(side.bound.time_to_win for side in sides))),
    )


def evaluation_page(found: EvaluationTable) -> str:
    """Return the table as one self-contained HTML page that can be mailed, printed and kept."""
    from service.rendering.pages import rendered  # noqa: PLC0415 (Jinja is slow to import)

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


def _filters(request: EvaluationRequest) -> Iterator[str]:
    """Yield the filters of the request as text."""
    for name in (*NAMES, "since", "until"):
        value = getattr(request, name)
        if value is not None:
            shown = value if name in NAMES else f"{value:%Y-%m-%d %H:%M %z}"
            yield f"{name.replace('_', ' ')} {shown}"
    yield f"rows: {request.only.value}"


def table_json(found: EvaluationTable) -> str:
    """Return the table as JSON; rows contain their sides."""
    request = found.request
    return dump({
        "place": found.place,
        "made_at": found.made_at.isoformat(),
        "by": request.grouping.value,
        "only": request.only.value,
        "sort": request.sort.value,
        "outcomes": found.outcomes,
        "rows_left_out": found.left_out,
        "rows": [
            _row_json(list(sides))
            for _, sides in groupby(lines(found.rows), key=lambda line: line.number)
        ],
    })


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


def print_summary(found: Summary) -> None:
    """Print a line for each combination of machine, material, tool and kind of feature."""
    text.print_table(SUMMARY, found.groups, nothing="–")
    count = sum(group.outcomes for group in found.groups)
    text.print_line(
        f"{found.place}: {count} outcomes; mean ± standard deviation of measured over "
        "planned, minus one"
    )


def summary_json(found: Summary) -> str:
    """Return the summary as JSON."""
    return dump({
        "place": found.place,
        "made_at": found.made_at.isoformat(),
        "groups": records(SUMMARY, found.groups),
    })
