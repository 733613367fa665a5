"""The evaluation table as one self-contained HTML page, with the two-level header of the paper.

It holds no script and fetches nothing: it can be mailed, printed and kept.
"""

from collections.abc import Iterator, Sequence
from datetime import datetime
from html import escape
from itertools import groupby

from kbe.grade import Grade
from service.knowledge.evaluated import EvaluationTable
from service.knowledge.evaluation_cells import (
    LEGEND,
    Column,
    Line,
    columns,
    lines,
    remarks,
    summed,
    totals,
)
from service.page import STYLE, clock, headline

OWN_STYLE = """
body { max-width: 118rem; }
table.evaluation { font-size: 12px; line-height: 1.35; }
table.evaluation th, table.evaluation td { padding: .2rem .3rem; vertical-align: top; }
table.evaluation th.first, table.evaluation td.first { border-left: 1px solid var(--rule); }
table.evaluation thead tr:first-child th { text-align: left; border-bottom: none;
         color: var(--soft); font-weight: 500; }
table.evaluation tr.more td:not([rowspan]) { border-bottom: none; }
table.evaluation tbody tr:hover td { background: #8882; }
td.violated { color: var(--bad); font-weight: 600; } td.wasted { color: var(--warn);
         font-weight: 600; }
ul.remarks { list-style: none; padding: 0; } ul.remarks li { padding: .15rem 0; }
ul.remarks .which { display: inline-block; min-width: 6.5rem; color: var(--soft); }
a { color: inherit; }
@media print { body { font-size: 11px; margin: 0; } .scroll { overflow: visible; } }
"""

GRADES = {Grade.VIOLATED: "violated", Grade.WASTED: "wasted"}
"""classes of cells"""


def evaluation_page(table: EvaluationTable) -> str:
    """The page as HTML.

    Parameters
    ----------
    table : EvaluationTable
    """
    shown = columns(table.rows)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Evaluation of outcomes</title><style>{STYLE}{OWN_STYLE}</style></head><body>
<h1>Evaluation of outcomes</h1>
<p class="sub">{escape(table.place)} · {escape(_when(table.made_at))}{_meant(table)}</p>
{_first(table)}
<div class="scroll"><table class="evaluation">
<thead>{_groups(shown)}
{_labels(shown)}</thead>
<tbody>{_body(table, shown)}</tbody></table></div>
<h2>What to do</h2>{_remarks(table)}
<p class="sub">{escape(LEGEND)}</p>
<p class="sub">{escape(summed(table))}</p>
</body></html>
"""


def _when(time: datetime) -> str:
    return f"{time:%Y-%m-%d %H:%M} UTC"


def _meant(table: EvaluationTable) -> str:
    """Which outcomes and rows the user asked for."""
    selection = table.request.selection
    names = ("machine", "material", "tool", "feature_kind", "program", "run")
    asked = [(name.replace("_", " "), getattr(selection, name)) for name in names]
    told = [f"{name} {value}" for name, value in asked if value is not None]
    if selection.since is not None:
        told.append(f"since {selection.since:%Y-%m-%d %H:%M %z}")
    if selection.until is not None:
        told.append(f"until {selection.until:%Y-%m-%d %H:%M %z}")
    told.append(f"rows: {table.request.keep.value}")
    return "".join(f" · {escape(each)}" for each in told)


def _first(table: EvaluationTable) -> str:
    """The numbers that are looked at first."""
    found = totals(table.rows)
    return headline((
        ("outcomes", str(table.outcomes)),
        ("rows", str(len(table.rows))),
        ("violated", str(found.violated)),
        ("wasted", str(found.wasted)),
        ("k_c factors pending", str(found.pending)),
        ("time to win", clock(found.time_to_win)),
    ))


def _groups(shown: Sequence[Column]) -> str:
    """Upper level of the header."""
    cells = [
        f'<th{" class=first" if name else ""} colspan="{len(list(members))}" scope="colgroup">'
        f"{escape(name)}</th>"
        for name, members in groupby(shown, key=lambda each: each.group)
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _labels(shown: Sequence[Column]) -> str:
    """Lower level."""
    cells = [
        f'<th class="{" ".join(_classes(column, is_first))}" scope="col">'
        f"{escape(column.label)}</th>"
        for column, is_first in _placed(shown)
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _placed(shown: Sequence[Column]) -> Iterator[tuple[Column, bool]]:
    """Columns, and whether each is the first of its group."""
    before = None
    for column in shown:
        yield column, column.group != before
        before = column.group


def _classes(column: Column, is_first: bool) -> list[str]:
    return ["words"] * column.is_words + ["first"] * (is_first and bool(column.group))


def _body(table: EvaluationTable, shown: Sequence[Column]) -> str:
    placed = list(_placed(shown))
    return "\n".join(_line(line, placed) for line in lines(table.rows))


def _line(line: Line, placed: Sequence[tuple[Column, bool]]) -> str:
    """One line; what is the same in a row spans its lines."""
    cells = [
        _cell(line, column, is_first)
        for column, is_first in placed
        if line.is_first or not column.is_of_row
    ]
    anchor = f' id="row{line.number}"' if line.is_first else ""
    more = ' class="more"' if line.side is not line.row.sides[-1] else ""
    return f"<tr{anchor}{more}>{''.join(cells)}</tr>"


def _cell(line: Line, column: Column, is_first: bool) -> str:
    kinds = _classes(column, is_first)
    if column.label == "grade" and line.side.grade in GRADES:
        kinds.append(GRADES[line.side.grade])
    sides = len(line.row.sides)
    span = f' rowspan="{sides}"' if column.is_of_row and sides > 1 else ""
    kind = f' class="{" ".join(kinds)}"' if kinds else ""
    return f"<td{kind}{span}>{escape(column.cell(line))}</td>"


def _remarks(table: EvaluationTable) -> str:
    """With a link to the row each."""
    items = "\n".join(
        f'<li><span class="which"><a href="#row{number}">{number}</a> {which}</span> '
        f"{escape(text)}</li>"
        for number, which, text in remarks(table.rows)
    )
    return f'<ul class="remarks">{items}</ul>' if items else "<p>nothing</p>"
