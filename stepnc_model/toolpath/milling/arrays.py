"""Many edges at once: their crossings, and distances of points from them, by numpy."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from numpy.typing import NDArray

from stepnc_model.toolpath.milling.contour import Edge, Floats, Points

ON = 1e-9
"""relative slack of a crossing at the very end of an edge"""


@dataclass(frozen=True, slots=True)
class Edges:
    """Edges as columns, each (N,)."""

    start: Points
    end: Points
    centre: Points
    """of lines: 0"""
    radius: Floats
    """mm, of lines: 0"""
    turn: Floats
    """rad, of lines: 0"""

    @classmethod
    def of(cls, edges: Sequence[Edge]) -> "Edges":
        """Columns of a list of edges."""
        start = np.array([edge.start for edge in edges], dtype=complex)
        centre = np.array(
            [0j if edge.centre is None else edge.centre for edge in edges], dtype=complex
        )
        turn = np.array([edge.turn for edge in edges], dtype=float)
        return cls(
            start=start,
            end=np.array([edge.end for edge in edges], dtype=complex),
            centre=centre,
            radius=np.where(turn == 0.0, 0.0, np.abs(start - centre)),
            turn=turn,
        )

    def pick(self, index: NDArray[np.intp]) -> "Edges":
        """Some of the edges, by their indices."""
        return Edges(
            self.start[index],
            self.end[index],
            self.centre[index],
            self.radius[index],
            self.turn[index],
        )

    def boxes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Least x, least y, greatest x, greatest y; arcs by a box that surely holds them."""
        middle = self.start + 0.5 * (self.end - self.start)
        arc = self.turn != 0.0
        spoke = np.where(arc, self.start - self.centre, 0.0)
        middle = np.where(arc, self.centre + spoke * np.exp(0.5j * self.turn), middle)
        # The sagitta bounds how far an arc of half a turn bulges beyond its three points.
        bulge = np.abs(middle - 0.5 * (self.start + self.end))
        xs = np.stack([self.start.real, self.end.real, middle.real])
        ys = np.stack([self.start.imag, self.end.imag, middle.imag])
        return (
            xs.min(0) - bulge,
            ys.min(0) - bulge,
            xs.max(0) + bulge,
            ys.max(0) + bulge,
        )


def distances(points: Points, edges: Edges) -> Floats:
    """Distance of each point from the nearest of the edges, mm, (M,)."""
    found = np.full(len(points), np.inf)
    is_line = edges.turn == 0.0
    lines, arcs = edges.pick(np.flatnonzero(is_line)), edges.pick(np.flatnonzero(~is_line))
    if len(lines.start):
        way = lines.end - lines.start
        part = ((points[:, None] - lines.start) / way).real
        foot = lines.start + np.clip(part, 0.0, 1.0) * way
        found = np.minimum(found, np.abs(points[:, None] - foot).min(1))
    if len(arcs.start):
        spoke = (points[:, None] - arcs.centre) / (arcs.start - arcs.centre)
        part = _part(spoke, arcs.turn)
        beside = np.abs(np.abs(spoke) - 1.0) * arcs.radius
        ends = np.minimum(
            np.abs(points[:, None] - arcs.start), np.abs(points[:, None] - arcs.end)
        )
        found = np.minimum(found, np.where(part <= 1.0, beside, ends).min(1))
    return found


def crossings(edges: Sequence[Edge]) -> list[list[float]]:
    """For each edge the parts of its length where another one crosses or touches it."""
    return _found(len(edges), *_pairs(Edges.of(edges), None))


def crossings_with(edges: Sequence[Edge], others: Sequence[Edge]) -> list[list[float]]:
    """For each edge the parts of its length where one of the others crosses or touches it."""
    return _found(len(edges), *_pairs(Edges.of(edges), Edges.of(others)))


def _found(count: int, index: NDArray[np.intp], parts: Floats) -> list[list[float]]:
    """Parts sorted by edge, each edge's in order."""
    order = np.lexsort((parts, index))
    bounds = np.searchsorted(index[order], np.arange(count + 1))
    values = parts[order].tolist()
    return [values[a:b] for a, b in pairwise(bounds)]


def _pairs(edges: Edges, others: Edges | None) -> tuple[NDArray[np.intp], Floats]:
    """Edge index and part of every crossing; both of a pair where there are no others."""
    second = edges if others is None else others
    ax0, ay0, ax1, ay1 = edges.boxes()
    bx0, by0, bx1, by1 = second.boxes()
    near = (
        (ax0[:, None] <= bx1 + ON)
        & (bx0 <= ax1[:, None] + ON)
        & (ay0[:, None] <= by1 + ON)
        & (by0 <= ay1[:, None] + ON)
    )
    if others is None:
        near = np.triu(near, 1)
    i, j = np.nonzero(near)
    a, b = edges.pick(i), second.pick(j)
    hits = _meet(a, b)
    owners, parts = [], []
    for where in hits:
        pa, pb = _part_of(a, where), _part_of(b, where)
        good = np.isfinite(pa) & np.isfinite(pb)
        owners.append(i[good])
        parts.append(pa[good])
        if others is None:
            owners.append(j[good])
            parts.append(pb[good])
    return np.concatenate(owners), np.concatenate(parts)


def _meet(a: Edges, b: Edges) -> tuple[Points, Points]:
    """Two points (or NaN) where the lines or circles of pairs of edges meet."""
    first = np.full(len(a.start), np.nan + 0j)
    second = first.copy()
    a_line, b_line = a.turn == 0.0, b.turn == 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        pick = np.flatnonzero(a_line & b_line)
        first[pick] = _line_line(a.pick(pick), b.pick(pick))
        for lines, arcs, chosen in ((a, b, a_line & ~b_line), (b, a, ~a_line & b_line)):
            pick = np.flatnonzero(chosen)
            first[pick], second[pick] = _line_circle(lines.pick(pick), arcs.pick(pick))
        pick = np.flatnonzero(~a_line & ~b_line)
        first[pick], second[pick] = _circle_circle(a.pick(pick), b.pick(pick))
    return first, second


def _line_line(a: Edges, b: Edges) -> Points:
    """Crossing of two lines; NaN for parallel ones."""
    u, v = a.end - a.start, b.end - b.start
    cross = (u.conj() * v).imag
    flat = np.abs(cross) <= 1e-12 * np.abs(u) * np.abs(v)
    part = ((b.start - a.start).conj() * v).imag / np.where(flat, np.nan, cross)
    return a.start + part * u


def _line_circle(lines: Edges, arcs: Edges) -> tuple[Points, Points]:
    """Crossings of a line and a circle; a near miss of a tangent counts as a touch."""
    way = (lines.end - lines.start) / np.abs(lines.end - lines.start)
    from_centre = (lines.start - arcs.centre) / way
    half = _half_chord(arcs.radius, from_centre.imag)
    foot = lines.start - from_centre.real * way
    return foot + half * way, foot - half * way


def _circle_circle(a: Edges, b: Edges) -> tuple[Points, Points]:
    """Crossings of two circles; NaN for concentric ones."""
    between = b.centre - a.centre
    gap = np.abs(between)
    gap = np.where(gap < 1e-9, np.nan, gap)
    along = (gap**2 + a.radius**2 - b.radius**2) / (2.0 * gap)
    half = _half_chord(a.radius, along)
    way = between / gap
    return a.centre + (along + 1j * half) * way, a.centre + (along - 1j * half) * way


def _half_chord(radius: Floats, distance: Floats) -> Floats:
    """Half of the chord of a circle at a distance from its centre."""
    square = radius**2 - distance**2
    touch = np.abs(square) <= 1e-9 * np.maximum(radius, 1e-3)
    chord: Floats = np.where(touch, 0.0, np.sqrt(np.where(square < 0.0, np.nan, square)))
    return chord


def _part_of(edges: Edges, where: Points) -> Floats:
    """Part of each edge's length at a point on its line or circle; NaN beyond its ends."""
    with np.errstate(divide="ignore", invalid="ignore"):
        on_line = ((where - edges.start) / (edges.end - edges.start)).real
        spoke = (where - edges.centre) / (edges.start - edges.centre)
        part = np.where(edges.turn == 0.0, on_line, _part(spoke, edges.turn))
        length = np.where(
            edges.turn == 0.0,
            np.abs(edges.end - edges.start),
            edges.radius * np.abs(edges.turn),
        )
        slack = 1e-7 / np.maximum(length, 1e-7)
        # Just before the start an arc's part is almost a whole turn.
        whole = np.where(edges.turn == 0.0, np.inf, 2.0 * pi / np.abs(edges.turn))
        part = np.where(part > whole - slack, 0.0, part)
    inside = (part >= -slack) & (part <= 1.0 + slack)
    return np.where(inside, np.clip(part, 0.0, 1.0), np.nan)


def _part(spoke: Points, turn: Floats) -> Floats:
    """Part of an arc's turn at a spoke relative to its start; above 1 beyond the arc."""
    sign = np.where(turn < 0.0, -1.0, 1.0)
    size = np.where(turn == 0.0, 1.0, np.abs(turn))
    angle: Floats = (np.angle(spoke) * sign) % (2.0 * pi) / size
    return angle
