"""Required part of a lathe: the profile of triangles that form a body of revolution about Z.

Corners of the triangles are taken to lie on the surface; between them a facet lies below it by
its sag. The profile is that of the greatest radius over each cell of the bar. Units mm, rad.

Raw part that a mesh of triangles describes, such as a casting or what another setup left.

On a mill it is what can be seen from above: undercuts count as full, down to the lowest
triangle. On a lathe it must be a closed body of revolution about Z. Units mm.
"""

from dataclasses import dataclass
from math import ceil, floor, hypot
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import entry
from simulator.motion.segments import Bools, Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import cell_size, zmap_of
from simulator.verification.deviation import SurfacePlaces
from simulator.verification.logged_bar import LoggedBar, profile_distance
from simulator.verification.mesh import edges_of, raise_to
from simulator.verification.turned import CELL, compared_profiles, has_bore
from stepnc_model.program import Stock

ROUND = 0.01
"""Greatest variation of a radius around the axis, beside the sag of facets, mm."""

ACROSS = 1e-6
"""Share of a normal along the radius below which a triangle is a face across the axis."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RequiredBar:
    """Bar that a mesh of triangles describes, within a stock."""

    bar: TurningStock
    low: float
    """Z of the end of the mesh at the chuck, mm: what lies behind is not compared."""
    sag: float
    """Greatest sag of its facets, mm."""


def required_bar(triangles: Floats, stock: Stock, *, cell: float | None = None) -> RequiredBar:
    """Profile of triangles about Z.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
        Closed, all seen counter-clockwise from outside, or all clockwise.
    cell : float, mm
        Length of a cell along the axis.

    Raises
    ------
    ValueError
        If the mesh is not closed or no body of revolution, or the stock has no radius.
    """
    edges = edges_of(triangles)
    if edges.open or edges.unlike:
        raise ValueError(
            f"{edges.open} edges do not belong to two triangles, and {edges.unlike} triangles "
            "face the other way than their neighbours: a turned part needs a closed mesh"
        )
    bar = TurningStock(stock, CELL if cell is None else cell)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inside_out = np.sign(np.einsum("ij,ij->i", triangles[:, 0], normal).sum())
    middle = triangles.mean(axis=1)
    radial = inside_out * np.sum(normal[:, :2] * middle[:, :2], axis=1)
    radial /= np.linalg.norm(normal, axis=1) * np.hypot(*middle[:, :2].T) + 1e-30
    sag = _sags(triangles)
    outside = _spans(triangles[radial > ACROSS], sag[radial > ACROSS], bar)
    bore = _spans(triangles[radial < -ACROSS], sag[radial < -ACROSS], bar)
    _require_round(outside, "outer radius", bar)
    _require_round(bore, "radius of the bore", bar)
    bar.outer[:] = np.minimum(outside.high, bar.outer)
    bar.inner[:] = np.minimum(bore.high, bar.outer)
    return RequiredBar(
        bar=bar,
        low=float(triangles[:, :, 2].min()),
        sag=float(max(outside.sag.max(initial=0.0), bore.sag.max(initial=0.0))),
    )


class RadiusSpans(NamedTuple):
    """Radii of the edges of triangles over each of C cells."""

    low: Floats
    """Least, (C,), mm; infinite without any."""
    high: Floats
    """Greatest, (C,), mm; 0 without any."""
    sag: Floats
    """Greatest sag of facets, (C,), mm."""


def _spans(triangles: Floats, sag: Floats, bar: TurningStock) -> RadiusSpans:
    """Radii of the edges of triangles over the cells of a bar."""
    count = len(bar.outer)
    spans = RadiusSpans(low=np.full(count, np.inf), high=np.zeros(count), sag=np.zeros(count))
    edges = np.ascontiguousarray(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2, 3))
    _widen(edges, np.repeat(sag, 3), float(bar.z[0]), bar.cell, spans)
    return spans


@entry
def _widen(edges: Floats, sags: Floats, start: float, cell: float, spans: RadiusSpans) -> None:
    """Widen spans of radii by edges, (E, 2, 3), each over the cells that it passes."""
    for index in range(len(edges)):
        one, other = edges[index, 0], edges[index, 1]
        height = other[2] - one[2]
        if height == 0.0:
            continue
        first = ceil((min(one[2], other[2]) - start) / cell)
        last = floor((max(one[2], other[2]) - start) / cell)
        for each in range(max(first, 0), min(last, len(spans.low) - 1) + 1):
            share = (start + each * cell - one[2]) / height
            radius = hypot(
                one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])
            )
            spans.low[each] = min(spans.low[each], radius)
            spans.high[each] = max(spans.high[each], radius)
            spans.sag[each] = max(spans.sag[each], sags[index])


def _sags(triangles: Floats) -> Floats:
    """Sag of each triangle below the circle through its corners, (T,), mm."""
    angle = np.arctan2(triangles[:, :, 1], triangles[:, :, 0])
    away = (angle - angle[:, :1] + np.pi) % (2.0 * np.pi) - np.pi
    radius = np.hypot(triangles[:, :, 0], triangles[:, :, 1]).max(axis=1)
    return np.asarray(radius * (1.0 - np.cos(0.5 * np.ptp(away, axis=1))))


def _require_round(spans: RadiusSpans, what: str, bar: TurningStock) -> None:
    """Refuse radii that vary around the axis by more than facets do."""
    is_there = np.isfinite(spans.low)
    varies = np.where(is_there, spans.high - spans.low - spans.sag, 0.0)
    worst = int(varies.argmax())
    if varies[worst] > ROUND:
        raise ValueError(
            f"no body of revolution about Z: at z = {bar.z[worst]:.2f} mm the {what} goes from "
            f"{spans.low[worst]:.4g} to {spans.high[worst]:.4g} mm, and facets explain "
            f"{spans.sag[worst]:.2g} mm of this: {varies[worst]:.3g} mm are more than "
            f"{ROUND:g} mm"
        )


def required_turned_places(part: RequiredBar, logged: LoggedBar) -> SurfacePlaces:
    """Compare the logged profiles of outside and bore with the required ones."""
    sides = [_side(part, logged, is_bore=False)]
    if has_bore(part.bar, logged):
        sides.append(_side(part, logged, is_bore=True))
    places = SurfacePlaces.joined(sides)
    return places[places.position[:, 2] > part.low + part.bar.cell]


def _side(part: RequiredBar, logged: LoggedBar, *, is_bore: bool) -> SurfacePlaces:
    found = compared_profiles(part.bar, logged, is_bore=is_bore)
    points, nearest = found.points, found.nearest
    by = nearest.workingstep
    return SurfacePlaces(
        is_wall=points.is_face,
        position=found.position,
        deviation=found.deviation,
        uncertainty=np.minimum(nearest.bend, found.reached) + found.uncertainty,
        certain=found.gouge,
        area=points.area,
        workingstep=by,
        block=np.zeros(len(by), dtype=np.int64),
        time=nearest.time,
        cut_by=by,
    )


def profile_deviation(places: SurfacePlaces, is_bore: Bools, part: RequiredBar) -> Floats:
    """Deviation of programmed places from a required profile, (N,), mm.

    Parameters
    ----------
    is_bore : (N,) array of bool
        Whether a place lies in the bore.

    Returns
    -------
    (N,) array, mm
        Excess positive; NaN behind the required part.
    """
    found = np.full(len(places), np.nan)
    bar = part.bar
    for profile, rows, sign in (
        (bar.outer, ~is_bore, 1.0),
        (bar.inner, is_bore, -1.0),
    ):
        at = places.position[rows][:, [0, 2]]
        if not len(at):
            continue
        away = profile_distance(at, np.column_stack([profile, bar.z]), bar.cell)
        beyond = np.sign(at[:, 0] - np.interp(at[:, 1], bar.z, profile))
        found[rows] = sign * beyond * away
    found[places.position[:, 2] <= part.low + bar.cell] = np.nan
    return found


def bounds_of(triangles: Floats) -> Stock:
    """Box around triangles, (T, 3, 3), mm."""
    corners = triangles.reshape(-1, 3)
    low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Stock(low=tuple(low), high=tuple(high))


def milling_stock_of(triangles: Floats, *, cell: float | None = None) -> MillingStock:
    """Stock of a mill from triangles.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
    cell : float, mm
        Size of the map's cells; by default chosen from the size of the part.
    """
    bounds = bounds_of(triangles)
    size = cell_size(bounds) if cell is None else cell
    raised = zmap_of(bounds, cell=size)
    raised.grid.heights[:] = raised.grid.bottom
    raise_to(raised.grid, np.ascontiguousarray(triangles, dtype=np.float64))
    return MillingStock(raised)


def turning_stock_of(triangles: Floats) -> TurningStock:
    """Stock of a lathe from triangles.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm

    Raises
    ------
    ValueError
        If the mesh is not a closed body of revolution about Z.
    """
    corners = triangles.reshape(-1, 3)
    radius = float(np.hypot(corners[:, 0], corners[:, 1]).max())
    low, high = float(corners[:, 2].min()), float(corners[:, 2].max())
    bar = Stock(low=(-radius, -radius, low), high=(radius, radius, high), radius=radius)
    return required_bar(triangles, bar).bar
