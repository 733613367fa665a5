"""Result of ``factory``: figures of a shop as text, JSON, CSV and page."""

from collections.abc import Iterator, Mapping, Sequence
from csv import writer
from dataclasses import dataclass
from functools import partial
from io import StringIO
from math import isfinite, isnan
from typing import TYPE_CHECKING

from extras.factory.model.measures import Level, MeasureInterval, Quantity
from extras.factory.run import FactoryResult
from extras.factory.shop_sources import SweptCase
from service.outputs.formula import disarmed
from service.rendering.columns import Column, records
from service.rendering.view import Fact, Item, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.units import hours_from_seconds

if TYPE_CHECKING:
    import plotly.graph_objects as go

TITLES = {
    Level.LINE: "line",
    Level.PRODUCT: "product",
    Level.MACHINE: "machine",
    Level.PROCESS: "process",
    Level.BUFFER: "buffer, mean",
}
"""Headings of the first column by level."""

EXACT = 1e-9
"""Relative half-width that is rounding only."""

SWEPT = (
    Quantity.THROUGHPUT,
    Quantity.LEAD_TIME,
    Quantity.WIP,
    Quantity.ENERGY_PER_PART,
    Quantity.DEMAND,
)
"""Figures of the line that a sweep compares."""


TILES = (
    Quantity.THROUGHPUT, Quantity.LEAD_TIME, Quantity.WIP, Quantity.ENERGY,
    Quantity.ENERGY_PER_PART, Quantity.DEMAND,
)  # fmt: skip
"""Figures of the line at the head of the page."""

MEANING = "± 95 % interval of the mean over replications"

MEASURES: tuple[Column[MeasureInterval], ...] = (
    Column(key="level", value=lambda each: each.level.value),
    Column(key="name", value=lambda each: each.name),
    Column(key="quantity", value=lambda each: each.quantity.value),
    Column(key="mean", value=lambda each: each.mean),
    Column(key="half_width", value=lambda each: each.half_width),
    Column(key="count", value=lambda each: each.count),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureRow:
    """Figures of a machine, product, process or buffer."""

    name: str
    values: Mapping[Quantity, MeasureInterval]


def rows_of(measures: Sequence[MeasureInterval], level: Level) -> list[FigureRow]:
    """Figures of a level, one row for each name."""
    found: dict[str, dict[Quantity, MeasureInterval]] = {}
    for each in measures:
        if each.level is level:
            found.setdefault(each.name, {})[each.quantity] = each
    return [FigureRow(name=name, values=values) for name, values in found.items()]


def columns_of(rows: Sequence[FigureRow], title: str) -> tuple[Column[FigureRow], ...]:
    """Columns of the quantities that rows have."""
    quantities = dict.fromkeys(quantity for row in rows for quantity in row.values)
    names: Column[FigureRow] = Column(
        heading=title, is_key=True, is_words=True, value=lambda row: row.name or "all"
    )
    return (names, *(_column(quantity) for quantity in quantities))


def interval_text(interval: MeasureInterval) -> str:
    """Mean with the half-width of its interval, for people."""
    if isnan(interval.mean):
        return ""
    mean = f"{interval.mean:.4g}" if abs(interval.mean) < 1e4 else f"{interval.mean:.0f}"
    if not isfinite(interval.half_width):
        return mean
    if interval.half_width < EXACT * abs(interval.mean):
        return f"{mean} ± 0"
    return f"{mean} ± {interval.half_width:.2g}"


def _column(quantity: Quantity) -> Column[FigureRow]:
    return Column(
        heading=quantity.value,
        is_right=True,
        value=lambda row: interval_text(row.values[quantity]),
    )


def case_columns(cases: Sequence[SweptCase]) -> tuple[Column[SweptCase], ...]:
    """Columns of a sweep: its keys, and figures of the line."""
    keys = [key for key, _ in cases[0].changes]
    named: tuple[Column[SweptCase], ...] = tuple(
        Column(
            heading=key,
            is_key=True,
            form="g",
            value=partial(_changed, key),
        )
        for key in keys
    )
    return (*named, *(_case_column(quantity) for quantity in SWEPT))


def _changed(key: str, case: SweptCase) -> float | str:
    return dict(case.changes)[key]


def line_figure(measures: Sequence[MeasureInterval], quantity: Quantity) -> MeasureInterval:
    """Figure of the line."""
    return next(
        each for each in measures if each.level is Level.LINE and each.quantity is quantity
    )


def _case_column(quantity: Quantity) -> Column[SweptCase]:
    return Column(
        heading=quantity.value,
        is_right=True,
        value=lambda case: interval_text(line_figure(case.measures, quantity)),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShopResult(Result):
    """Result of ``factory``."""

    factory: FactoryResult

    def view(self) -> ResultView:
        """Return the figures of a shop by level, and the cases of a sweep."""
        found = self.factory
        sweep: tuple[Item, ...] = ()
        if found.cases:
            cases = Table(columns=case_columns(found.cases), rows=found.cases)
            sweep = (TextLine(text="sweep:"), cases)
        many = [TextLine(text=MEANING)] if found.replications > 1 else []
        return ResultView([
            TextLine(text=headline(found)),
            Fact(key="shop", value=found.shop.title),
            Fact(key="hours", value=hours_from_seconds(found.shop.duration)),
            Fact(key="warm_up_hours", value=hours_from_seconds(found.shop.warm_up)),
            Fact(key="seed", value=found.seed),
            Fact(key="replications", value=found.replications),
            Fact(key="ended_h", value=hours_from_seconds(found.first.ended)),
            Fact(key="is_finished", value=found.first.is_finished),
            Fact(key="parts_written", value=found.parts_written),
            *(Table(columns=columns, rows=rows) for _, columns, rows in level_tables(found)),
            Table(key="measures", columns=MEASURES, rows=found.measures, is_shown=False),
            Fact(key="states", value=list(_states(found))),
            *sweep,
            Fact(
                key="sweep",
                value=[
                    {
                        "changes": dict(case.changes),
                        "measures": records(MEASURES, case.measures),
                    }
                    for case in found.cases
                ],
            ),
            *many,
        ])  # fmt: skip

    def csv(self) -> str:
        """Return the figures as CSV, one row each."""
        stream = StringIO()
        rows = writer(stream, lineterminator="\n")
        rows.writerow(("level", "name", "figure", "mean", "half_width", "count"))
        for each in self.factory.measures:
            mean = "" if isnan(each.mean) else f"{each.mean:.10g}"
            half = f"{each.half_width:.10g}" if isfinite(each.half_width) else ""
            name = disarmed(each.name)
            rows.writerow((each.level.value, name, each.quantity.value, mean, half, each.count))
        return stream.getvalue()

    def figures(self) -> "tuple[go.Figure, ...]":
        """Return states over time, shares of the time, power, and the sweep if there is one."""
        from extras.factory.figures import (  # noqa: PLC0415 (plotly)
            gantt_figure,
            power_figure,
            share_figure,
            sweep_figure,
        )

        found = self.factory
        sweep = [sweep_figure(found)] if found.cases else []
        return (gantt_figure(found), share_figure(found), power_figure(found), *sweep)

    def page(self) -> str:
        """Return a self-contained page with pictures."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        found = self.factory
        gantt, shares, power, *sweep = self.figures()
        return rendered(
            "factory.html.jinja",
            result=found,
            headline=headline(found),
            tiles=[
                (quantity.value, interval_text(line_figure(found.measures, quantity)))
                for quantity in TILES
            ],
            tables=level_tables(found),
            gantt=plot(gantt, "gantt"),
            shares=plot(shares, "shares"),
            power=plot(power, "power"),
            cases=found.cases,
            case_columns=case_columns(found.cases) if found.cases else (),
            sweep=plot(sweep[0], "sweep") if sweep else "",
        )


def headline(result: FactoryResult) -> str:
    """Summary of the run, in one line."""
    shop, run = result.shop, result.first
    hours = f"{hours_from_seconds(shop.duration):g} h"
    warm_up = f", {hours_from_seconds(shop.warm_up):g} h warm-up" if shop.warm_up else ""
    runs = f", {result.replications} replications" if result.replications > 1 else ""
    over = ""
    if run.is_finished:
        over = f"; all orders finished after {hours_from_seconds(run.ended):.2f} h"
    return f"{shop.title}: {hours}{warm_up}, seed {result.seed}{runs}{over}"


def level_tables(
    result: FactoryResult,
) -> list[tuple[str, tuple[Column[FigureRow], ...], list[FigureRow]]]:
    """Titles, columns and rows of the levels that have figures."""
    found = ((level, rows_of(result.measures, level)) for level in Level)
    return [
        (TITLES[level], columns_of(rows, TITLES[level]), rows) for level, rows in found if rows
    ]


def _states(result: FactoryResult) -> Iterator[dict[str, object]]:
    """Yield the time of each machine in each of its states."""
    machines = zip(result.shop.machines, result.first.tally.machines, strict=True)
    for machine, tally in machines:
        for state, time in tally.seconds.items():
            if time > 0.0:
                hours = hours_from_seconds(time)
                yield {"machine": machine.name, "state": state.value, "hours": hours}
