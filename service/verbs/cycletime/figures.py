"""Plotly figure of a cycle time."""

import numpy as np
import plotly.graph_objects as go

from service.plots.panels import BLUE, CLEAR, FAINT, GREY, ORANGE
from simulator.machine.block_times import BlockTimes
from stepnc_model.units import SECONDS_PER_MINUTE

HEIGHT = 560

MOST_POINTS = 4_000
"""Most blocks that are drawn; of more, the slowest of each group is shown."""


def cycle_time_figure(times: BlockTimes) -> go.Figure:
    """Feed of each feed block: as programmed, by the block rate, and by the control."""
    rows = np.flatnonzero((times.is_rapid == 0) & (times.length > 0.0))
    feeds = [
        SECONDS_PER_MINUTE * times.length[rows] / np.maximum(seconds[rows], 1e-12)
        for seconds in (times.programmed, times.by_rate, times.predicted)
    ]
    group = max(1, -(-len(rows) // MOST_POINTS))
    starts = np.arange(0, len(rows), group)
    figure = go.Figure()
    for name, colour, feed in (
        ("programmed", GREY, feeds[0]),
        ("by the block rate", ORANGE, feeds[1]),
        ("predicted", BLUE, feeds[2]),
    ):
        figure.add_scatter(
            x=times.line[rows[starts]].tolist(),
            y=np.minimum.reduceat(feed, starts).tolist() if len(rows) else [],
            mode="lines",
            name=name,
            line={"color": colour, "width": 1.5},
        )
    laid_out(figure)
    figure.update_xaxes(title="block", gridcolor=FAINT)
    return figure.update_yaxes(title="feed, mm/min", rangemode="tozero", gridcolor=FAINT)


def laid_out(figure: go.Figure) -> None:
    """Apply the common layout."""
    figure.update_layout(
        height=HEIGHT,
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        margin={"l": 60, "r": 10, "t": 20, "b": 50},
        legend={"orientation": "h", "y": 1.02, "yanchor": "bottom"},
    )
