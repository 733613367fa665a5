"""The evaluation table for other programs: CSV, Parquet and JSON.

In the user's units, which stand in the names. A line for each side of a row; JSON has the rows
with their sides within, and remarks in parts.
"""

from collections.abc import Iterator, Sequence
from datetime import datetime
from typing import TYPE_CHECKING, Any

from kbe.evaluation import EvaluationRow
from kbe.remarks import Remark
from kbe.side import TYPES, Side
from kbe.statistics import DeviationStatistics, Evaluated
from service.flat_file import Field, Row, Value
from service.knowledge.evaluation_cells import lines
from service.wire import dump
from stepnc_model.units import m_min_from_speed

if TYPE_CHECKING:
    from service.knowledge.evaluated import EvaluationTable

PER_CENT = 100.0

ROW_FIELDS = (
    Field(name="machine", kind=str),
    Field(name="program", kind=str),
    Field(name="feature", kind=str),
    Field(name="feature_kind", kind=str),
    Field(name="length_mm", kind=float),
    Field(name="width_mm", kind=float),
    Field(name="total_depth_mm", kind=float),
    Field(name="material", kind=str),
)

SIDE_FIELDS = (
    Field(name="operation", kind=str),
    Field(name="tool", kind=str),
    Field(name="k_c11_n_mm2", kind=float),
    Field(name="cutting_speed_m_min", kind=float),
    Field(name="step_depth_predicted_mm", kind=float),
    Field(name="step_depth_evaluated_mm", kind=float),
    Field(name="feed_per_tooth_predicted_mm", kind=float),
    Field(name="feed_per_tooth_evaluated_mm", kind=float),
    Field(name="immersion_type", kind=str),
    Field(name="strategy", kind=str),
    Field(name="mode", kind=str),
    Field(name="outcomes", kind=int),
    Field(name="runs", kind=int),
    Field(name="latest", kind=datetime),
    Field(name="grade", kind=str),
    Field(name="bounds_known", kind=int),
    Field(name="bounds_violated", kind=int),
    Field(name="bounds_wasted", kind=int),
    Field(name="highest_share_of_bound", kind=float),
    Field(name="time_to_win_s", kind=float),
    Field(name="kc_factor", kind=float),
    Field(name="kc_factor_low", kind=float),
    Field(name="kc_factor_high", kind=float),
    Field(name="kc_factor_is_pending", kind=bool),
)

STATISTICS = (
    ("count", int),
    ("mean_percent", float),
    ("deviation_percent", float),
    ("standard_error_percent", float),
    ("median_percent", float),
    ("p95_percent", float),
    ("trend_percent_per_run", float),
    ("trend_is_significant", bool),
)

FIELDS = (
    *ROW_FIELDS,
    *SIDE_FIELDS,
    *(Field(name=f"{which}_{name}", kind=kind) for which in Evaluated
      for name, kind in STATISTICS),
    Field(name="remarks", kind=str),
)  # fmt: skip


def table_rows(rows: Sequence[EvaluationRow]) -> Iterator[Row]:
    """A flat line for each side."""
    for line in lines(rows):
        told = "; ".join(map(str, line.side.remarks))
        yield {
            **_row(line.row),
            **_side(line.side, is_finishing=line.is_finishing),
            **_deviations(line.side),
            "remarks": told,
        }


def table_json(table: "EvaluationTable") -> str:
    """The table with what it was made from."""
    request = table.request
    return dump({
        "place": table.place,
        "made_at": table.made_at.isoformat(),
        "by": request.grouping.value,
        "only": request.keep.value,
        "sort": request.by.value,
        "outcomes": table.outcomes,
        "rows_left_out": table.left_out,
        "rows": [_nested(row) for row in table.rows],
    })


def _nested(row: EvaluationRow) -> dict[str, Any]:
    """One row with its sides."""
    return {
        **_row(row),
        "grade": row.grade.value,
        "roughing": _nested_side(row.roughing, is_finishing=False),
        "finishing": _nested_side(row.finishing, is_finishing=True),
    }


def _nested_side(side: Side | None, *, is_finishing: bool) -> dict[str, Any] | None:
    if side is None:
        return None
    flat = _side(side, is_finishing=is_finishing)
    return {
        **{name: _plain(value) for name, value in flat.items()},
        "deviations": {which.value: _statistics(side.deviations[which]) for which in Evaluated},
        "remarks": [_remark(each) for each in side.remarks],
    }


def _remark(remark: Remark) -> dict[str, str]:
    return {
        "about": remark.about.value,
        "action": remark.action.value,
        "observed": remark.observed,
        "advice": remark.advice,
    }


def _row(row: EvaluationRow) -> dict[str, Value]:
    return {
        "machine": row.key.machine,
        "program": row.key.program,
        "feature": row.key.feature,
        "feature_kind": row.kind,
        "length_mm": row.length,
        "width_mm": row.width,
        "total_depth_mm": row.total_depth,
        "material": row.key.material,
    }


def _side(side: Side, *, is_finishing: bool) -> dict[str, Value]:
    speed, factor = side.cutting_speed, side.factor
    return {
        "operation": "finishing" if is_finishing else "roughing",
        "tool": side.context.tool,
        "k_c11_n_mm2": side.specific_force,
        "cutting_speed_m_min": None if speed is None else m_min_from_speed(speed),
        "step_depth_predicted_mm": side.step_depth.predicted,
        "step_depth_evaluated_mm": side.step_depth.measured,
        "feed_per_tooth_predicted_mm": side.feed_per_tooth.predicted,
        "feed_per_tooth_evaluated_mm": side.feed_per_tooth.measured,
        "immersion_type": ", ".join(TYPES[each] for each in side.immersions),
        "strategy": ", ".join(side.strategies),
        "mode": ", ".join(side.modes),
        "outcomes": side.outcomes,
        "runs": side.runs,
        "latest": side.latest,
        "grade": side.grade.value,
        "bounds_known": side.bound.known,
        "bounds_violated": side.bound.violated,
        "bounds_wasted": side.bound.wasted,
        "highest_share_of_bound": side.bound.highest,
        "time_to_win_s": side.bound.time_to_win,
        "kc_factor": None if factor is None else factor.centre,
        "kc_factor_low": None if factor is None else factor.low,
        "kc_factor_high": None if factor is None else factor.high,
        "kc_factor_is_pending": side.is_pending,
    }


def _deviations(side: Side) -> dict[str, Value]:
    return {
        f"{which}_{name}": value
        for which in Evaluated
        for name, value in _statistics(side.deviations[which]).items()
    }


def _statistics(seen: DeviationStatistics) -> dict[str, Value]:
    """In the order of :data:`STATISTICS`."""
    trend = seen.trend
    values = (
        seen.count,
        _per_cent(seen.mean),
        _per_cent(seen.deviation),
        _per_cent(seen.standard_error),
        _per_cent(seen.median),
        _per_cent(seen.high),
        None if trend is None else PER_CENT * trend.per_run,
        None if trend is None else trend.is_significant,
    )
    return {name: value for (name, _), value in zip(STATISTICS, values, strict=True)}


def _per_cent(share: float | None) -> float | None:
    return None if share is None else PER_CENT * share


def _plain(value: Value) -> Value:
    """A time as JSON knows it."""
    return value.isoformat() if isinstance(value, datetime) else value
