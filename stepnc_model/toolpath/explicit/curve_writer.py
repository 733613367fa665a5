"""Curves of the file from lines, arcs and helices of a tool path.

ISO 10303-42: lines become polylines, arcs trimmed circles, and several of them a composite
curve; :mod:`stepnc_model.toolpath.curve` reads them back. ISO 10303-42 has no helix. It is
written as the ``HELIX`` of NIST's ``ex1E.stp`` or, for readers that know the standard only, as
chords within ``CHORD_TOLERANCE``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import ceil, dist, pi

from stepnc_model.editing.draft import Draft
from stepnc_model.entities.enums import Logical, TransitionCode, TrimmingPreference
from stepnc_model.entities.geometry import (
    Axis2Placement3d,
    BoundedCurve,
    CartesianPoint,
    Circle,
    CompositeCurve,
    CompositeCurveSegment,
    Direction,
    Helix,
    Polyline,
    TrimmedCurve,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.arc import begun_turns, chord_angle, inner_points, length, radius
from stepnc_model.toolpath.curve import CHORD_TOLERANCE
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Arc, Move, Point, minus

LEVEL = 1e-9
"""Greatest rise of an arc that is not a helix, mm."""

SHORTEST_TURN = 1e-6
"""Angle below which an arc is written as a line, rad; readers may take 0 for a full circle."""


class HelixForm(StrEnum):
    """Form in which helices are written."""

    HELIX = "helix"
    """Entity ``HELIX``, exact."""
    CHORDS = "chords"
    """Polyline within ``CHORD_TOLERANCE``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenCurve:
    """Curve in a draft, with the lengths of the moves that it consists of."""

    ref: Ref[BoundedCurve]
    lengths: tuple[float, ...]
    """Length of each move along the curve, mm."""


class CurveWriter:
    """Add curves to a draft; keeps its points and directions, one object per frame.

    Parameters
    ----------
    frame : Frame
        Frame in which the file gives the curves.
    """

    def __init__(self, draft: Draft, frame: Frame, form: HelixForm) -> None:
        self._draft = draft
        self._inverse = frame.inverse()
        self._form = form
        self._points: dict[Point, Ref[CartesianPoint]] = {}
        self._directions: dict[Point, Ref[Direction]] = {}

    def curve(self, start: Point, moves: Sequence[Move]) -> WrittenCurve:
        """Add the curve of consecutive moves.

        Parameters
        ----------
        start : Point
            Start of the first move, in the coordinates of the setup.
        moves : sequence of Move
            At least one move.
        """
        curves: list[Ref[BoundedCurve]] = []
        lengths: list[float] = []
        corners = [start]
        for move in moves:
            at = corners[-1]
            points = self._corners(at, move)
            if points:
                lengths.append(_way(at, points))
                corners += points
                continue
            curves += self._polyline(corners)
            curves += self._bends(at, move)
            lengths.append(length(at, move))
            corners = [move.end]
        curves += self._polyline(corners)
        whole = curves[0] if len(curves) == 1 else self._composite(curves)
        return WrittenCurve(ref=whole, lengths=tuple(lengths))

    def _corners(self, at: Point, move: Move) -> list[Point]:
        """Points of a move that becomes lines; empty for one that stays an arc."""
        arc = move.arc
        if arc is None or abs(arc.turn) < SHORTEST_TURN:
            return [move.end]
        if self._form is HelixForm.HELIX or not _is_helix(at, move):
            return []
        count = max(2, ceil(abs(arc.turn) / chord_angle(radius(at, arc), CHORD_TOLERANCE)))
        return [*inner_points(at, move, count), move.end]

    def _polyline(self, corners: Sequence[Point]) -> list[Ref[BoundedCurve]]:
        """Add a polyline if there are two points."""
        if len(corners) < 2:
            return []
        points = tuple(self._point(corner) for corner in corners)
        return [self._draft.add(Polyline(name="", points=points))]

    def _bends(self, at: Point, move: Move) -> list[Ref[BoundedCurve]]:
        """Add an arc, a helix, or several arcs for more than one turn."""
        arc = move.arc
        if arc is None:
            return []
        if _is_helix(at, move):
            return [self._bend(at, move.end, arc)]
        count = begun_turns(arc.turn)
        ends = [at, *inner_points(at, move, count), move.end]
        part = replace(arc, turn=arc.turn / count)
        return [self._bend(ends[row], ends[row + 1], part) for row in range(count)]

    def _bend(self, start: Point, end: Point, arc: Arc) -> Ref[BoundedCurve]:
        """Add an arc of at most one turn, or a helix, trimmed at its ends."""
        first, second, normal = arc.plane.axes
        centre = [0.0, 0.0, 0.0]
        centre[first], centre[second] = arc.centre[first], arc.centre[second]
        centre[normal] = start[normal]
        origin = centre[0], centre[1], centre[2]
        axis = [0.0, 0.0, 0.0]
        axis[normal] = 1.0
        position = self._draft.add(
            Axis2Placement3d(
                name="",
                location=self._point(origin),
                axis=self._direction((axis[0], axis[1], axis[2])),
                ref_direction=self._direction(minus(start, origin)),
            )
        )
        size, rise = radius(start, arc), end[normal] - start[normal]
        basis: Circle | Helix = Circle(name="", position=position, radius=size)
        if abs(rise) > LEVEL:
            pitch = 2.0 * pi * rise / arc.turn
            basis = Helix(name="", position=position, radius=size, pitch=pitch)
        trimmed = TrimmedCurve(
            name="",
            basis_curve=self._draft.add(basis),
            trim_1=(self._point(start),),
            trim_2=(self._point(end),),
            sense_agreement=arc.turn > 0.0 or isinstance(basis, Helix),
            master_representation=TrimmingPreference.CARTESIAN,
        )
        return self._draft.add(trimmed)

    def _composite(self, curves: Sequence[Ref[BoundedCurve]]) -> Ref[BoundedCurve]:
        """Add a chain of curves."""
        last = len(curves) - 1
        segments = tuple(
            self._draft.add(
                CompositeCurveSegment(
                    transition=TransitionCode.CONTINUOUS
                    if index < last
                    else TransitionCode.DISCONTINUOUS,
                    same_sense=True,
                    parent_curve=curve,
                )
            )
            for index, curve in enumerate(curves)
        )
        chain = CompositeCurve(name="", segments=segments, self_intersect=Logical.UNKNOWN)
        return self._draft.add(chain)

    def _point(self, at: Point) -> Ref[CartesianPoint]:
        """Add a point, each once."""
        if at not in self._points:
            point = CartesianPoint(name="", coordinates=self._inverse.point(at))
            self._points[at] = self._draft.add(point)
        return self._points[at]

    def _direction(self, along: Point) -> Ref[Direction]:
        """Add a direction, each once."""
        if along not in self._directions:
            direction = Direction(name="", direction_ratios=self._inverse.direction(along))
            self._directions[along] = self._draft.add(direction)
        return self._directions[along]


def _is_helix(at: Point, move: Move) -> bool:
    """True if an arc rises along the normal of its plane."""
    if move.arc is None:
        return False
    normal = move.arc.plane.axes[2]
    return abs(move.end[normal] - at[normal]) > LEVEL


def _way(start: Point, points: Sequence[Point]) -> float:
    """Length from a point along several others, mm."""
    return sum(dist(a, b) for a, b in zip((start, *points[:-1]), points, strict=True))
