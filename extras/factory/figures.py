"""Plotly figures of a shop: states over time, shares of states, power, and a sweep."""

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from extras.factory.model.measures import Level, Quantity
from extras.factory.model.states import MachineState
from extras.factory.run import FactoryResult
from service.plots.panels import BLUE, CLEAR, FAINT, GREEN, GREY, ORANGE, PINK, RED, SKY
from stepnc_model.units import hours_from_seconds, kw_from_watts

COLOURS = {
    MachineState.MACHINING: GREEN,
    MachineState.BATCH_SETUP: BLUE,
    MachineState.PART_SETUP: SKY,
    MachineState.PART_EJECTION: "#9ad0f5",
    MachineState.BATCH_EJECTION: "#4a7fb0",
    MachineState.STARVED: "#d9d9d9",
    MachineState.BLOCKED: ORANGE,
    MachineState.WAITING: PINK,
    MachineState.FAILED: "#8b1a1a",
    MachineState.REPAIR: RED,
    MachineState.MAINTENANCE: "#b59f00",
    MachineState.IDLING: "#e6e6e6",
    MachineState.OFF: GREY,
}
"""Colours of states."""

MOST_BARS = 6_000
"""First states that are drawn."""

ROW = 34
"""Height of a machine's row, pixels."""

MOST_POINTS = 3_000
"""Most points of the power curve; of more, means are shown."""


def gantt_figure(result: FactoryResult) -> go.Figure:
    """States of each machine over time, from the first state of the first replication on."""
    figure = go.Figure()
    names = [machine.name for machine in result.shop.machines]
    rows = result.states[:MOST_BARS]
    for state, colour in COLOURS.items():
        own = [each for each in rows if each.state is state]
        if not own:
            continue
        figure.add_bar(
            x=[hours_from_seconds(each.end - each.begin) for each in own],
            base=[hours_from_seconds(each.begin) for each in own],
            y=[names[each.machine] for each in own],
            orientation="h",
            name=state.value,
            marker_color=colour,
            marker_line_width=0,
            hovertemplate="%{y}: " + state.value + "<br>%{base:.3f} h, %{x:.3f} h long",
        )
    figure.update_yaxes(categoryorder="array", categoryarray=names[::-1])
    figure.update_layout(barmode="overlay", bargap=0.25)
    return _laid_out(figure, "h", height=140 + ROW * len(names))


def share_figure(result: FactoryResult) -> go.Figure:
    """Share of each state in the time of each machine, first replication."""
    figure = go.Figure()
    names = [machine.name for machine in result.shop.machines]
    tallies = result.first.tally.machines
    for state, colour in COLOURS.items():
        seconds = np.array([each.seconds[state] for each in tallies])
        if not seconds.any():
            continue
        whole = np.array([max(sum(each.seconds.values()), 1e-9) for each in tallies])
        figure.add_bar(
            x=100.0 * seconds / whole,
            y=names,
            orientation="h",
            name=state.value,
            marker_color=colour,
            hovertemplate="%{y}: " + state.value + " %{x:.1f} %",
        )
    figure.update_yaxes(categoryorder="array", categoryarray=names[::-1])
    figure.update_layout(barmode="stack", bargap=0.25)
    return _laid_out(figure, "% of the time", height=140 + ROW * len(names))


def power_figure(result: FactoryResult) -> go.Figure:
    """Power of the whole shop over time, first replication."""
    series = result.first.tally.power
    power = kw_from_watts(1.0) * series.energies() / series.step
    # The last interval may be shorter than the others.
    power = power[: max(1, int((result.first.ended - series.begin) / series.step))]
    group = int(np.ceil(len(power) / MOST_POINTS))
    times = series.begin + series.step * np.arange(len(power))
    if group > 1:
        whole = len(power) // group * group
        power, times = power[:whole].reshape(-1, group).mean(axis=1), times[:whole:group]
    figure = go.Figure()
    figure.add_scatter(
        x=hours_from_seconds(1.0) * times,
        y=power,
        mode="lines",
        line={"color": BLUE, "width": 1.2, "shape": "hv"},
        fill="tozeroy",
        fillcolor="rgba(0,114,178,0.15)",
        name=f"mean of {series.step * group:g} s",
        hovertemplate="%{x:.2f} h: %{y:.2f} kW",
    )
    figure.update_yaxes(title="kW", rangemode="tozero")
    return _laid_out(figure, "h", height=340)


def sweep_figure(result: FactoryResult) -> go.Figure:
    """Figures of the line over the cases of a sweep."""
    shown = (Quantity.THROUGHPUT, Quantity.LEAD_TIME, Quantity.ENERGY_PER_PART)
    figure = make_subplots(cols=len(shown), rows=1, subplot_titles=[q.value for q in shown])
    labels = [", ".join(f"{value:g}" if isinstance(value, float) else value
                        for _, value in case.changes) for case in result.cases]  # fmt: skip
    for column, quantity in enumerate(shown, start=1):
        found = [
            next(
                each
                for each in case.measures
                if each.level is Level.LINE and each.quantity is quantity
            )
            for case in result.cases
        ]
        half = [each.half_width if np.isfinite(each.half_width) else 0.0 for each in found]
        figure.add_scatter(
            x=labels,
            y=[each.mean for each in found],
            error_y={"type": "data", "array": half, "thickness": 1.2},
            mode="lines+markers",
            marker_color=BLUE,
            showlegend=False,
            row=1,
            col=column,
        )
    figure.update_xaxes(type="category")
    figure.update_yaxes(rangemode="tozero")
    keys = ", ".join(key for key, _ in result.cases[0].changes)
    return _laid_out(figure, keys, height=380)


def _laid_out(figure: go.Figure, title: str, *, height: int) -> go.Figure:
    figure.update_layout(
        height=height,
        margin={"l": 90, "r": 20, "t": 40, "b": 50},
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        font={"color": GREY},
        legend={"orientation": "h", "y": 1.02, "yanchor": "bottom"},
    )
    figure.update_xaxes(gridcolor=FAINT, zerolinecolor=FAINT, title=title)
    figure.update_yaxes(gridcolor=FAINT, zerolinecolor=FAINT)
    return figure
