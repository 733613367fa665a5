"""Result of ``factory`` as text, JSON and page."""

from collections.abc import Mapping, Sequence
from csv import writer
from dataclasses import dataclass
from functools import partial
from io import StringIO
from math import isfinite, isnan

from service.factory.run import FactoryResult
from service.factory.sweep import SweptCase
from service.formula import disarmed
from service.rendering.columns import Column
from service.rendering.pages import plot, rendered
from service.rendering.records import dump
from service.rendering.text import print_line, print_table
from simulator.factory.measures import Level, MeasureInterval, Quantity
from stepnc_model.units import hours_from_seconds

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


def headline(result: FactoryResult) -> str:
    """What was run, in one line."""
    shop, run = result.shop, result.first
    hours = f"{hours_from_seconds(shop.duration):g} h"
    warm_up = f", {hours_from_seconds(shop.warm_up):g} h warm-up" if shop.warm_up else ""
    runs = f", {result.replications} replications" if result.replications > 1 else ""
    over = ""
    if run.is_finished:
        over = f"; all orders finished after {hours_from_seconds(run.ended):.2f} h"
    return f"{shop.title}: {hours}{warm_up}, seed {result.seed}{runs}{over}"


def print_factory(result: FactoryResult) -> None:
    """Print the figures of a shop by level, and the cases of a sweep."""
    print_line(headline(result))
    for level in Level:
        rows = rows_of(result.measures, level)
        if rows:
            print_table(columns_of(rows, TITLES[level]), rows)
    if result.cases:
        print_line("sweep:")
        print_table(case_columns(result.cases), result.cases)
    if result.replications > 1:
        print_line("± 95 % interval of the mean over replications")


def factory_json(result: FactoryResult) -> str:
    """Return the figures as JSON; the name of a quantity has its unit."""
    return dump({
        "shop": result.shop.title,
        "hours": hours_from_seconds(result.shop.duration),
        "warm_up_hours": hours_from_seconds(result.shop.warm_up),
        "seed": result.seed,
        "replications": result.replications,
        "ended_h": hours_from_seconds(result.first.ended),
        "is_finished": result.first.is_finished,
        "parts_written": result.parts_written,
        "measures": [_record(each) for each in result.measures],
        "states": [
            {"machine": machine.name, "state": state.value, "hours": hours_from_seconds(time)}
            for machine, tally in zip(
                result.shop.machines, result.first.tally.machines, strict=True
            )
            for state, time in tally.seconds.items()
            if time > 0.0
        ],
        "sweep": [
            {
                "changes": dict(case.changes),
                "measures": [_record(each) for each in case.measures],
            }
            for case in result.cases
        ],
    })


def _record(interval: MeasureInterval) -> dict[str, object]:
    return {
        "level": interval.level.value,
        "name": interval.name,
        "quantity": interval.quantity.value,
        "mean": interval.mean if isfinite(interval.mean) else None,
        "half_width": interval.half_width if isfinite(interval.half_width) else None,
        "count": interval.count,
    }


def factory_csv(result: FactoryResult) -> str:
    """Return the figures as CSV, one row each."""
    stream = StringIO()
    rows = writer(stream, lineterminator="\n")
    rows.writerow(("level", "name", "figure", "mean", "half_width", "count"))
    for each in result.measures:
        mean = "" if isnan(each.mean) else f"{each.mean:.10g}"
        half = f"{each.half_width:.10g}" if isfinite(each.half_width) else ""
        name = disarmed(each.name)
        rows.writerow((each.level.value, name, each.quantity.value, mean, half, each.count))
    return stream.getvalue()


def factory_page(result: FactoryResult) -> str:
    """Return the figures as a self-contained page with pictures."""
    from service.factory.figures import (  # noqa: PLC0415 (slow to import)
        gantt_figure,
        power_figure,
        share_figure,
        sweep_figure,
    )

    tables = []
    for level in Level:
        rows = rows_of(result.measures, level)
        if rows:
            tables.append((TITLES[level], columns_of(rows, TITLES[level]), rows))
    tiles = [
        (quantity.value, interval_text(line_figure(result.measures, quantity)))
        for quantity in (
            Quantity.THROUGHPUT, Quantity.LEAD_TIME, Quantity.WIP, Quantity.ENERGY,
            Quantity.ENERGY_PER_PART, Quantity.DEMAND,
        )
    ]  # fmt: skip
    return rendered(
        "factory.html.jinja",
        result=result,
        headline=headline(result),
        tiles=tiles,
        tables=tables,
        gantt=plot(gantt_figure(result), "gantt"),
        shares=plot(share_figure(result), "shares"),
        power=plot(power_figure(result), "power"),
        cases=result.cases,
        case_columns=case_columns(result.cases) if result.cases else (),
        sweep=plot(sweep_figure(result), "sweep") if result.cases else "",
    )
