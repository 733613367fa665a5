"""Plotly figures of a plan, in colours that the colour-blind tell apart (Okabe, Ito 2008)."""

from collections.abc import Sequence

import plotly.graph_objects as go

from optimiser.advice import Advice, Plan, State, Status, tightest
from optimiser.limit import LimitName, Sense
from stepnc_model.units import kw_from_watts, mm_min_from_speed

BEFORE, AFTER, BOUND = "#999999", "#0072B2", "#D55E00"
ROW = 26
"""pixels of one workingstep in a figure"""


def time_figure(plan: Plan) -> go.Figure:
    """Time of each workingstep as programmed and as advised."""
    shown = [advice for advice in plan.advices if advice.before is not None]
    figure = go.Figure([
        _bars("programmed", BEFORE, shown, [_time(advice.before) for advice in shown]),
        _bars(
            "advised", AFTER, shown, [_time(advice.after or advice.before) for advice in shown]
        ),
    ])
    return _laid_out(figure, "Time by workingstep", "s", len(shown))


def power_figure(plan: Plan) -> go.Figure:
    """Motor power of each workingstep before and after, and what the motor has."""
    shown = [advice for advice in plan.advices if advice.before is not None]
    figure = go.Figure([
        _bars("programmed", BEFORE, shown, [_power(advice.before) for advice in shown]),
        _bars(
            "advised", AFTER, shown, [_power(advice.after or advice.before) for advice in shown]
        ),
    ])
    bounds = [_power_bound(advice) for advice in shown]
    figure.add_scatter(
        x=bounds,
        y=_names(shown),
        mode="markers",
        name="motor at this speed",
        marker={"symbol": "line-ns-open", "size": 18, "color": BOUND, "line": {"width": 3}},
    )
    return _laid_out(figure, "Motor power before and after", "kW", len(shown))


def limits_figure(plan: Plan) -> go.Figure:
    """How much of each limit every advised workingstep uses."""
    shown = [advice for advice in plan.advices if advice.after is not None]
    names = list(LimitName)
    rows = [_shares(advice) for advice in shown]
    used = [name for name in names if any(name in row for row in rows)]
    cells = [[row.get(name) for name in used] for row in rows]
    figure = go.Figure(
        go.Heatmap(
            x=[name.words for name in used],
            y=_names(shown),
            z=cells,
            text=[["" if cell is None else f"{cell:.0%}" for cell in row] for row in cells],
            texttemplate="%{text}",
            colorscale=[[0.0, "#f7fbff"], [0.7, "#6baed6"], [0.99, "#2171b5"], [1.0, BOUND]],
            zmin=0.0,
            zmax=1.0,
            colorbar={"title": "used", "tickformat": ".0%"},
            hovertemplate="%{y}<br>%{x}: %{text}<extra></extra>",
        )
    )
    return _laid_out(figure, "Share of each limit that the advice uses", "", len(shown))


def feed_figure(plan: Plan) -> go.Figure:
    """Feed of each workingstep as programmed and as advised."""
    shown = [advice for advice in plan.advices if advice.before is not None]
    figure = go.Figure([
        _bars("programmed", BEFORE, shown, [_feed(advice.before) for advice in shown]),
        _bars(
            "advised", AFTER, shown, [_feed(advice.after or advice.before) for advice in shown]
        ),
    ])
    return _laid_out(figure, "Feed", "mm/min", len(shown))


def front_figure(plan: Plan) -> go.Figure | None:
    """Fronts between time and roughness, or None when none was asked for."""
    figure = go.Figure()
    for advice in plan.advices:
        points = [point for point in advice.front if point.state.roughness]
        if len(points) > 1:
            figure.add_scatter(
                x=[point.state.time for point in points],
                y=[(point.state.roughness or 0.0) * 1e3 for point in points],
                customdata=[point.state.energy / 1e3 for point in points],
                hovertemplate="%{x:.1f} s, Ra %{y:.2f} µm, %{customdata:.1f} kJ",
                mode="lines+markers",
                name=advice.workingstep.id,
            )
    if not figure.data:
        return None
    figure.update_yaxes(type="log", title="Ra µm")
    figure.update_xaxes(type="log", title="s")
    figure.update_layout(
        title="Fronts between time and roughness", height=420, template="plotly_white"
    )
    return figure


def _bars(name: str, colour: str, shown: Sequence[Advice], values: list[float]) -> go.Bar:
    return go.Bar(name=name, y=_names(shown), x=values, orientation="h", marker_color=colour)


def _names(shown: Sequence[Advice]) -> list[str]:
    """Ids, numbered where several workingsteps have the same."""
    names: list[str] = []
    for advice in shown:
        name = advice.workingstep.id or str(advice.workingstep.ref)
        names.append(f"{name} ({advice.workingstep.ref})" if name in names else name)
    return names


def _time(state: State | None) -> float:
    return state.time if state is not None else 0.0


def _power(state: State | None) -> float:
    return kw_from_watts(state.motor_power) if state is not None else 0.0


def _feed(state: State | None) -> float:
    return mm_min_from_speed(state.feed) if state is not None else 0.0


def _power_bound(advice: Advice) -> float | None:
    """Motor power at the advised speed in kW."""
    state = advice.after or advice.before
    loads = state.loads if state is not None else ()
    bounds = [load.bound for load in loads if load.limit.name is LimitName.MOTOR_POWER]
    return kw_from_watts(min(bounds)) if bounds else None


def _shares(advice: Advice) -> dict[LimitName, float]:
    """Load over bound, for the limits from above."""
    if advice.after is None or advice.status is Status.INFEASIBLE:
        return {}
    return {
        load.limit.name: 1.0 - load.margin
        for load in tightest(advice.after.loads)
        if load.limit.sense is Sense.AT_MOST
    }


def _laid_out(figure: go.Figure, title: str, unit: str, rows: int) -> go.Figure:
    """Common layout: the program's order from the top."""
    figure.update_layout(
        title=title,
        template="plotly_white",
        height=150 + ROW * max(rows, 3),
        barmode="group",
        margin={"l": 10, "r": 10, "t": 50, "b": 40},
        legend={
            "orientation": "h",
            "y": 1.0,
            "yanchor": "bottom",
            "x": 1.0,
            "xanchor": "right",
        },
    )
    figure.update_yaxes(autorange="reversed", automargin=True)
    figure.update_xaxes(title=unit or None, automargin=True)
    return figure
