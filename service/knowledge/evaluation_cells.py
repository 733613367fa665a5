"""The evaluation table as cells, the same on a terminal and on a page, in the user's units.

Columns and their two-level header are those of [1]_, Table 1; what follows them are the four
quantities that [1]_ evaluates, and what the knowledge base makes of them. A row has a line for
its roughing and a line for its finishing.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Table 1.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kbe.evaluation import EvaluationRow
from kbe.factor import FactorInterval
from kbe.grade import Grade
from kbe.side import TYPES, Side
from kbe.statistics import DeviationStatistics, Evaluated
from stepnc_model.outcome import Quantity
from stepnc_model.units import m_min_from_speed

if TYPE_CHECKING:
    from service.knowledge.evaluated import EvaluationTable

NOTHING = "–"
"""not known"""

LEGEND = (
    "Deviation: measured over planned, less one; mean ± standard deviation of the outcomes; "
    "↑ ↓ changes from run to run, by more than chance. Grade: A within 5 %, B 10 %, C 20 %, "
    "D beyond; violated: the force passed its bound; wasted: it stayed far below. "
    "k_c factor: measured over the catalogue's, with where the next run lies 9 times of 10; "
    "* is not what plans take."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One side of one row."""

    number: int
    """of the row, from 1"""
    row: EvaluationRow
    side: Side
    is_first: bool
    """of its row"""
    is_finishing: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column."""

    group: str
    """upper level of the header"""
    label: str
    cell: Callable[[Line], str]
    is_words: bool = False
    """to the left; figures go to the right"""
    is_of_row: bool = False
    """the same in all lines of a row"""
    is_key: bool = False
    """tells what a line is about"""


def lines(rows: Sequence[EvaluationRow]) -> Iterator[Line]:
    """Roughing, then finishing of each row."""
    for number, row in enumerate(rows, start=1):
        for index, side in enumerate(row.sides):
            yield Line(
                number=number,
                row=row,
                side=side,
                is_first=index == 0,
                is_finishing=side is row.finishing,
            )


def columns(rows: Sequence[EvaluationRow]) -> tuple[Column, ...]:
    """Columns for some rows: that of the program only where there is more than one."""
    programs = {row.key.program for row in rows}
    return tuple(each for each in COLUMNS if each is not PROGRAM or len(programs) > 1)


def _text(of: Callable[[EvaluationRow], str]) -> Callable[[Line], str]:
    return lambda line: of(line.row) or NOTHING


def _roughing(of: Callable[[Side], str]) -> Callable[[Line], str]:
    """A cell that the paper has for roughing only."""
    return lambda line: "" if line.is_finishing else of(line.side)


def _finishing(of: Callable[[Side], str]) -> Callable[[Line], str]:
    return lambda line: of(line.side) if line.is_finishing else ""


def number(value: float | None, digits: int = 3) -> str:
    """So many digits that matter."""
    if value is None:
        return NOTHING
    return f"{value:.0f}" if abs(value) >= 10.0**digits else f"{value:.{digits}g}"


def _size(row: EvaluationRow) -> str:
    """L/X as the paper writes it."""
    if row.length is None and row.width is None:
        return NOTHING
    return f"{number(row.length, 4)}/{number(row.width, 4)}"


def change(quantity: Quantity) -> str:
    """What was planned and, where it differs, what it was."""
    planned, was = number(quantity.predicted), number(quantity.measured)
    if quantity.measured is None or planned == was:
        return planned
    return was if quantity.predicted is None else f"{planned} → {was}"


def _depth(side: Side) -> str:
    return change(side.step_depth)


def _speed(line: Line) -> str:
    speed = line.side.cutting_speed
    return number(None if speed is None else m_min_from_speed(speed))


def _types(line: Line) -> str:
    return ", ".join(TYPES[each] for each in line.side.immersions) or NOTHING


def _strategies(line: Line) -> str:
    names = (each.replace("_", " ") for each in line.side.strategies)
    return ", ".join(names) or NOTHING


def deviation(seen: DeviationStatistics, *, is_percent_told: bool = False) -> str:
    """Mean, scatter and trend, in per cent."""
    if seen.mean is None:
        return NOTHING
    scatter = "" if seen.deviation is None else f" ± {100.0 * seen.deviation:.0f}"
    unit = " %" if is_percent_told else ""
    trend = f" {arrow(seen)}" if arrow(seen) else ""
    # Rounding leaves no minus before nothing.
    mean = round(100.0 * seen.mean) + 0
    return f"{mean:+d}{scatter}{unit}{trend}"


def arrow(seen: DeviationStatistics) -> str:
    """Where a quantity goes from run to run; empty: nowhere, or by chance."""
    if seen.trend is None or not seen.trend.is_significant:
        return ""
    return "↑" if seen.trend.per_run > 0.0 else "↓"


def _deviation(which: Evaluated) -> Callable[[Line], str]:
    return lambda line: deviation(line.side.deviations[which])


def factor(found: FactorInterval | None) -> str:
    """Centre and interval."""
    if found is None:
        return NOTHING
    return f"{found.centre:.2f} ({found.low:.2f}–{found.high:.2f})"


def _factor(line: Line) -> str:
    return factor(line.side.factor) + ("*" if line.side.is_pending else "")


PROGRAM = Column(
    group="", label="Program", cell=_text(lambda row: row.key.program), is_words=True,
    is_of_row=True, is_key=True,
)  # fmt: skip

GEOMETRY, MATERIAL, TOOL = "Geometrical data", "Workpiece material", "Cutting tool"
ROUGHING, FINISHING = "Roughing f_z, mm", "Finishing, mm"
CUTTING, DEVIATION = "Cutting", "Deviation from plan, %"
LEARNED = "Evaluation"

COLUMNS = (
    Column(
        group="", label="#", cell=lambda line: str(line.number), is_of_row=True, is_key=True
    ),
    Column(
        group="", label="Machine_ID", cell=_text(lambda row: row.key.machine), is_words=True,
        is_of_row=True, is_key=True,
    ),
    PROGRAM,
    Column(
        group="", label="Feature_ID", cell=_text(lambda row: row.key.feature), is_words=True,
        is_of_row=True, is_key=True,
    ),
    Column(
        group="", label="", cell=lambda line: "finish" if line.is_finishing else "rough",
        is_words=True, is_key=True,
    ),
    Column(
        group=GEOMETRY, label="L/X mm", cell=lambda line: _size(line.row), is_of_row=True
    ),
    Column(
        group=GEOMETRY, label="a_t mm", cell=lambda line: number(line.row.total_depth),
        is_of_row=True,
    ),
    Column(group=GEOMETRY, label="a_s mm", cell=_roughing(_depth)),
    Column(
        group=MATERIAL, label="ID", cell=_text(lambda row: row.key.material), is_words=True,
        is_of_row=True,
    ),
    Column(
        group=MATERIAL, label="k_c N/mm²", cell=lambda line: number(line.side.specific_force, 4)
    ),
    Column(
        group=TOOL, label="ID", cell=lambda line: line.side.context.tool or NOTHING,
        is_words=True,
    ),
    Column(group=TOOL, label="V_c m/min", cell=_speed),
    Column(
        group=ROUGHING, label="predicted",
        cell=_roughing(lambda side: number(side.feed_per_tooth.predicted)),
    ),
    Column(
        group=ROUGHING, label="evaluated",
        cell=_roughing(lambda side: number(side.feed_per_tooth.measured)),
    ),
    Column(
        group=FINISHING, label="f_z",
        cell=_finishing(lambda side: change(side.feed_per_tooth)),
    ),
    Column(group=FINISHING, label="a_s", cell=_finishing(_depth)),
    Column(group=CUTTING, label="Type", cell=_types, is_words=True),
    Column(group=CUTTING, label="Strategy", cell=_strategies, is_words=True),
    Column(group=DEVIATION, label="runs", cell=lambda line: str(line.side.runs)),
    Column(group=DEVIATION, label="surface", cell=_deviation(Evaluated.ROUGHNESS)),
    Column(group=DEVIATION, label="time", cell=_deviation(Evaluated.TIME)),
    Column(group=DEVIATION, label="force", cell=_deviation(Evaluated.FORCE)),
    Column(group=DEVIATION, label="feed", cell=_deviation(Evaluated.FEED)),
    Column(
        group=LEARNED, label="grade", cell=lambda line: line.side.grade.value, is_words=True
    ),
    Column(group=LEARNED, label="k_c factor", cell=_factor, is_words=True),
)  # fmt: skip


def remarks(rows: Sequence[EvaluationRow]) -> Iterator[tuple[int, str, str]]:
    """Number of the row, which side, what was seen and what to do."""
    for line in lines(rows):
        which = "finish" if line.is_finishing else "rough"
        for each in line.side.remarks:
            yield line.number, which, str(each)


def summed(table: "EvaluationTable") -> str:
    """What the table is of, in a sentence."""
    found = totals(table.rows)
    hidden = f" and {table.left_out} not shown" if table.left_out else ""
    facts = [
        f"outcomes {table.outcomes}",
        f"rows {len(table.rows)}{hidden}",
        f"violated {found.violated}",
        f"wasted {found.wasted}",
        f"k_c factors pending {found.pending}",
    ]
    if found.time_to_win > 0.0:
        facts.append(f"about {found.time_to_win:.0f} s could be won")
    return f"{table.place}: {', '.join(facts)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Totals:
    """What is looked at first."""

    violated: int
    """sides"""
    wasted: int
    """sides"""
    pending: int
    """contexts whose factor plans do not take yet"""
    time_to_win: float
    """s"""


def totals(rows: Sequence[EvaluationRow]) -> Totals:
    """Of all sides; one that stands in two rows counts once."""
    sides = list({id(side): side for row in rows for side in row.sides}.values())
    return Totals(
        violated=sum(side.grade is Grade.VIOLATED for side in sides),
        wasted=sum(side.grade is Grade.WASTED for side in sides),
        pending=len({side.context for side in sides if side.is_pending}),
        time_to_win=sum(side.bound.time_to_win for side in sides),
    )
