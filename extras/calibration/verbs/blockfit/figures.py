"""Plotly figure of a fitted block rate."""

import numpy as np
import plotly.graph_objects as go

from extras.calibration.model.block_fit import BlockFit, FeedCause
from service.plots.panels import BLUE, FAINT, GREEN, GREY, ORANGE, RED
from service.verbs.cycletime.figures import laid_out
from simulator.motion.segments import Floats
from stepnc_model.units import SECONDS_PER_MINUTE, mm_min_from_speed

COLOURS = {
    "through the origin": GREEN,
    "with an intercept": ORANGE,
    "robust": BLUE,
}
"""Colours of the fits."""

_ON_LINE = FeedCause.BLOCK_RATE


def block_fit_figure(fit: BlockFit, paper: BlockFit, *, printed: float) -> go.Figure:
    """Feed over spacing: points, fits, and Table 2 with its printed line.

    Parameters
    ----------
    fit, paper : BlockFit
        What is shown, and the fit of Table 2.
    printed : float, 1/min
        Slope of the line that paper 004 prints.
    """
    figure = go.Figure()
    spacing = np.array([each.spacing for each in (*fit.points, *paper.points)])
    ends = np.geomspace(spacing.min(), spacing.max(), 40)
    for each in fit.fits:
        start = 0.0 if each.intercept is None else each.intercept.value
        _line(figure, each.name, ends, each.slope.value * ends + start, COLOURS[each.name])
    for cause in FeedCause:
        rows = [row for row, of in enumerate(fit.causes) if of is cause]
        if rows:
            figure.add_scatter(
                x=[fit.points[row].spacing for row in rows],
                y=[mm_min_from_speed(fit.points[row].feed) for row in rows],
                mode="markers",
                name=f"held by: {cause.value}",
                marker={"size": 9, "symbol": "circle" if cause is _ON_LINE else "x"},
                marker_color=BLUE if cause is _ON_LINE else RED,
            )
    figure.add_scatter(
        x=[each.spacing for each in paper.points],
        y=[mm_min_from_speed(each.feed) for each in paper.points],
        mode="markers",
        name="paper 004, Table 2",
        marker={"size": 9, "symbol": "diamond-open", "color": GREY},
    )
    _line(figure, "printed line, no fit of it", ends, printed / 60.0 * ends, GREY, dash="dot")
    laid_out(figure)
    figure.update_xaxes(type="log", title="spacing, mm", gridcolor=FAINT)
    return figure.update_yaxes(type="log", title="greatest feed, mm/min", gridcolor=FAINT)


def _line(
    figure: go.Figure,
    name: str,
    spacing: Floats,
    speed: Floats,
    colour: str,
    *,
    dash: str = "solid",
) -> None:
    """Add a line of speed over spacing, where the speed is positive."""
    rows = speed > 0.0
    figure.add_scatter(
        x=spacing[rows].tolist(),
        y=(SECONDS_PER_MINUTE * speed[rows]).tolist(),
        mode="lines",
        name=name,
        line={"color": colour, "dash": dash, "width": 1.5},
    )
