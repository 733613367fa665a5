"""Grooving and cutting in: plunges side by side, then passes along the walls and the floor.

Plunges start in the middle, or at the side where the grooving direction starts, and their
step leaves no strip uncut. A finish runs down each wall and along the floor towards the other
wall, so that the insert is never pulled backwards across its width.

The programmed point is the insert's left corner, at the chuck side, as a sharp corner; paths
are computed for the centre of that corner's radius. A position of the insert is allowed if both
corners and everything between them are clear of the part.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, inf

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.turning import (
    CuttingIn,
    Groove,
    Grooving,
    GroovingFinish,
    GroovingStrategy,
    MultistepGroovingStrategy,
)
from stepnc_model.entities.turning_tools import GroovingTool
from stepnc_model.part21.values import Typed
from stepnc_model.toolpath.path import Move, MoveType
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask
from stepnc_model.toolpath.turning.offset import grown
from stepnc_model.toolpath.turning.outline import FeatureOutline
from stepnc_model.toolpath.turning.path_builder import RAPID_CLEARANCE, split
from stepnc_model.toolpath.turning.profile import (
    HalfPlane,
    ProfilePiece,
    RadiusProfile,
    Spot,
    crossings,
    highest,
    level_line,
)
from stepnc_model.toolpath.turning.region import SEEN, TurningBlank, surface_of
from stepnc_model.toolpath.turning.setting import (
    allowance_of,
    cumulative,
    cutting_feed,
    depths_of,
    direction_in,
    strategy_fault,
    strategy_of,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class GroovingInsert:
    """Dimensions of a grooving insert, mm."""

    width: float
    corner: float
    """Radius of the insert's corners, mm."""
    reach: float
    """Greatest grooving depth of the insert, mm."""

    @property
    def flat(self) -> float:
        """Distance between the centres of the two corner radii, mm."""
        return self.width - 2.0 * self.corner

    def rolled(self, profile: RadiusProfile, allowance: float = 0.0) -> RadiusProfile:
        """Path of the centre of the left corner when the insert touches a profile."""
        return highest(self._spread(grown(profile, self.corner + allowance)))

    def _spread(self, centres: RadiusProfile) -> list[ProfilePiece]:
        """Offset the profile for both corners and bridge equal heights with level lines."""
        pieces = [*centres.pieces, *(_shifted(p, -self.flat) for p in centres.pieces)]
        for piece in centres.pieces:
            spots = [piece.start, piece.end]
            if piece.centre and piece.side > 0 and piece.low < piece.centre[0] < piece.high:
                spots.append((piece.centre[0], piece.centre[1] + piece.radius))
            pieces += [level_line(v, u - self.flat, u) for u, v in spots]
        return pieces


def insert_of(job: ToolPathTask) -> GroovingInsert:
    """Grooving insert of the operation's tool.

    Raises
    ------
    PathError
        If the tool is not a grooving tool or has no valid width.
    """
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, GroovingTool):
        raise job.fault("is not a grooving tool", job.step.tool_ref)
    width = tool.cutting_width
    if width is None or not 0.0 < width < 1e3:
        raise job.fault(
            f"an insert width of {width} mm is not valid", job.step.tool_ref, "cutting_width"
        )
    corner = tool.corner_radius
    corner = job.tool.corner_radius or 0.0 if corner is None else corner
    if not 0.0 <= 2.0 * corner <= width:
        message = f"corner radius {corner:g} mm is too large for the width {width:g} mm"
        raise job.fault(message, job.step.tool_ref, "corner_radius")
    reach = tool.maximum_grooving_depth
    return GroovingInsert(width=float(width), corner=float(corner), reach=float(reach or 1e6))


def _shifted(piece: ProfilePiece, by: float) -> ProfilePiece:
    return ProfilePiece(
        start=(piece.start[0] + by, piece.start[1]),
        end=(piece.end[0] + by, piece.end[1]),
        centre=(piece.centre[0] + by, piece.centre[1]) if piece.centre else None,
        side=piece.side,
        radius=piece.radius,
    )


FITS = 1e-6
"""Tolerance by which an insert may be wider than its groove, mm."""

OVERLAP = 0.8
"""Greatest default step between plunges, as a fraction of the insert's flat."""


class Plunger:
    """Builder of plunge moves; it tracks the material that the insert has cut."""

    def __init__(
        self, job: ToolPathTask, course: PathBuilder, bar: TurningBlank, insert: GroovingInsert
    ) -> None:
        self.job = job
        self.course = course
        self.insert = insert
        self.feed = cutting_feed(job)
        self.plane = HalfPlane(tip_x=-insert.corner, tip_z=-insert.corner)
        self.rim = insert.rolled(bar.left)
        """Profile of the left corner's centre where the insert touches the stock."""
        self.home = course.at

    def over(self, u: float) -> None:
        """Move the insert in rapid to a position u above the groove."""
        kind = MoveType.RAPID if self.course.count else MoveType.APPROACH
        at, v = self.plane.spot(self.course.at)
        level = max(v, self._clear(min(at, u), max(at, u)))
        for spot in ((at, level), (u, level), (u, self._clear(u, u))):
            self.course.rapid(self.plane.point(spot), kind)

    def down(self, pieces: Sequence[ProfilePiece]) -> None:
        """Feed along pieces, classified as contact or air."""
        for piece in pieces:
            for part, is_contact in split(piece, self.rim):
                kind = MoveType.CONTACT if is_contact else MoveType.NO_CONTACT
                end, arc = self.plane.point(part.end), self.plane.arc(part)
                self.course.add(Move(end=end, type=kind, feed=self.feed, arc=arc))

    def up(self, u: float) -> None:
        """Feed out of the groove at position u; its walls are too close for a rapid."""
        self._feed((u, self._clear(u, u)))

    def go_home(self) -> None:
        """Return to the safe point in rapid."""
        self.course.rapid((self.home[0], 0.0, self.course.at[2]), MoveType.RETRACT)
        self.course.rapid(self.home, MoveType.RETRACT)

    def peck(self, u: float, depths: Sequence[float], back: float) -> None:
        """Plunge in steps, each followed by a short retract."""
        top = self.rim.at(u)
        start = self._clear(u, u)
        for index, depth in enumerate(depths):
            self.down([ProfilePiece(start=(u, start), end=(u, top - depth))])
            start = top - depth
            if back > 0.0 and index + 1 < len(depths):
                start = min(start + back, top)
                self._feed((u, start))

    def start_of(self, u: float) -> Spot:
        """Start point of a plunge at position u."""
        return u, self._clear(u, u)

    def _clear(self, low: float, high: float) -> float:
        """Level at which the insert is clear of the stock over an interval of u, mm."""
        beside = self.rim.top(low - RAPID_CLEARANCE, high + RAPID_CLEARANCE)
        return max(beside, 0.0) + RAPID_CLEARANCE

    def _feed(self, spot: Spot) -> None:
        end = self.plane.point(spot)
        self.course.add(Move(end=end, type=MoveType.NO_CONTACT, feed=self.feed))


def groove(
    job: ToolPathTask,
    course: PathBuilder,
    bar: TurningBlank,
    outlines: tuple[FeatureOutline, ...],
) -> None:
    """Generate the path of a grooving or cutting-in operation.

    Raises
    ------
    PathError
        If the insert is too wide or too short, or there is nothing to remove.
    """
    insert = insert_of(job)
    allowance = allowance_of(job, job.step.operation_ref, job.step.operation)
    plunger = Plunger(job, course, bar, insert)
    for outline in outlines:
        feature = job.program.get(outline.ref)
        if isinstance(job.step.operation, CuttingIn):
            _cut_in(job, plunger, outline, feature)
        else:
            _groove(job, plunger, bar, outline, allowance)
    plunger.go_home()


def _groove(
    job: ToolPathTask,
    plunger: Plunger,
    bar: TurningBlank,
    outline: FeatureOutline,
    allowance: float,
) -> None:
    """Generate the moves of one groove: plunges, or passes along its walls and floor."""
    insert = plunger.insert
    surface = surface_of((outline,), HalfPlane())
    if not surface.pieces:
        raise job.fault("the groove has no floor", outline.ref)
    around = [
        *bar.left.within(-inf, surface.low).pieces,
        *surface.pieces,
        *bar.left.within(surface.high, inf).pieces,
    ]
    solid = highest(around)
    centres = insert.rolled(solid, allowance)
    mouth = _mouth(surface, bar.left)
    low, high = _room(job, insert, outline, mouth, allowance)
    bottom = centres.bottom(low - FITS, high + FITS)
    _check_depth(job, plunger, outline, bar.left.top(*mouth) + insert.corner - bottom)
    left = bottom - insert.corner - allowance - outline.radii[0]
    if left > SEEN:
        text = f"the insert does not reach the bottom: {left:.3g} mm remain"
        plunger.course.find(job.warning(text, outline.ref))
    if isinstance(job.step.operation, GroovingFinish):
        _finish(job, plunger, centres, low, high)
        return
    for u in _places(job, insert, low, high):
        floor = centres.bottom(u - 2.0 * FITS, u + 2.0 * FITS)
        _plunge(job, plunger, u, plunger.rim.at(u) - floor)


def _mouth(surface: RadiusProfile, stock: RadiusProfile) -> tuple[float, float]:
    """Interval of u in which a groove is open in the stock."""
    cuts = {end for piece in surface.pieces for end in (piece.low, piece.high)}
    for piece in surface.pieces:
        for other in stock.pieces:
            cuts.update(crossings(piece, other))
    order = sorted(cuts)
    open_ones = [
        (a, b)
        for a, b in pairwise(order)
        if surface.at(0.5 * (a + b)) < stock.at(0.5 * (a + b)) - FITS
    ]
    return (open_ones[0][0], open_ones[-1][1]) if open_ones else (order[0], order[-1])


def _room(
    job: ToolPathTask,
    insert: GroovingInsert,
    outline: FeatureOutline,
    mouth: tuple[float, float],
    allowance: float,
) -> tuple[float, float]:
    """Range of u of the left corner's centre between the walls at their widest."""
    width = mouth[1] - mouth[0]
    if width < insert.width + 2.0 * allowance - FITS:
        message = (
            f"{width:g} mm groove width with {allowance:g} mm allowance on each wall: "
            f"too narrow for an insert of {insert.width:g} mm"
        )
        raise job.fault(message, outline.ref)
    reach = insert.corner + allowance
    low, high = mouth[0] + reach, mouth[1] - reach - insert.flat
    return (low, high) if high > low + FITS else (0.5 * (low + high), 0.5 * (low + high))


def _check_depth(
    job: ToolPathTask, plunger: Plunger, outline: FeatureOutline, depth: float
) -> None:
    """Check that the insert reaches the floor and that there is material above it."""
    if depth > plunger.insert.reach + FITS:
        message = (
            f"{depth:.4g} mm groove depth, the insert reaches {plunger.insert.reach:g} mm "
            "(maximum_grooving_depth)"
        )
        raise job.fault(message, outline.ref)
    if depth <= FITS:
        raise job.fault(
            "nothing to remove: the stock is already at the groove floor", outline.ref
        )


def _places(job: ToolPathTask, insert: GroovingInsert, low: float, high: float) -> list[float]:
    """Positions u of the grooving plunges, in cutting order."""
    strategy = strategy_of(job)
    step = max(OVERLAP * insert.flat, 0.25 * insert.width)
    direction = None
    if isinstance(strategy, GroovingStrategy):
        direction = direction_in(job, HalfPlane(), strategy.grooving_direction)
        if strategy.travel_distance is not None:
            step = strategy.travel_distance
            if not 0.0 < step <= insert.width:
                message = (
                    f"a step of {step:g} mm exceeds the insert width of {insert.width:g} mm"
                )
                raise strategy_fault(job, message, "travel_distance")
    count = ceil((high - low) / step - FITS)
    if count <= 0:
        return [low]
    places = [low + (high - low) * i / count for i in range(count + 1)]
    if direction is not None and abs(direction[0]) > abs(direction[1]):
        return places if direction[0] > 0.0 else places[::-1]
    middle = 0.5 * (low + high)
    return sorted(places, key=lambda u: (round(abs(u - middle), 6), u))


def _plunge(job: ToolPathTask, plunger: Plunger, u: float, depth: float) -> None:
    """Make a plunge, with pecks if the strategy asks for them, and a dwell at the floor."""
    if depth <= FITS:
        return
    strategy = strategy_of(job)
    back = strategy.retract_distance if isinstance(strategy, MultistepGroovingStrategy) else 0.0
    depths = depths_of(job) or ((plunger.insert.width,) if back else ())
    plunger.over(u)
    plunger.peck(u, cumulative(depth, depths) if back else [depth], back or 0.0)
    _dwell(job, plunger.course)
    plunger.up(u)


def _dwell(job: ToolPathTask, course: PathBuilder) -> None:
    """Dwell at the floor, in seconds or revolutions as written in the file."""
    operation = job.step.operation
    written = operation.dwell if isinstance(operation, Grooving) else None
    if written is None:
        return
    value = written.value if isinstance(written, Typed) else written
    if not isinstance(value, (int, float)) or not 0.0 <= value < 1e4:
        raise job.fault(
            "the dwell must be a number from 0 to 10 000", job.step.operation_ref, "dwell"
        )
    if isinstance(written, Typed) and "REV" in written.keyword.upper():
        course.dwell(revolutions=float(value))
    elif value > 0.0:
        course.dwell(seconds=float(value))


def _finish(
    job: ToolPathTask, plunger: Plunger, centres: RadiusProfile, low: float, high: float
) -> None:
    """Run down the front wall and along the floor, then down the wall at the chuck."""
    middle = 0.5 * (low + high)
    floor = centres.within(low - FITS, high + FITS)
    chuck_side = list(floor.within(floor.low, middle).chain())
    front_side = [p.reversed() for p in reversed(floor.within(middle, floor.high).chain())]
    for side in (front_side, chuck_side):
        if not side:
            continue
        start = side[0].start
        plunger.over(start[0])
        plunger.down([ProfilePiece(start=plunger.start_of(start[0]), end=start), *side])
        _dwell(job, plunger.course)
        plunger.up(side[-1].end[0])


def _cut_in(
    job: ToolPathTask, plunger: Plunger, outline: FeatureOutline, feature: Entity
) -> None:
    """Plunge to the feature's radius; at radius 0 go past the axis by the corner radius."""
    insert = plunger.insert
    least = outline.radii[0]
    if isinstance(feature, Groove):
        u = 0.5 * (outline.low + outline.high - insert.flat)
    else:
        u = outline.low - insert.corner - insert.flat
    bottom = least + insert.corner if least > 0.0 else 0.0
    depth = plunger.rim.at(u) - bottom
    _check_depth(job, plunger, outline, depth)
    _plunge(job, plunger, u, depth)
