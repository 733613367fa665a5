"""Figures of a learned model: predicted over simulated values, and the learning curve."""

from collections.abc import Sequence

import plotly.graph_objects as go

from extras.learning.models import LearnedModel
from extras.learning.scores import CurvePoint
from extras.learning.table import Floats, unit_of
from service.plots.panels import BLUE, GREY


def scatter_figure(model: LearnedModel, actual: Floats, predicted: Floats) -> go.Figure:
    """Predicted over actual target of the test rows, with the line on which both agree.

    Parameters
    ----------
    actual, predicted : (M,) array
        In the unit of the target's name.
    """
    target = model.target
    unit = unit_of(target)
    ends = [
        float(min(actual.min(), predicted.min())),
        float(max(actual.max(), predicted.max())),
    ]
    figure = go.Figure()
    figure.add_scatter(
        x=ends, y=ends, mode="lines", line={"color": GREY}, name="equal", hoverinfo="skip"
    )
    figure.add_scatter(
        x=actual.tolist(),
        y=predicted.tolist(),
        mode="markers",
        marker={"color": BLUE, "size": 5},
        name=model.kind.value,
    )
    figure.update_layout(template="plotly_white", height=520, margin={"t": 20})
    word = "measured" if model.physics else "simulated"
    figure.update_xaxes(title=f"{word} {target}, {unit}")
    figure.update_yaxes(title=f"predicted {target}, {unit}")
    return figure


def curve_figure(curve: Sequence[CurvePoint], unit: str) -> go.Figure:
    """Root mean squared error of the test rows over training rows, with its intervals."""
    errors = [each.scores.rmse for each in curve]
    figure = go.Figure()
    figure.add_scatter(
        x=[each.rows for each in curve],
        y=[each.value for each in errors],
        mode="lines+markers",
        line={"color": BLUE},
        error_y={
            "type": "data",
            "symmetric": False,
            "array": [each.high - each.value for each in errors],
            "arrayminus": [each.value - each.low for each in errors],
        },
    )
    figure.update_layout(template="plotly_white", height=360, margin={"t": 20})
    rows = [each.rows for each in curve]
    figure.update_xaxes(title="training rows", type="log", tickvals=rows)
    figure.update_yaxes(title=f"RMSE, {unit}", rangemode="tozero")
    return figure
