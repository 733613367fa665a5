"""Plotly figures of a verification: the part in plan and in space, coloured by deviation."""

import numpy as np
import plotly.graph_objects as go

from extras.verification.facts import shown_rows
from extras.verification.model.deviation import SurfacePlaces
from extras.verification.run import Verification
from simulator.motion.segments import Floats, Ints

MOST_POINTS = 12_000
"""Most points in space; the greatest deviations are always among them."""

MOST_IN_PLAN = 5_000
"""Most points in the plan, each of which is an element of the page: the policy of served
reports forbids the faster drawing by WebGL, which compiles functions from text."""

ANGLES = 40
"""Angles around the axis at which a turned profile is shown in space."""

PIXELS = 300
"""Pixels of the plan along its longer side; each shows the greatest deviation in it."""

SCALE = ((0.0, "#b2182b"), (0.5, "#cfcfcf"), (1.0, "#2166ac"))
"""Colours from red (gouge) over grey to blue (excess)."""

ROOM = 2.0
"""End of the colour scale, as a multiple of the tolerance, if no deviation is greater."""


def plan_figure(verification: Verification) -> go.Figure:
    """Figure of the surface seen along the tool, or of the profile of a turned part."""
    places, limit = verification.places, _limit(verification)
    figure = go.Figure()
    if verification.is_turned:
        rows = _chosen(places, MOST_IN_PLAN)
        figure.add_trace(_points(verification, rows, limit, across=2, up=0))
        figure.update_layout(xaxis_title="z, mm", yaxis_title="radius, mm")
    else:
        figure.add_trace(_floors(places[~places.is_wall], limit))
        walls = places[places.is_wall]
        rows = _chosen(walls, MOST_IN_PLAN)
        figure.add_trace(_points(verification, rows, limit, across=0, up=1, places=walls))
        figure.update_layout(xaxis_title="x, mm", yaxis_title="y, mm")
    figure.update_yaxes(scaleanchor="x")
    figure.update_layout(height=560, template="plotly_white", showlegend=False)
    return figure


def space_figure(verification: Verification) -> go.Figure:
    """Figure of the surface in space; a turned profile goes around its axis."""
    places, limit = verification.places, _limit(verification)
    if verification.is_turned:
        shown = places[_chosen(places, MOST_POINTS // ANGLES)]
        position, deviation = _turned_around(shown)
    else:
        shown = places[_chosen(places, MOST_POINTS)]
        position, deviation = shown.position, shown.deviation
    x, y, z = position.T
    trace = go.Scatter3d(
        x=x, y=y, z=z, mode="markers", marker=_marker(deviation, limit, 2.0),
        hovertemplate="%{x:.2f}, %{y:.2f}, %{z:.2f} mm: %{marker.color:.4f} mm<extra></extra>",
    )  # fmt: skip
    figure = go.Figure(trace)
    # One scale for all axes; the longest has length 1, so that a long shaft is seen whole.
    across, along, up = (np.ptp(position, axis=0) / np.ptp(position, axis=0).max()).tolist()
    figure.update_layout(
        height=560, template="plotly_white", scene_aspectmode="manual",
        scene_aspectratio={"x": across, "y": along, "z": up},
    )  # fmt: skip
    return figure


def _turned_around(places: SurfacePlaces) -> tuple[Floats, Floats]:
    """Positions of a turned profile at angles around the axis, (N, 3), and their deviations."""
    angle = np.linspace(0.0, 2.0 * np.pi, ANGLES, endpoint=False)[:, None]
    radius, _, z = places.position.T
    position = np.stack(
        (radius * np.cos(angle), radius * np.sin(angle), z + 0.0 * angle), axis=2
    )
    return position.reshape(-1, 3), np.tile(places.deviation, ANGLES)


def _limit(verification: Verification) -> float:
    """End of the colour scale, mm."""
    size = np.abs(verification.places.deviation[verification.places.is_beyond])
    return float(max(size.max(initial=0.0), ROOM * verification.tolerance))


def _chosen(places: SurfacePlaces, most: int) -> Ints:
    """Rows of places to show: the greatest deviations, and others evenly spread."""
    return shown_rows(places.position, places.least, most=most)


def _marker(deviation: Floats, limit: float, size: float) -> dict[str, object]:
    return {
        "color": deviation, "colorscale": SCALE, "cmin": -limit, "cmax": limit,
        "size": size, "colorbar": {"title": "deviation, mm"},
    }  # fmt: skip


def _points(
    verification: Verification,
    rows: Ints,
    limit: float,
    *,
    across: int,
    up: int,
    places: SurfacePlaces | None = None,
) -> go.Scatter:
    """Points in a plane, with the workingstep and block of each."""
    shown = (verification.places if places is None else places)[rows]
    names = [step.workingstep for step in verification.steps] + ["raw part"]
    texts = [
        f"{names[step]}, block {block}, ± {uncertainty:.4f} mm"
        for step, block, uncertainty in zip(
            shown.workingstep.tolist(), shown.block.tolist(), shown.uncertainty.tolist(),
            strict=True,
        )
    ]  # fmt: skip
    return go.Scatter(
        x=shown.position[:, across], y=shown.position[:, up], mode="markers", text=texts,
        marker=_marker(shown.deviation, limit, 4.0),
        hovertemplate="%{x:.2f}, %{y:.2f}: %{marker.color:.4f} mm<br>%{text}<extra></extra>",
    )  # fmt: skip


def _floors(places: SurfacePlaces, limit: float) -> go.Heatmap:
    """Greatest deviation of the floors in each pixel."""
    x, y = places.position[:, 0], places.position[:, 1]
    size = max(float(np.ptp(x)), float(np.ptp(y)), 1e-9) / PIXELS
    columns = np.floor((x - x.min()) / size).astype(np.int64)
    rows = np.floor((y - y.min()) / size).astype(np.int64)
    picture = np.full((int(rows.max()) + 1, int(columns.max()) + 1), np.nan)
    order = np.argsort(np.abs(places.deviation))
    picture[rows[order], columns[order]] = places.deviation[order]
    return go.Heatmap(
        z=picture, x0=x.min() + 0.5 * size, dx=size, y0=y.min() + 0.5 * size, dy=size,
        colorscale=SCALE, zmin=-limit, zmax=limit, showscale=False, hoverongaps=False,
        hovertemplate="%{x:.2f}, %{y:.2f}: %{z:.4f} mm<extra>floor</extra>",
    )  # fmt: skip
