"""Result of ``blockfit``: points, fits and what limits the feed, beside paper 004."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from extras.calibration.model.block_feed import CircleFeed
from extras.calibration.model.block_fit import (
    BlockFit,
    FeedCause,
    IntervalEstimate,
    LineFit,
    SpacingFeed,
    fitted_block_time,
)
from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.errors import Finding
from stepnc_model.units import (
    SECONDS_PER_MINUTE,
    mm_from_inches,
    mm_min_from_speed,
    speed_from_mm_min,
)

if TYPE_CHECKING:
    import plotly.graph_objects as go

TABLE_2 = (
    (0.0001, 0.7), (0.00025, 3.6), (0.0005, 7.2), (0.00075, 10.5), (0.001, 14.6),
    (0.0025, 35.6), (0.005, 71.2), (0.0075, 106.7), (0.01, 147.68),
)  # fmt: skip
"""Spacings, in, and greatest feeds, in/min, of Table 2 of paper 004."""

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


def _interval(estimate: IntervalEstimate | None, factor: float, form: str) -> str:
    if estimate is None:
        return "0"
    low, high = (format(factor * end, form) for end in (estimate.low, estimate.high))
    return f"{format(factor * estimate.value, form)} ({low} to {high})"


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockFitResult(Result):
    """Result of ``blockfit``."""

    log: str
    fit: BlockFit
    circles: tuple[CircleFeed, ...]
    """Circles found in a log, in order; empty for a table."""
    findings: tuple[Finding, ...]

    def rows(self) -> list[SpacingRow]:
        """Rows of all points."""
        found = {(each.circle.spacing, each.circle.radius): each for each in self.circles}
        fit = self.fit
        rows = []
        for point, cause, residual in zip(
            fit.points, fit.causes, fit.fits[-1].residual.tolist(), strict=True
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

    def statements(self) -> list[str]:
        """Sentences on what limits the feed."""
        fit = self.fit
        lines = [f"block time {_interval(fit.block_time, MS, '.3f')} ms, by the robust fit"]
        held = [each for each in FeedCause if fit.causes.count(each)]
        lines.append(
            "held by: " + ", ".join(f"{each.value} {fit.causes.count(each)}" for each in held)
        )
        if fit.acceleration is not None:
            lines.append(
                f"acceleration {fit.acceleration:.0f} mm/s², by the points that it holds"
            )
        if fit.corner is not None:
            lines.append(
                f"corners: junction deviation times acceleration {fit.corner:.1f} mm²/s², by "
                "the points that they hold"
            )
        return lines

    def view(self) -> ResultView:
        """Return points, fits and what limits the feed."""
        fit = self.fit
        return ResultView([
            Fact(key="log", value=self.log),
            Fact(key="block_time_ms", value=_record(fit.block_time, MS)),
            Fact(key="fits", value=[_fit_record(each) for each in fit.fits]),
            Table(key="points", columns=POINTS, rows=self.rows()),
            Table(columns=FITS, rows=fit.fits),
            *(TextLine(text=line) for line in self.statements()),
            Fact(key="acceleration_mm_s2", value=fit.acceleration),
            Fact(key="deviation_times_acceleration_mm2_s2", value=fit.corner),
            Findings(findings=self.findings),
        ])

    def figures(self) -> "tuple[go.Figure]":
        """Return feed over spacing with the fits, beside Table 2 of paper 004."""
        from extras.calibration.verbs.blockfit.figures import block_fit_figure  # noqa: PLC0415 (plotly)

        return (block_fit_figure(self.fit, paper_fit(), printed=PRINTED_SLOPE),)

    def page(self) -> str:
        """Return a self-contained page, beside Table 2 of paper 004."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        return rendered(
            "blocks.html.jinja",
            result=self,
            points=POINTS,
            fits=FITS,
            paper=paper_fit(),
            printed_slope=PRINTED_SLOPE,
            figure=plot(self.plot(), "feeds"),
        )


def paper_fit() -> BlockFit:
    """Fit of the greatest feeds of paper 004, Table 2."""
    return fitted_block_time([
        SpacingFeed(
            spacing=mm_from_inches(spacing),
            feed=speed_from_mm_min(mm_from_inches(feed)),
            radius=mm_from_inches(1.0),
        )
        for spacing, feed in TABLE_2
    ])


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


def _record(estimate: IntervalEstimate, factor: float) -> dict[str, float]:
    return {
        "value": factor * estimate.value,
        "low": factor * estimate.low,
        "high": factor * estimate.high,
    }
