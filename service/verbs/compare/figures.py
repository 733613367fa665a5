"""Plotly figures of a comparison, in colours for the colour-blind (Okabe and Ito, 2008)."""

from collections.abc import Sequence
from itertools import cycle

import plotly.graph_objects as go

from service.plots.panels import CLEAR, FAINT, LEGEND
from service.verbs.compare.plan import PlanTotal

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#757575")


def compared_figures(totals: Sequence[PlanTotal]) -> tuple[go.Figure, ...]:
    """Time against energy of the plans, and the time of each workingstep by plan."""
    trade, times = go.Figure(), go.Figure()
    for row, colour in zip(totals, cycle(COLOURS), strict=False):
        name = row.named.name
        trade.add_scatter(
            x=[row.time], y=[row.energy * 1e-3], name=name, mode="markers",
            marker={"size": 12, "color": colour},
        )  # fmt: skip
        steps = row.named.plan.workingsteps
        times.add_bar(
            x=[step.id for step in steps], y=[step.time for step in steps], name=name,
            marker_color=colour,
        )  # fmt: skip
    for figure in (trade, times):
        figure.update_layout(
            paper_bgcolor=CLEAR, plot_bgcolor=CLEAR, legend=LEGEND, height=360,
            margin={"l": 10, "r": 10, "t": 40, "b": 40},
        )  # fmt: skip
        figure.update_xaxes(automargin=True, gridcolor=FAINT)
        figure.update_yaxes(automargin=True, gridcolor=FAINT)
    trade.update_layout(xaxis_title="time s", yaxis_title="energy kJ")
    times.update_layout(barmode="group", yaxis_title="time s")
    return trade, times
