"""Stock and parts that a mesh of triangles describes, such as a casting.

On a mill a raw part is what can be seen from above: undercuts count as full, down to the lowest
triangle. On a lathe it must be a closed body of revolution about Z: corners of the triangles
are taken to lie on the surface, between them a facet lies below it by its sag, and the profile
is that of the greatest radius over each cell of the bar. Units mm, rad.
"""

from dataclasses import dataclass
from math import ceil, floor, hypot
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import entry
from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import HeightGrid, cell_size, zmap_of
from stepnc_model.programs.program import Stock
from stepnc_model.units import rad_from_deg

CELL = 0.01
"""Length of a cell along the axis, mm."""

ROUND = 0.01
"""Greatest variation of a radius around the axis, beside the sag of facets, mm."""

ACROSS = 1e-6
"""Share of a normal along the radius below which a triangle is a face across the axis."""

FLAT = 1e-9
"""Area in plan, mm², below which a triangle is upright."""

EDGE = 1e-9
"""Share by which a place may lie beside a triangle that counts as over it."""

SAME = 5
"""Decimals of a millimetre to which corners are the same."""

CURVED = rad_from_deg(30.0)
"""Greatest angle between neighbours that stand for a curved surface, rad."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshEdges:
    """Edges that T triangles share."""

    open: int
    """Edges that do not belong to exactly two triangles."""
    unlike: int
    """Edges that both of their triangles follow in the same direction."""
    bend: Floats
    """Greatest angle to a neighbour with which a triangle forms a curved surface, (T,), rad."""


def edges_of(triangles: Floats) -> MeshEdges:
    """Find out how triangles, (T, 3, 3) in mm, meet."""
    corners = np.unique(triangles.reshape(-1, 3).round(SAME), axis=0, return_inverse=True)[1]
    corner = corners.reshape(-1, 3)
    ends = corner[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    # A triangle without area is none: its edges belong to its neighbours.
    is_whole = ends[:, 0] != ends[:, 1]
    owner = np.repeat(np.arange(len(triangles)), 3)[is_whole]
    ends = ends[is_whole]
    low, high = ends.min(axis=1), ends.max(axis=1)
    order = np.lexsort((high, low))
    low, high, owner = low[order], high[order], owner[order]
    is_rising = (ends[:, 0] < ends[:, 1])[order]
    is_new = np.append(True, (np.diff(low) != 0) | (np.diff(high) != 0))
    first = np.flatnonzero(is_new)
    counts = np.diff(np.append(first, len(low)))
    pairs = first[counts == 2]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.linalg.norm(normal, axis=1)
    normal /= np.where(size > 0.0, size, 1.0)[:, None]
    one, other = owner[pairs], owner[pairs + 1]
    angle = np.arccos(np.clip(np.abs(np.sum(normal[one] * normal[other], axis=1)), 0.0, 1.0))
    angle[angle > CURVED] = 0.0
    bend = np.zeros(len(triangles))
    np.maximum.at(bend, one, angle)
    np.maximum.at(bend, other, angle)
    return MeshEdges(
        open=int((counts != 2).sum()),
        unlike=int((is_rising[pairs] == is_rising[pairs + 1]).sum()),
        bend=bend,
    )


def bounds_of(triangles: Floats) -> Stock:
    """Box around triangles, (T, 3, 3), mm."""
    corners = triangles.reshape(-1, 3)
    low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Stock(low=tuple(low), high=tuple(high))


@entry
def raise_to(grid: HeightGrid, triangles: Floats) -> None:
    """Raise the heights of a grid to the highest triangle over the middle of each cell.

    Parameters
    ----------
    grid : HeightGrid
        Its heights are changed in place.
    triangles : (T, 3, 3) array, mm
    """
    columns, rows = grid.heights.shape
    for index in range(len(triangles)):
        a, b, c = triangles[index, 0], triangles[index, 1], triangles[index, 2]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < FLAT:
            continue
        low = ceil((min(a[0], b[0], c[0]) - grid.x) / grid.dx - 0.5 - 1e-6)
        high = floor((max(a[0], b[0], c[0]) - grid.x) / grid.dx - 0.5 + 1e-6)
        begin = ceil((min(a[1], b[1], c[1]) - grid.y) / grid.dy - 0.5 - 1e-6)
        end = floor((max(a[1], b[1], c[1]) - grid.y) / grid.dy - 0.5 + 1e-6)
        for column in range(max(low, 0), min(high, columns - 1) + 1):
            x = grid.x + (column + 0.5) * grid.dx - a[0]
            for row in range(max(begin, 0), min(end, rows - 1) + 1):
                y = grid.y + (row + 0.5) * grid.dy - a[1]
                one = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area
                two = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area
                if one >= -EDGE and two >= -EDGE and one + two <= 1.0 + EDGE:
                    height = a[2] + one * (b[2] - a[2]) + two * (c[2] - a[2])
                    grid.heights[column, row] = max(grid.heights[column, row], height)


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
    stock : Stock
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
