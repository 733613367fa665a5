"""Tool paths of drilling, boring, reaming and tapping (ISO 14649-11).

The tool moves to the hole on the security plane, in rapid down to the retract plane, into the
hole and back, and on to the next hole. Only pecking makes rapids below the retract plane.

In thread drilling, one tool drills a hole and mills its thread on a helix. The tool drills
along the axis and mills the thread on its way out. With ``helical_movement_on_forward`` it cuts
on a helix on its way in as well, and moves out through the thread that it has cut.

The thread is the feature itself, or a thread whose ``applied_shape`` is the hole. The
programmed point runs at ``(D_thread − D_tool)/2`` from the axis. A tangential half circle of
half that radius leads from the axis onto the helix, while the tool moves a quarter turn about
the axis: it rises by a quarter of the pitch and stays in the thread. It leaves the same way.

A right-hand thread is cut upwards counter-clockwise, which is climb milling with a right-hand
tool. The lowest full tooth is at the tip of the tool, so any teeth above it follow in the same
groove. In a blind hole the tool rises by one pitch before it moves sideways.

``number_of_threads`` is the pitch in metric units, or the threads per inch in English units
(ISO 14649-10).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, hypot, inf, pi

from stepnc_model.entities.features import DefinedThread, RoundHole, Thread
from stepnc_model.entities.milling import BackBoring, DrillingTypeOperation, ThreadDrilling
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import feature_depth
from stepnc_model.toolpath.frame import point_of
from stepnc_model.toolpath.hole.back import back_findings, back_holes, bore_back, bore_of
from stepnc_model.toolpath.hole.cycle import (
    FeedStage,
    HoleCut,
    cut_hole,
    dwell,
    feed_to,
    retract,
    stages_of,
)
from stepnc_model.toolpath.hole.feature import (
    TOLERANCE,
    Hole,
    depth_findings,
    depth_of,
    holes_of,
    size_of,
    tip_length,
)
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.task import DEFAULT_CLEARANCE, PathBuilder, ToolPathTask
from stepnc_model.units import MM_PER_INCH

LEAST_RADIUS = 0.02
"""Least radius of the helix, mm; controls treat smaller arcs as points."""

MOST_TURNS = 1000

"""Millimetres per inch, by definition."""

PITCHES = ("MM", "MILLIMETRE", "MILLIMETER", "PITCH")
"""Units with which ``number_of_threads`` is a pitch in mm."""

DENSITIES = ("INCH", "IN", "1/INCH", "1/IN", "TPI")
"""Units with which ``number_of_threads`` is a number of threads per inch."""

LEFT = ("LEFT", "LEFT HAND", "LH", "L")
RIGHT = ("RIGHT", "RIGHT HAND", "RH", "R", "")


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadHelix:
    """Helical path of the tool tip for thread milling, mm."""

    radius: float
    pitch: float
    turns: int
    low_z: float
    """Height z of the tip at the lower end of the turns, mm."""
    sense: float
    """Sense of the thread: 1 for right-hand, −1 for left-hand."""

    @property
    def high_z(self) -> float:
        """Height z of the tip at the upper end of the turns, mm."""
        return self.low_z + self.turns * self.pitch


def threaded_holes(job: ToolPathTask, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes to be drilled and threaded; for a named thread, the hole that it applies to.

    Yields
    ------
    Hole

    Raises
    ------
    PathError
        If there is no hole, its axis is not parallel to the tool, or a size is missing.
    """
    for hole in holes_of(job, operation):
        thread = job.program.get(hole.ref)
        shape = thread.applied_shape[0] if isinstance(thread, Thread) else hole.ref
        entity = job.program.get(shape)
        if shape == hole.ref or not isinstance(entity, RoundHole):
            yield hole
            continue
        depth = feature_depth(job.program, shape)
        below = hole.top[2] - job.frame(shape).origin[2]
        diameter = size_of(job, shape, entity)
        yield replace(
            hole,
            ref=shape,
            depth=None if depth is None else depth + below,
            diameter=diameter,
            narrowest=diameter,
            bottom=job.program.get(entity.bottom_condition),
        )


def drill_thread(course: PathBuilder, cut: HoleCut, operation: ThreadDrilling) -> None:
    """Drill and thread one hole; the tool starts and ends above it.

    Raises
    ------
    PathError
        If there is no thread, or the tool does not fit the thread.
    """
    if operation.helical_movement_on_forward:
        _thread_in_and_out(course, cut)
    else:
        _drill_in_thread_out(course, cut)
    retract(course, cut)


def _drill_in_thread_out(course: PathBuilder, cut: HoleCut) -> None:
    """Drill along the axis to the bottom, and thread upwards on a helix."""
    pitch = _pitch(cut)
    teeth_top_z = cut.hole.top[2] - tip_length(cut.job)
    free_z = cut.bottom_z if cut.hole.is_through else cut.bottom_z + pitch
    wanted_z = teeth_top_z - _length(cut)
    start_z = max(free_z, wanted_z)
    if start_z > wanted_z + TOLERANCE:
        text = f"the thread is {start_z - wanted_z:.4g} mm too short: no room below it"
        course.find(cut.job.warning(text, cut.hole.ref))
    helix = _helix(cut, low_z=start_z + 0.25 * pitch, clear_z=teeth_top_z)
    feed_to(course, cut, cut.bottom_z)
    _pause(course, cut)
    course.line(cut.hole.at(start_z), MoveType.NO_CONTACT)
    _onto(course, cut, helix, rise=1.0)
    _turns(course, cut, helix, rise=1.0, type=MoveType.CONTACT)
    _off(course, cut, helix)


def _thread_in_and_out(course: PathBuilder, cut: HoleCut) -> None:
    """Cut downwards on the helix, and return upwards through the thread."""
    helix = _helix(cut, low_z=cut.bottom_z, clear_z=cut.hole.top[2])
    if helix.radius > 0.5 * cut.job.tool.diameter:
        message = (
            f"on a helix of radius {helix.radius:g} mm, a tool of {cut.job.tool.diameter:g} mm "
            "leaves a core standing"
        )
        raise cut.job.fault(message, cut.job.step.operation_ref, "its_tool")
    if not cut.is_one_feed:
        text = "the helix has a single feed: reductions at start and end are ignored"
        course.find(cut.job.note(text, attribute="its_machining_strategy"))
    course.line(cut.hole.at(helix.high_z + 0.25 * helix.pitch), MoveType.NO_CONTACT)
    _onto(course, cut, helix, rise=-1.0)
    _turns(course, cut, helix, rise=-1.0, type=MoveType.CONTACT)
    _pause(course, cut)
    _turns(course, cut, helix, rise=1.0, type=MoveType.NO_CONTACT)
    _off(course, cut, helix)


def _helix(cut: HoleCut, *, low_z: float, clear_z: float) -> ThreadHelix:
    """Helix of whole turns of the tip, from one height up to at least another."""
    pitch = _pitch(cut)
    turns = max(1, ceil((clear_z - low_z) / pitch - TOLERANCE))
    if turns > MOST_TURNS:
        message = f"{turns} turns of {pitch:g} mm: at most {MOST_TURNS} allowed"
        raise cut.job.fault(message, _thread_ref(cut), "number_of_threads")
    return ThreadHelix(
        radius=_radius(cut), pitch=pitch, turns=turns, low_z=low_z, sense=_sense(cut)
    )


def _onto(course: PathBuilder, cut: HoleCut, helix: ThreadHelix, *, rise: float) -> None:
    """Move on a half circle from the axis onto the helix, up or down."""
    x, y, z = course.at
    end = (x + helix.radius, y, z + rise * 0.25 * helix.pitch)
    centre = (x + 0.5 * helix.radius, y, z)
    course.arc(end, MoveType.CONTACT, centre=centre, turn=rise * helix.sense * pi)


def _turns(
    course: PathBuilder, cut: HoleCut, helix: ThreadHelix, *, rise: float, type: MoveType
) -> None:
    """Move along all turns of the helix, up or down."""
    x, y, z = course.at
    end = (x, y, helix.high_z if rise > 0.0 else helix.low_z)
    turn = rise * helix.sense * 2.0 * pi * helix.turns
    course.arc(end, type, centre=cut.hole.at(z), turn=turn)


def _off(course: PathBuilder, cut: HoleCut, helix: ThreadHelix) -> None:
    """Move on a half circle from the helix up to the axis."""
    x, y, z = course.at
    end = cut.hole.at(z + 0.25 * helix.pitch)
    centre = (x - 0.5 * helix.radius, y, z)
    course.arc(end, MoveType.NO_CONTACT, centre=centre, turn=helix.sense * pi)


def _pause(course: PathBuilder, cut: HoleCut) -> None:
    dwell(course, cut, cut.operation.dwell_time_bottom, "dwell_time_bottom")


def _thread_ref(cut: HoleCut) -> Ref[Thread]:
    """Thread of a hole; a thread named by the workingstep comes first."""
    threads = cut.job.program.model.of_type(Thread)
    found = [ref for ref, thread in threads if cut.hole.ref in (ref, *thread.applied_shape)]
    named = [ref for ref in found if ref in cut.job.step.features]
    if not found:
        message = "no thread has this hole as its applied_shape: the pitch is unknown"
        raise cut.job.fault(message, cut.hole.ref)
    return (named or found)[0]


def _pitch(cut: HoleCut) -> float:
    """Pitch of the thread, mm, from its number and unit."""
    ref = _thread_ref(cut)
    number = cut.job.program.get(cut.job.program.get(ref).number_of_threads)
    value, unit = number.its_parameter_value, number.its_parameter_unit.strip().upper()
    if not 0.0 < value < inf:
        raise cut.job.fault(f"{value:g}: the pitch must be positive", ref, "number_of_threads")
    if unit in PITCHES:
        return value
    if unit in DENSITIES:
        return MM_PER_INCH / value
    message = f"unit '{unit}': expected a pitch in MM, or threads per INCH"
    raise cut.job.fault(message, ref, "number_of_threads")


def _sense(cut: HoleCut) -> float:
    """Sense of the thread: 1 for right-hand, −1 for left-hand."""
    ref = _thread_ref(cut)
    hand = cut.job.program.get(cut.job.program.get(ref).thread_hand).descriptive_string
    text = hand.strip().upper().replace("-", " ").replace("_", " ")
    if text not in (*LEFT, *RIGHT):
        raise cut.job.fault(f"'{hand}': expected LEFT or RIGHT", ref, "thread_hand")
    return -1.0 if text in LEFT else 1.0


def _radius(cut: HoleCut) -> float:
    """Radius of the helix of the tool's axis, mm."""
    ref = _thread_ref(cut)
    thread = cut.job.program.get(ref)
    major, width = thread.major_diameter, cut.job.tool.diameter
    if not 0.0 < major < inf:
        raise cut.job.fault(
            f"{major:g} mm: the diameter must be positive", ref, "major_diameter"
        )
    radius = 0.5 * (major - width)
    if radius < LEAST_RADIUS:
        message = f"tool of {width:g} mm is too wide to mill a thread of {major:g} mm diameter"
        raise cut.job.fault(message, cut.job.step.operation_ref, "its_tool")
    minor = thread.minor_diameter if isinstance(thread, DefinedThread) else None
    if minor and width > minor + cut.hole.tolerance:
        message = f"tool of {width:g} mm is wider than the minor diameter of {minor:g} mm"
        raise cut.job.fault(message, cut.job.step.operation_ref, "its_tool")
    return radius


def _length(cut: HoleCut) -> float:
    """Length of the thread from its top, mm."""
    ref = _thread_ref(cut)
    length = cut.job.program.get(cut.job.program.get(ref).partial_profile).effective_length
    if not 0.0 < length < inf:
        raise cut.job.fault(
            f"{length:g} mm: the length must be positive", ref, "partial_profile"
        )
    return length


ON_AXIS = 1e-3
"""Greatest distance of a start point from the axis of its hole, mm."""


def hole_path(job: ToolPathTask) -> ToolPath:
    """Generate the tool path of a drilling, boring, reaming or tapping operation.

    Returns
    -------
    ToolPath
        From the security plane and back to it, hole by hole in the order of the file.

    Raises
    ------
    PathError
        If the file lacks information, or the tool does not fit the hole.
    """
    operation = job.step.operation
    if not isinstance(operation, DrillingTypeOperation):
        raise job.fault("is not a hole-making operation", job.step.operation_ref)
    with job.program.using(job.step.operation_ref, *job.step.features):
        holes = tuple(_holes(job, operation))
        if not holes:
            raise job.fault("the pattern omits every hole", job.step.features[0])
        course = PathBuilder(job, holes[0].at(job.security_z))
        _notes(course, job, operation)
        if operation.feed_on_retract == 0.0:
            text = "0 is no feed ratio: read as not given"
            course.find(job.warning(text, attribute="feed_on_retract"))
            operation = replace(operation, feed_on_retract=None)
        cuts = [_cut(course, job, operation, hole) for hole in holes]
        for last, cut in zip([None, *cuts[:-1]], cuts, strict=True):
            if last is not None:
                _link(course, last, cut)
            course.descend(cut.hole.at(cut.retract_z))
            _make(course, cut)
        course.rapid(cuts[-1].hole.at(job.security_z))
        return course.finished()


def _holes(job: ToolPathTask, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes that the operation machines."""
    if isinstance(operation, BackBoring):
        return back_holes(job)
    if isinstance(operation, ThreadDrilling):
        return threaded_holes(job, operation)
    return holes_of(job, operation)


def _make(course: PathBuilder, cut: HoleCut) -> None:
    """Machine one hole; the tool starts and ends on the retract plane above it."""
    if isinstance(cut.operation, BackBoring):
        bore_back(course, cut)
    elif isinstance(cut.operation, ThreadDrilling):
        drill_thread(course, cut, cut.operation)
    else:
        cut_hole(course, cut)


def _notes(course: PathBuilder, job: ToolPathTask, operation: DrillingTypeOperation) -> None:
    """Report assumptions about the operation as a whole."""
    if operation.retract_plane is None:
        text = f"no retract plane given: assuming {DEFAULT_CLEARANCE:g} mm above the feature"
        course.find(job.note(text, attribute="retract_plane"))
    if operation.start_point is not None:
        x, y, _ = point_of(job.program, operation.start_point)
        if hypot(x, y) > ON_AXIS:
            text = f"start point {hypot(x, y):g} mm off the axis: ignored, drilling on the axis"
            course.find(job.warning(text, attribute="start_point"))


def _cut(
    course: PathBuilder, job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole
) -> HoleCut:
    """Depths, heights and feeds for one hole."""
    if isinstance(operation, BackBoring):
        return _back_cut(course, job, operation, hole)
    depth = depth_of(job, operation, hole)
    for finding in depth_findings(job, operation, hole, depth):
        course.find(finding)
    return HoleCut(
        job=job,
        operation=operation,
        hole=hole,
        retract_z=_retract_z(job, operation, hole),
        bottom_z=hole.top[2] - depth.tip,
        stages=stages_of(job, operation, hole, depth),
    )


def _back_cut(
    course: PathBuilder, job: ToolPathTask, operation: BackBoring, hole: Hole
) -> HoleCut:
    """Depths, heights and feeds for boring one hole from behind."""
    bore = bore_of(job, operation, hole)
    for finding in back_findings(job, operation, hole, bore):
        course.find(finding)
    return HoleCut(
        job=job,
        operation=operation,
        hole=hole,
        retract_z=_retract_z(job, operation, hole),
        bottom_z=bore.below_z,
        stages=(FeedStage(end_z=bore.below_z, feed=job.feed),),
    )


def _retract_z(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> float:
    """Height z of the retract plane, at most that of the security plane, mm."""
    above = operation.retract_plane
    if above is None:
        above = DEFAULT_CLEARANCE
    if not 0.0 < above < inf:
        message = f"{above:g} mm: the retract plane must lie above the feature"
        raise job.fault(message, job.step.operation_ref, "retract_plane")
    if job.security_z <= hole.entry_z:
        message = (
            f"the security plane z = {job.security_z:g} mm does not lie above the hole, "
            f"whose top is z = {hole.entry_z:g} mm"
        )
        raise job.fault(message, job.step.ref, "its_secplane")
    return min(hole.entry_z + above, job.security_z)


def _link(course: PathBuilder, last: HoleCut, cut: HoleCut) -> None:
    """Move to the next hole: on the retract plane if no stock can stand in the way."""
    height = max(last.retract_z, cut.retract_z)
    stock = cut.job.stock
    if stock is None or stock.high[2] >= height:
        height = cut.job.security_z
    course.rapid(last.hole.at(height))
    course.rapid(cut.hole.at(height))
