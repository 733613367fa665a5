"""Writing of explicit tool paths whose feed varies along the path (ISO 14649-10).

The operation gets a ``toolpath_list`` of cutter location trajectories. Rapid moves have the
speed name ``RAPID``, moves at one feed a factor on the feedrate of their technology, and others
a ``toolpath_speed``: a B-spline of the factor over the length of the path. An explicit path
that the operation had before is removed. All other bytes of the file stay.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from stepnc_model.editing.draft import Draft
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    BSplineCurveForm,
    KnotType,
    Logical,
    SpeedName,
    ToolpathType,
)
from stepnc_model.entities.geometry import BSplineCurveWithKnots, CartesianPoint
from stepnc_model.entities.operations import (
    CutterLocationTrajectory,
    Feedstop,
    Toolpath,
    ToolpathList,
    ToolpathSpeed,
)
from stepnc_model.part21.values import Real, Ref, Typed
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.explicit.curve_writer import CurveWriter, HelixForm
from stepnc_model.toolpath.explicit.factor_curve import SHORTEST, FactorPart, factor_curve
from stepnc_model.toolpath.explicit.planned_path import PlannedMove, PlannedPath
from stepnc_model.toolpath.path import Dwell, MoveType, Point
from stepnc_model.toolpath.spline import Spline

MOST_MOVES = 1000
"""Greatest number of moves of one trajectory; readers bound the curves of a chain."""

TYPES = {
    MoveType.APPROACH: ToolpathType.APPROACH,
    MoveType.RETRACT: ToolpathType.LIFT,
    MoveType.RAPID: ToolpathType.NON_CONTACT,
    MoveType.NO_CONTACT: ToolpathType.NON_CONTACT,
    MoveType.CONTACT: ToolpathType.CONTACT,
}
"""Type of a trajectory by that of its moves."""

RATIO = "POSITIVE_RATIO_MEASURE"

PATH_KEYWORDS = frozenset({
    *("TOOLPATH_LIST", "TOOLPATH_SPEED", "FEEDSTOP"),
    *("CUTTER_LOCATION_TRAJECTORY", "CUTTER_CONTACT_TRAJECTORY", "AXIS_TRAJECTORY"),
    *("CONNECT_SECPLANE", "CONNECT_DIRECT", "AP_LIFT_PATH_ANGLE", "AP_LIFT_PATH_TANGENT"),
    *("CURVE_WITH_NORMAL_VECTOR", "POLYLINE", "TRIMMED_CURVE", "CIRCLE", "ELLIPSE", "HELIX"),
    *("LINE", "VECTOR", "COMPOSITE_CURVE", "COMPOSITE_CURVE_SEGMENT"),
    *("B_SPLINE_CURVE", "B_SPLINE_CURVE_WITH_KNOTS"),
    *("CARTESIAN_POINT", "DIRECTION", "AXIS2_PLACEMENT_2D", "AXIS2_PLACEMENT_3D"),
})
"""Keywords of the instances that make up an explicit tool path."""


def write_paths(program: Program, paths: Sequence[PlannedPath], profile: FileProfile) -> bytes:
    """Write planned paths into a program; return the bytes of the new file.

    Parameters
    ----------
    program : Program
        Program as it was read.
    paths : sequence of PlannedPath
        At most one for each operation.
    profile : FileProfile
        Profile ``standard`` writes helices as chords, for ISO 10303-42 has none.

    Returns
    -------
    bytes
    """
    draft = Draft(program)
    form = HelixForm.CHORDS if profile is FileProfile.STANDARD else HelixForm.HELIX
    for path in paths:
        old = path.step.operation.its_toolpath
        if old is not None:
            draft.remove(draft.only_under(old, PATH_KEYWORDS))
    for path in paths:
        trajectories = tuple(_PathWriter(draft, path, form).toolpaths())
        added = draft.add(ToolpathList(its_list=trajectories))
        draft.put(path.step.operation_ref, "its_toolpath", added)
    return draft.edits.apply()


@dataclass(frozen=True, slots=True)
class _Kind:
    """Common properties of the moves of one trajectory."""

    type: MoveType
    technology: Ref[Entity] | None
    """Technology of the feed; None for rapid."""
    block: int
    """Number of the trajectory where one would have too many moves."""


class _PathWriter:
    """Writer of one path; keeps the points of its factors."""

    def __init__(self, draft: Draft, path: PlannedPath, form: HelixForm) -> None:
        self._draft, self._path = draft, path
        self._curves = CurveWriter(draft, path.frame, form)
        self._factors: dict[float, Ref[CartesianPoint]] = {}

    def toolpaths(self) -> Iterator[Ref[Toolpath]]:
        """Add the tool paths of the list in order."""
        at = self._path.start
        for is_dwell, steps in groupby(self._path.steps, lambda each: isinstance(each, Dwell)):
            if is_dwell:
                yield from (self._pause(step) for step in steps if isinstance(step, Dwell))
                continue
            moves = [step for step in steps if isinstance(step, PlannedMove)]
            moves = list(_long_enough(at, moves))
            kinds = {index: _kind(move, index) for index, move in enumerate(moves)}
            by_kind: Callable[[int], _Kind] = kinds.__getitem__
            for kind, rows in groupby(kinds, by_kind):
                group = [moves[row] for row in rows]
                yield self._trajectory(kind, at, group)
                at = group[-1].move.end

    def _pause(self, dwell: Dwell) -> Ref[Toolpath]:
        """Add a pause."""
        kind = ToolpathType.TRAJECTORY_PATH
        stop = Feedstop(its_priority=True, its_type=kind, dwell=dwell.seconds or 0.0)
        return self._draft.add(stop)

    def _trajectory(
        self, kind: _Kind, at: Point, moves: Sequence[PlannedMove]
    ) -> Ref[Toolpath]:
        """Add one trajectory."""
        curve = self._curves.curve(at, [each.move for each in moves])
        own = self._path.step.technology_ref
        is_own = kind.technology is None or kind.technology == own
        speed: Ref[ToolpathSpeed] | SpeedName | Typed = SpeedName.RAPID
        if kind.technology is not None:
            speed = self._speed(factor_curve(list(_parts(moves, curve.lengths))))
        trajectory = CutterLocationTrajectory(
            its_priority=True,
            its_type=TYPES[kind.type],
            its_speed=speed,
            its_technology=None if is_own else Ref(int(kind.technology or 0)),
            its_direction=True,
            basiccurve=curve.ref,
        )
        return self._draft.add(trajectory)

    def _speed(self, curve: Spline) -> Ref[ToolpathSpeed] | Typed:
        """Add a curve of factors; a constant factor is a number."""
        factors = [pole[0] for pole in curve.poles]
        if len(set(factors)) == 1:
            return Typed(RATIO, Real(factors[0]))
        inner = curve.knots[1:-1]
        spline = BSplineCurveWithKnots(
            name="",
            degree=curve.degree,
            control_points_list=tuple(self._factor(each) for each in factors),
            curve_form=BSplineCurveForm.POLYLINE_FORM,
            closed_curve=Logical.FALSE,
            self_intersect=Logical.FALSE,
            knot_multiplicities=(2, *(1,) * (len(inner) - 2), 2),
            knots=inner,
            knot_spec=KnotType.UNSPECIFIED,
        )
        return self._draft.add(ToolpathSpeed(speed=self._draft.add(spline)))

    def _factor(self, factor: float) -> Ref[CartesianPoint]:
        """Add a control point, each once."""
        if factor not in self._factors:
            point = CartesianPoint(name="", coordinates=(factor,))
            self._factors[factor] = self._draft.add(point)
        return self._factors[factor]


def _kind(planned: PlannedMove, index: int) -> _Kind:
    move = planned.move
    technology = None if move.feed is None else move.feed.technology
    return _Kind(move.type, technology, index // MOST_MOVES)


def _long_enough(at: Point, moves: Sequence[PlannedMove]) -> Iterator[PlannedMove]:
    """Leave out moves without length, from which no curve can be made."""
    for each in moves:
        if length(at, each.move) >= SHORTEST:
            yield each
            at = each.move.end


def _parts(moves: Sequence[PlannedMove], lengths: Sequence[float]) -> Iterator[FactorPart]:
    """Factors of consecutive moves over the length of their curve."""
    begin = 0.0
    for planned, size in zip(moves, lengths, strict=True):
        for part in planned.parts:
            yield FactorPart(end=begin + part.end * size, factor=part.factor)
        begin += size
