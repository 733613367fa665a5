"""Result of ``blockfit`` as text, JSON and page."""

from dataclasses import dataclass
from typing import Any

from service.blocks.block_fit import BlockFitResult, paper_points
from service.rendering.columns import Column
from service.rendering.pages import plot, rendered
from service.rendering.records import dump, finding_record, records
from service.rendering.text import print_findings, print_line, print_table
from simulator.calibration.block_fit import (
    FeedCause,
    IntervalEstimate,
    LineFit,
    SpacingFeed,
    fitted_block_time,
)
from stepnc_model.units import SECONDS_PER_MINUTE, mm_min_from_speed

PRINTED_SLOPE = 14_847.0
"""Slope printed in paper 004, 1/min."""

MS = 1e3
"""Milliseconds in a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpacingRow:
    """Row of a point."""

    point: SpacingFeed
    cause: FeedCause
    residual: float
    """Feed less that of the robust line, mm/s."""
    low: float | None
    """Lower end of the interval of a feed from samples, mm/s."""
    high: float | None
    samples: int | None


def point_rows(result: BlockFitResult) -> list[SpacingRow]:
    """Rows of all points."""
    found = {(each.circle.spacing, each.circle.radius): each for each in result.circles}
    robust = result.fit.fits[-1]
    rows = []
    for point, cause, residual in zip(
        result.fit.points, result.fit.causes, robust.residual.tolist(), strict=True
    ):
        circle = found.get((point.spacing, point.radius or 0.0))
        rows.append(
            SpacingRow(
                point=point,
                cause=cause,
                residual=residual,
                low=None if circle is None else circle.low,
                high=None if circle is None else circle.high,
                samples=None if circle is None else circle.samples,
            )
        )
    return rows


def _mm_min(speed: float | None) -> float | None:
    return None if speed is None else mm_min_from_speed(speed)


POINTS: tuple[Column[SpacingRow], ...] = (
    Column(
        key="radius_mm", heading="radius mm", form=".2f", is_optional=True, help="R",
        value=lambda row: row.point.radius,
    ),
    Column(
        key="spacing_mm", heading="spacing mm", form=".5f", help="s",
        value=lambda row: row.point.spacing,
    ),
    Column(
        key="commanded_mm_min", heading="F mm/min", form=".0f", is_optional=True,
        value=lambda row: _mm_min(row.point.commanded),
    ),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".2f", help="v",
        value=lambda row: _mm_min(row.point.feed),
    ),
    Column(key="feed_low_mm_min", value=lambda row: _mm_min(row.low)),
    Column(key="feed_high_mm_min", value=lambda row: _mm_min(row.high)),
    Column(
        key="samples", heading="samples", form=".0f", is_optional=True,
        value=lambda row: row.samples,
    ),
    Column(
        key="block_ms", heading="ms a block", form=".3f", help="s/v",
        value=lambda row: MS * row.point.time,
    ),
    Column(
        key="residual_mm_min", heading="off the line mm/min", form="+.2f",
        value=lambda row: _mm_min(row.residual),
    ),
    Column(key="cause", heading="held by", is_words=True, value=lambda row: row.cause.value),
)  # fmt: skip


def _interval(each: IntervalEstimate | None, factor: float, form: str) -> str:
    if each is None:
        return "0"
    low, high = (format(factor * end, form) for end in (each.low, each.high))
    return f"{format(factor * each.value, form)} ({low} to {high})"


FITS: tuple[Column[LineFit], ...] = (
    Column(heading="fit", value=lambda fit: fit.name, is_words=True),
    Column(
        heading="slope 1/min (95 %)",
        value=lambda fit: _interval(fit.slope, SECONDS_PER_MINUTE, ".0f"),
    ),
    Column(
        heading="ms a block (95 %)",
        value=lambda fit: _interval(fit.slope.inverse, MS, ".3f"),
    ),
    Column(
        heading="intercept mm/min (95 %)",
        value=lambda fit: _interval(fit.intercept, SECONDS_PER_MINUTE, ".1f"),
    ),
)


def print_block_fit(result: BlockFitResult) -> None:
    """Print points, fits and what else was found."""
    print_table(POINTS, point_rows(result))
    print_table(FITS, result.fit.fits)
    for line in statements(result):
        print_line(line)
    print_findings(result.findings)


def statements(result: BlockFitResult) -> list[str]:
    """Sentences on what limits the feed."""
    fit = result.fit
    lines = [f"block time {_interval(fit.block_time, MS, '.3f')} ms, by the robust fit"]
    held = [each for each in FeedCause if fit.causes.count(each)]
    lines.append(
        "held by: " + ", ".join(f"{each.value} {fit.causes.count(each)}" for each in held)
    )
    if fit.acceleration is not None:
        lines.append(f"acceleration {fit.acceleration:.0f} mm/s², by the points that it holds")
    if fit.corner is not None:
        lines.append(
            f"corners: junction deviation times acceleration {fit.corner:.1f} mm²/s², by the "
            "points that they hold"
        )
    return lines


def block_fit_json(result: BlockFitResult) -> str:
    """Return points, fits and block time as JSON; keys carry their units."""
    fit = result.fit
    return dump({
        "log": result.log,
        "block_time_ms": _record(fit.block_time, MS),
        "fits": [_fit_record(each) for each in fit.fits],
        "points": records(POINTS, point_rows(result)),
        "acceleration_mm_s2": fit.acceleration,
        "deviation_times_acceleration_mm2_s2": fit.corner,
        "findings": [finding_record(each) for each in result.findings],
    })


def _fit_record(fit: LineFit) -> dict[str, Any]:
    return {
        "fit": fit.name,
        "slope_per_min": _record(fit.slope, SECONDS_PER_MINUTE),
        "block_time_ms": _record(fit.slope.inverse, MS),
        "intercept_mm_min": None
        if fit.intercept is None
        else _record(fit.intercept, SECONDS_PER_MINUTE),
        "residuals_mm_min": [mm_min_from_speed(each) for each in fit.residual.tolist()],
    }


def _record(each: IntervalEstimate, factor: float) -> dict[str, float]:
    return {
        "value": factor * each.value,
        "low": factor * each.low,
        "high": factor * each.high,
    }


def block_fit_page(result: BlockFitResult) -> str:
    """Return the result as a self-contained page, beside Table 2 of paper 004."""
    from service.blocks.figures import block_fit_figure  # noqa: PLC0415 (slow to import)

    paper = fitted_block_time(paper_points())
    return rendered(
        "blocks.html.jinja",
        result=result,
        points=POINTS,
        rows=point_rows(result),
        fits=FITS,
        statements=statements(result),
        paper=paper,
        printed_slope=PRINTED_SLOPE,
        figure=plot(block_fit_figure(result.fit, paper, printed=PRINTED_SLOPE), "feeds"),
    )
