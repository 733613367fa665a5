"""Plotly figures of feeds along the paths: before and after, and the path coloured by feed."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from service.along_path.plan_run import LimitStretch
from service.along_path.run import FeedsAlongPath
from service.along_path.trace import PathSignal, PathTrace
from service.plots.buckets import BucketedRun
from service.plots.panels import (
    BLUE,
    CLEAR,
    FAINT,
    GREEN,
    GREY,
    LEGEND,
    ORANGE,
    PINK,
    RED,
    SKY,
    key,
)
from simulator.motion.segments import Floats

COLOURS = (
    SKY, ORANGE, GREEN, PINK, BLUE, RED, "#F0E442", "#999999", "#44AA99", "#882255", "#332288",
    "#DDCC77", "#117733", "#CC6677", "#88CCEE", "#661100",
)  # fmt: skip
"""Colours of limits, in the order of the length that they hold."""

PANELS = (
    (PathSignal.FEED, "feed, mm/min"),
    (PathSignal.FORCE, "force, N"),
    (PathSignal.POWER, "spindle drive, kW"),
)

SPEED_SCALE = "Viridis"
"""Colour scale of the feed, which the colour-blind can read."""


def along_path_figures(along: FeedsAlongPath) -> list[go.Figure]:
    """Figures by path length and over time, and the path; none without traces."""
    if along.before_trace is None or along.after_trace is None:
        return []
    before, after = along.before_trace, along.after_trace
    by_length = _compared(before.along, after.along, "Along the path", "length of the path, mm")
    _add_strip(by_length, along.limits)
    over_time = _compared(before.over_time, after.over_time, "Over time", "time, s")
    return [by_length, over_time, _path(after)]


def _compared(before: BucketedRun, after: BucketedRun, title: str, axis: str) -> go.Figure:
    """Feed, force and power of both runs in panels above each other."""
    figure = go.Figure()
    for number, (signal, name) in enumerate(PANELS, 1):
        for words, colour, run in (("one feed", GREY, before), ("along the path", BLUE, after)):
            x, y = _outline(run, signal)
            figure.add_scatter(
                x=x,
                y=y,
                name=words,
                mode="lines",
                line={"color": colour, "width": 1},
                yaxis=f"y{number}" if number > 1 else "y",
                showlegend=number == 1,
                legendgroup=words,
                hovertemplate="%{y:.4~r}",
            )
        low, high = 0.90 - 0.30 * number, 0.90 - 0.30 * number + 0.25
        figure.layout[f"yaxis{number}" if number > 1 else "yaxis"] = {
            "domain": [max(low, 0.0), high],
            "title": name,
            "type": "log" if signal is PathSignal.FEED else "linear",
            "gridcolor": FAINT,
            "zerolinecolor": GREY,
        }
    figure.update_xaxes(title=axis, gridcolor=FAINT, anchor=f"y{len(PANELS)}")
    return figure.update_layout(
        title=title,
        height=620,
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        margin={"l": 10, "r": 10, "t": 50, "b": 40},
        legend=LEGEND,
        hovermode="x unified",
        hoverlabel_bgcolor="#ffffff",
    )


def _outline(run: BucketedRun, signal: PathSignal) -> tuple[Floats, Floats]:
    """Line through the minimum and the maximum of each bucket."""
    curve = run.curve(signal)
    x = np.column_stack((run.begin, run.end)).ravel()
    y = np.column_stack((curve.low, curve.high)).ravel()
    return x.astype(np.float32), y.astype(np.float32)


def _add_strip(figure: go.Figure, limits: Sequence[LimitStretch]) -> None:
    """Add the active limit at each place as a strip above the panels."""
    lengths: dict[str, float] = {}
    for each in limits:
        lengths[each.words] = lengths.get(each.words, 0.0) + each.end - each.begin
    ordered = sorted(lengths, key=lambda words: -lengths[words])
    for row, words in enumerate(ordered):
        rows = [each for each in limits if each.words == words]
        figure.add_bar(
            x=[0.5 * (each.begin + each.end) for each in rows],
            width=[each.end - each.begin for each in rows],
            y=[1.0] * len(rows),
            name=words,
            marker_color=COLOURS[row % len(COLOURS)],
            marker_line_width=0,
            yaxis="y4",
            hovertemplate=f"{words}<extra></extra>",
            legend="legend2",
        )
    figure.update_layout(
        yaxis4={
            "domain": [0.92, 0.97],
            "showticklabels": False,
            "showgrid": False,
            "range": [0.0, 1.0],
            "fixedrange": True,
        },
        legend2={"orientation": "h", "y": -0.12, "yanchor": "top", "x": 0.0},
        barmode="overlay",
        title=f"{figure.layout.title.text}; strip: {key('active limit', GREY)}",
    )


def _path(trace: PathTrace) -> go.Figure:
    """Path of the tool in space, coloured by its feed."""
    x, y, z, feed = trace.points.T
    shade = np.log10(np.maximum(feed, 1.0))
    ticks = list(range(int(shade.max(initial=0.0)) + 1))
    figure = go.Figure(
        go.Scatter3d(
            x=x,
            y=y,
            z=z,
            mode="lines",
            line={
                "color": shade,
                "colorscale": SPEED_SCALE,
                "width": 3,
                "colorbar": {
                    "title": "mm/min",
                    "tickvals": ticks,
                    "ticktext": [f"{10**tick:g}" for tick in ticks],
                },
            },
            customdata=feed,
            hovertemplate="%{x:.2f}, %{y:.2f}, %{z:.2f} mm<br>%{customdata:.0f} mm/min"
            "<extra></extra>",
        )
    )
    return figure.update_layout(
        title="Path, coloured by feed",
        height=620,
        paper_bgcolor=CLEAR,
        margin={"l": 0, "r": 0, "t": 50, "b": 0},
        scene={"aspectmode": "data"},
    )
