"""Figure of a test: predicted over simulated values."""

import plotly.graph_objects as go

from service.learning.learn import LearnResult
from service.learning.learned import unit_of
from service.panels import BLUE, GREY


def scatter_figure(result: LearnResult) -> go.Figure:
    """Predicted over simulated target of the test rows, with the line on which both agree."""
    target = result.model.target
    unit = unit_of(target)
    ends = [
        float(min(result.actual.min(), result.predicted.min())),
        float(max(result.actual.max(), result.predicted.max())),
    ]
    figure = go.Figure()
    figure.add_scatter(
        x=ends, y=ends, mode="lines", line={"color": GREY}, name="equal", hoverinfo="skip"
    )
    figure.add_scatter(
        x=result.actual.tolist(),
        y=result.predicted.tolist(),
        mode="markers",
        marker={"color": BLUE, "size": 5},
        name=result.model.kind.value,
    )
    figure.update_layout(template="plotly_white", height=520, margin={"t": 20})
    figure.update_xaxes(title=f"simulated {target}, {unit}")
    figure.update_yaxes(title=f"predicted {target}, {unit}")
    return figure
