"""Plotly figures of a plan, in colours for the colour-blind (Okabe and Ito, 2008)."""

from collections.abc import Callable, Iterator, Sequence

import plotly.graph_objects as go

from optimiser.advice import Advice, EvaluatedSetting, Plan, tightest
from optimiser.bounds.roughness import IDEAL
from optimiser.solver.problem import BoundSide, LimitName
from service.plots.panels import BLUE, CLEAR, FAINT, GREY, LEGEND, RED
from stepnc_model.units import kj_from_joules, kw_from_watts, mm_min_from_speed, um_from_mm

ROW = 26
"""Height of the row of one workingstep in a figure, in pixels."""

USED = [
    [0.0, "rgba(86,180,233,0.05)"],
    [0.99, "rgba(86,180,233,0.6)"],
    [1.0, "rgba(213,94,0,0.6)"],
]
"""Colour scale for the used share of a limit: orange at the bound; labels legible on all."""


def plan_figures(plan: Plan) -> Iterator[go.Figure]:
    """Yield figures of time, feed, power and limits by workingstep, and any Pareto fronts."""
    timed = [advice for advice in plan.advices if advice.before is not None]
    yield _compared(timed, lambda state: state.time, "Time by workingstep", "s")
    yield _compared(timed, lambda state: mm_min_from_speed(state.feed), "Feed", "mm/min")
    power = _compared(
        timed,
        lambda state: kw_from_watts(state.motor_power),
        "Motor power before and after",
        "kW",
    )
    yield power.add_scatter(
        x=[_power_bound(advice) for advice in timed],
        y=_names(timed),
        mode="markers",
        name="motor at this speed",
        marker={"symbol": "line-ns-open", "size": 18, "color": RED, "line": {"width": 3}},
    )
    yield _limits(plan)
    fronts = _fronts(plan)
    if fronts.data:
        yield fronts


def _compared(
    timed: Sequence[Advice], value: Callable[[EvaluatedSetting], float], title: str, unit: str
) -> go.Figure:
    """Bar chart of a value of each workingstep, as programmed and as advised."""
    before = [advice.before for advice in timed]
    after = [advice.after or advice.before for advice in timed]
    figure = go.Figure([
        go.Bar(
            name=name,
            y=_names(timed),
            x=[value(state) for state in states if state is not None],
            orientation="h",
            marker_color=colour,
        )
        for name, colour, states in (("programmed", GREY, before), ("advised", BLUE, after))
    ])
    return _laid_out(figure, title, unit, len(timed))


def _limits(plan: Plan) -> go.Figure:
    """Heat map of the share of each limit that every advised workingstep uses."""
    advised = [advice for advice in plan.advices if advice.after is not None]
    rows = [_shares(advice) for advice in advised]
    used = [name for name in LimitName if any(name in row for row in rows)]
    cells = [[row.get(name) for name in used] for row in rows]
    figure = go.Figure(
        go.Heatmap(
            x=[name.words for name in used],
            y=_names(advised),
            z=cells,
            text=[["" if cell is None else f"{cell:.0%}" for cell in row] for row in cells],
            texttemplate="%{text}",
            colorscale=USED,
            zmin=0.0,
            zmax=1.0,
            colorbar={"title": "used", "tickformat": ".0%"},
            hovertemplate="%{y}<br>%{x}: %{text}<extra></extra>",
        )
    )
    return _laid_out(figure, "Share of each limit that the advice uses", "", len(advised))


def _fronts(plan: Plan) -> go.Figure:
    """Pareto fronts of machining time against roughness."""
    figure = go.Figure()
    for advice in plan.advices:
        states = [point.state for point in advice.front if point.state.roughness]
        if len(states) > 1:
            figure.add_scatter(
                x=[state.time for state in states],
                y=[um_from_mm(state.roughness or 0.0) for state in states],
                customdata=[kj_from_joules(state.energy) for state in states],
                hovertemplate="%{x:.1f} s, ideal Ra %{y:.2f} µm, %{customdata:.1f} kJ",
                mode="lines+markers",
                name=advice.workingstep.id,
            )
    _laid_out(figure, "Pareto fronts of time and roughness", "s", 10)
    figure.update_xaxes(type="log")
    return figure.update_yaxes(type="log", title=f"Ra µm ({IDEAL})", autorange=True)


def _names(shown: Sequence[Advice]) -> list[str]:
    """Workingstep ids, with the instance number appended where an id repeats."""
    names: list[str] = []
    for advice in shown:
        name = advice.workingstep.id or str(advice.workingstep.ref)
        names.append(f"{name} ({advice.workingstep.ref})" if name in names else name)
    return names


def _power_bound(advice: Advice) -> float | None:
    """Motor power available at the advised spindle speed, in kW."""
    state = advice.after or advice.before
    loads = state.loads if state is not None else ()
    bounds = [load.bound for load in loads if load.limit.name is LimitName.MOTOR_POWER]
    return kw_from_watts(min(bounds)) if bounds else None


def _shares(advice: Advice) -> dict[LimitName, float]:
    """Return the ratio of load to bound, for limits that bound from above."""
    loads = advice.after.loads if advice.after is not None else ()
    return {
        load.limit.name: 1.0 - load.margin
        for load in tightest(loads)
        if load.limit.sense is BoundSide.AT_MOST
    }


def _laid_out(figure: go.Figure, title: str, unit: str, rows: int) -> go.Figure:
    """Apply the common layout; workingsteps run in program order from the top."""
    figure.update_layout(
        title=title,
        height=150 + ROW * max(rows, 3),
        barmode="group",
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        margin={"l": 10, "r": 10, "t": 50, "b": 40},
        legend=LEGEND,
    )
    figure.update_yaxes(autorange="reversed", automargin=True, gridcolor=FAINT)
    return figure.update_xaxes(title=unit or None, automargin=True, gridcolor=FAINT)
