"""Columns of the evaluation table and of its summary, in the user's units.

The two-level header on screens is that of [1]_, Table 1; then follow the four quantities that
[1]_ evaluates, and the results of the knowledge base. A row has a line for its roughing and a
line for its finishing.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Table 1.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from kbe.evaluation import TYPES, EvaluationRow, Side
from kbe.factor import FactorInterval
from kbe.queries import Group, Spread
from kbe.remarks import EvaluationGrade
from kbe.statistics import DeviationStatistics, Evaluated
from service.rendering.columns import BLANK, Cell, Change, Column, shown
from stepnc_model.outcome import EvaluatedQuantity
from stepnc_model.units import m_min_from_speed

LEGEND = (
    "Deviation: measured over planned, minus one; mean ± standard deviation of the outcomes; "
    "↑ ↓ significant trend from run to run. Grade: A within 5 %, B 10 %, C 20 %, "
    "D more; violated: the force exceeded its bound; wasted: it stayed far below. "
    "k_c factor: measured over catalogue value, with the interval of 9 in 10 next runs; "
    "* differs from the factor that plans apply."
)

GRADES = {EvaluationGrade.VIOLATED: "violated", EvaluationGrade.WASTED: "wasted"}
"""CSS classes of cells by grade."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationLine:
    """Line of the evaluation table: the roughing or finishing side of a row."""

    number: int
    """Number of the row, from 1."""
    row: EvaluationRow
    side: Side
    is_finishing: bool

    @property
    def which(self) -> str:
        """Name of the side on screens."""
        return "finish" if self.is_finishing else "rough"


def lines(rows: Sequence[EvaluationRow]) -> Iterator[EvaluationLine]:
    """Yield the roughing line, then the finishing line of each row."""
    for number, row in enumerate(rows, start=1):
        for side in row.sides:
            yield EvaluationLine(
                number=number, row=row, side=side, is_finishing=side is row.finishing
            )


def screen_columns(rows: Sequence[EvaluationRow]) -> tuple[Column[EvaluationLine], ...]:
    """Return the columns for some rows; the program column only if there are several."""
    programs = {row.key.program for row in rows}
    return tuple(each for each in COLUMNS if each.key != "program" or len(programs) > 1)


def factor(interval: FactorInterval) -> str:
    """Return the centre and interval of a k_c factor as text."""
    return f"{interval.centre:.2f} ({interval.low:.2f}–{interval.high:.2f})"


def deviation(seen: DeviationStatistics | Spread) -> str | None:
    """Return the mean and standard deviation of deviations, in per cent, as text."""
    if seen.mean is None:
        return None
    scatter = "" if seen.deviation is None else f" ± {100.0 * seen.deviation:.0f}"
    # Adding zero avoids a minus sign before a rounded zero.
    return f"{round(100.0 * seen.mean) + 0:+d}{scatter}"


def arrow(seen: DeviationStatistics) -> str:
    """Return the arrow of a significant trend from run to run; empty if there is none."""
    if seen.trend is None or not seen.trend.is_significant:
        return ""
    return " ↑" if seen.trend.per_run > 0.0 else " ↓"


def change(quantity: EvaluatedQuantity) -> Change:
    """Return the planned and measured value of a quantity as a change."""
    return Change(before=quantity.predicted, after=quantity.measured)


def _per_cent(share: float | None) -> float | None:
    return None if share is None else 100.0 * share


def _roughing(of: Callable[[Side], Cell]) -> Callable[[EvaluationLine], Cell]:
    """Return a cell function for a column that the paper has for roughing only."""
    return lambda line: BLANK if line.is_finishing else of(line.side)


def _finishing(of: Callable[[Side], Cell]) -> Callable[[EvaluationLine], Cell]:
    return lambda line: of(line.side) if line.is_finishing else BLANK


def _size(row: EvaluationRow) -> str | None:
    """Length and width of the feature as the paper writes them, L/X."""
    if row.length is None and row.width is None:
        return None
    return "/".join(shown(each, ".4g", nothing="–") for each in (row.length, row.width))


def _speed(line: EvaluationLine) -> float | None:
    speed = line.side.cutting_speed
    return None if speed is None else m_min_from_speed(speed)


def _deviation(which: Evaluated) -> Callable[[EvaluationLine], str | None]:
    def cell(line: EvaluationLine) -> str | None:
        seen = line.side.deviations[which]
        mean = deviation(seen)
        return None if mean is None else mean + arrow(seen)

    return cell


def _factor(line: EvaluationLine) -> str | None:
    found = line.side.factor
    return None if found is None else factor(found) + "*" * line.side.is_pending


def _factor_part(
    of: Callable[[FactorInterval], float],
) -> Callable[[EvaluationLine], float | None]:
    return lambda line: None if line.side.factor is None else of(line.side.factor)


GEOMETRY, MATERIAL, TOOL = "Geometrical data", "Workpiece material", "Cutting tool"
ROUGHING, FINISHING = "Roughing f_z, mm", "Finishing, mm"
CUTTING, DEVIATION = "Cutting", "Deviation from plan, %"
LEARNED = "Evaluation"

# Columns of files and of screens, in the order in which either shows them.
_COLUMNS: tuple[Column[EvaluationLine], ...] = (
    Column(heading="#", value=lambda line: line.number, is_of_row=True, is_key=True),
    Column(
        key="machine", heading="Machine_ID", kind=str, value=lambda line: line.row.key.machine,
        is_words=True, is_of_row=True, is_key=True,
    ),
    Column(
        key="program", heading="Program", kind=str, value=lambda line: line.row.key.program,
        is_words=True, is_of_row=True, is_key=True,
    ),
    Column(
        key="feature", heading="Feature_ID", kind=str, value=lambda line: line.row.key.feature,
        is_words=True, is_of_row=True, is_key=True,
    ),
    Column(heading="Side", value=lambda line: line.which, is_words=True, is_key=True),
    Column(
        key="feature_kind", kind=str, value=lambda line: line.row.kind, is_of_row=True
    ),
    Column(key="length_mm", value=lambda line: line.row.length, is_of_row=True),
    Column(key="width_mm", value=lambda line: line.row.width, is_of_row=True),
    Column(
        heading="L/X mm", group=GEOMETRY, value=lambda line: _size(line.row), is_of_row=True,
        help="length L and width X of the feature",
    ),
    Column(
        key="total_depth_mm", heading="a_t mm", group=GEOMETRY, form=".3g",
        value=lambda line: line.row.total_depth, is_of_row=True,
        help="total depth of the feature, a_t",
    ),
    Column(
        heading="a_s mm", group=GEOMETRY, form=".3g",
        value=_roughing(lambda side: change(side.step_depth)),
        help="depth of a pass, a_s: planned and, if different, measured",
    ),
    Column(
        key="material", heading="ID", group=MATERIAL, kind=str,
        value=lambda line: line.row.key.material, is_words=True, is_of_row=True,
    ),
    Column(
        key="operation", kind=str,
        value=lambda line: "finishing" if line.is_finishing else "roughing",
    ),
    Column(key="tool", kind=str, value=lambda line: line.side.context.tool),
    Column(
        key="k_c11_n_mm2", heading="k_c N/mm²", group=MATERIAL, form=".4g",
        value=lambda line: line.side.specific_force,
        help="specific cutting force k_c1.1 of the catalogue",
    ),
    Column(
        heading="ID", group=TOOL, value=lambda line: line.side.context.tool, is_words=True
    ),
    Column(
        key="cutting_speed_m_min", heading="V_c m/min", group=TOOL, form=".3g", value=_speed,
        help="cutting speed V_c",
    ),
    Column(key="step_depth_predicted_mm", value=lambda line: line.side.step_depth.predicted),
    Column(key="step_depth_evaluated_mm", value=lambda line: line.side.step_depth.measured),
    Column(
        key="feed_per_tooth_predicted_mm",
        value=lambda line: line.side.feed_per_tooth.predicted,
    ),
    Column(
        key="feed_per_tooth_evaluated_mm",
        value=lambda line: line.side.feed_per_tooth.measured,
    ),
    Column(
        heading="predicted", group=ROUGHING, form=".3g",
        value=_roughing(lambda side: side.feed_per_tooth.predicted),
        help="feed per tooth f_z as planned",
    ),
    Column(
        heading="evaluated", group=ROUGHING, form=".3g",
        value=_roughing(lambda side: side.feed_per_tooth.measured),
        help="feed per tooth f_z as measured",
    ),
    Column(
        heading="f_z", group=FINISHING, form=".3g",
        value=_finishing(lambda side: change(side.feed_per_tooth)),
        help="feed per tooth f_z: planned and, if different, measured",
    ),
    Column(
        heading="a_s", group=FINISHING, form=".3g",
        value=_finishing(lambda side: change(side.step_depth)),
        help="depth of a pass, a_s: planned and, if different, measured",
    ),
    Column(
        key="immersion_type", heading="Type", group=CUTTING, kind=str, is_words=True,
        value=lambda line: ", ".join(TYPES[each] for each in line.side.immersions),
        help="type of face milling: d_s1 full, d_s2 one-sided, d_s3 two-sided immersion",
    ),
    Column(key="strategy", kind=str, value=lambda line: ", ".join(line.side.strategies)),
    Column(
        heading="Strategy", group=CUTTING, is_words=True,
        value=lambda line: ", ".join(line.side.strategies).replace("_", " "),
    ),
    Column(key="mode", kind=str, value=lambda line: ", ".join(line.side.modes)),
    Column(key="outcomes", kind=int, value=lambda line: line.side.outcomes),
    Column(
        key="runs", heading="runs", group=DEVIATION, kind=int,
        value=lambda line: line.side.runs,
    ),
    Column(heading="surface", group=DEVIATION, value=_deviation(Evaluated.ROUGHNESS)),
    Column(heading="time", group=DEVIATION, value=_deviation(Evaluated.TIME)),
    Column(heading="force", group=DEVIATION, value=_deviation(Evaluated.FORCE)),
    Column(heading="feed", group=DEVIATION, value=_deviation(Evaluated.FEED)),
    Column(key="latest", kind=datetime, value=lambda line: line.side.latest),
    Column(
        key="grade", heading="grade", group=LEARNED, kind=str, is_words=True,
        value=lambda line: line.side.grade.value,
        css=lambda line: GRADES.get(line.side.grade, ""),
    ),
    Column(key="bounds_known", kind=int, value=lambda line: line.side.bound.known),
    Column(key="bounds_violated", kind=int, value=lambda line: line.side.bound.violated),
    Column(key="bounds_wasted", kind=int, value=lambda line: line.side.bound.wasted),
    Column(key="highest_share_of_bound", value=lambda line: line.side.bound.highest),
    Column(key="time_to_win_s", value=lambda line: line.side.bound.time_to_win),
    Column(key="kc_factor", value=_factor_part(lambda factor: factor.centre)),
    Column(key="kc_factor_low", value=_factor_part(lambda factor: factor.low)),
    Column(key="kc_factor_high", value=_factor_part(lambda factor: factor.high)),
    Column(key="kc_factor_is_pending", kind=bool, value=lambda line: line.side.is_pending),
    Column(
        heading="k_c factor", group=LEARNED, value=_factor, is_words=True,
        help="measured over catalogue k_c, with the interval of 9 in 10 next runs",
    ),
)  # fmt: skip

COLUMNS = tuple(replace(each, is_right=not each.is_words) for each in _COLUMNS)

STATISTICS: tuple[Column[DeviationStatistics], ...] = (
    Column(key="count", kind=int, value=lambda seen: seen.count),
    Column(key="mean_percent", value=lambda seen: _per_cent(seen.mean)),
    Column(key="deviation_percent", value=lambda seen: _per_cent(seen.deviation)),
    Column(key="standard_error_percent", value=lambda seen: _per_cent(seen.standard_error)),
    Column(key="median_percent", value=lambda seen: _per_cent(seen.median)),
    Column(key="p95_percent", value=lambda seen: _per_cent(seen.high)),
    Column(
        key="trend_percent_per_run",
        value=lambda seen: None if seen.trend is None else 100.0 * seen.trend.per_run,
    ),
    Column(
        key="trend_is_significant",
        kind=bool,
        value=lambda seen: None if seen.trend is None else seen.trend.is_significant,
    ),
)
"""Columns with the deviation statistics of one quantity."""


def _flat(which: Evaluated, column: Column[DeviationStatistics]) -> Column[EvaluationLine]:
    """Return a statistic of one quantity as a column of a file."""
    return Column(
        key=f"{which}_{column.key}",
        kind=column.kind,
        value=lambda line: column.value(line.side.deviations[which]),
    )


FILE_COLUMNS: tuple[Column[EvaluationLine], ...] = (
    *COLUMNS,
    *(_flat(which, column) for which in Evaluated for column in STATISTICS),
    Column(key="remarks", kind=str, value=lambda line: "; ".join(map(str, line.side.remarks))),
)


def _spread(group: Group, which: Evaluated) -> Spread:
    found: Spread = getattr(group, which.value)
    return found


def _summed(which: Evaluated, heading: str) -> tuple[Column[Group], ...]:
    """Return the summary columns of one quantity."""
    return (
        Column(key=f"{which}_count", kind=int, value=lambda group: _spread(group, which).count),
        Column(
            key=f"{which}_mean_percent",
            value=lambda group: _per_cent(_spread(group, which).mean),
        ),
        Column(
            key=f"{which}_deviation_percent",
            value=lambda group: _per_cent(_spread(group, which).deviation),
        ),
        Column(heading=heading, value=lambda group: deviation(_spread(group, which))),
    )


SUMMARY: tuple[Column[Group], ...] = (
    Column(
        key="machine", heading="machine", kind=str, value=lambda group: group.context.machine,
        is_key=True,
    ),
    Column(
        key="material", heading="material", kind=str,
        value=lambda group: group.context.material, is_key=True,
    ),
    Column(
        key="tool", heading="tool", kind=str, value=lambda group: group.context.tool,
        is_key=True,
    ),
    Column(
        key="feature_kind", heading="kind", kind=str, value=lambda group: group.feature_kind,
        is_key=True,
    ),
    Column(key="outcomes", heading="outcomes", kind=int, value=lambda group: group.outcomes),
    Column(key="first", heading="first", kind=datetime, value=lambda group: group.first),
    Column(key="last", heading="last", kind=datetime, value=lambda group: group.last),
    *_summed(Evaluated.ROUGHNESS, "surface %"),
    *_summed(Evaluated.TIME, "time %"),
    *_summed(Evaluated.FORCE, "force %"),
    *_summed(Evaluated.FEED, "feed %"),
)  # fmt: skip
