"""Tool paths of drilling, boring, reaming and tapping (ISO 14649-11).

Over the hole on the security plane, in rapid down to the retract plane, into the hole and back,
to the next hole. Not one rapid goes below the retract plane, but those of a drill that pecks.
"""

from collections.abc import Iterator
from math import hypot, inf

from stepnc_model.entities.drilling import BackBoring, DrillingTypeOperation, ThreadDrilling
from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.frame import point_of
from stepnc_model.toolpath.hole.back import back_findings, bore_back, bore_of
from stepnc_model.toolpath.hole.back_feature import back_holes
from stepnc_model.toolpath.hole.cycle import HoleCut, cut_hole
from stepnc_model.toolpath.hole.depth import depth_findings, depth_of
from stepnc_model.toolpath.hole.feature import Hole, holes_of
from stepnc_model.toolpath.hole.feed import Stage, stages_of
from stepnc_model.toolpath.hole.thread import drill_thread, threaded_holes
from stepnc_model.toolpath.job import DEFAULT_CLEARANCE, Job
from stepnc_model.toolpath.path import ToolPath

ON_AXIS = 1e-3
"""mm by which a start point may lie beside the axis of its hole"""


def hole_path(job: Job) -> ToolPath:
    """Tool path of an operation of the drilling family.

    Parameters
    ----------
    job : Job

    Returns
    -------
    ToolPath
        From the security plane and back to it, hole by hole in the order of the file.

    Raises
    ------
    PathError
        When the file does not say enough, or the hole and the tool do not fit.
    """
    operation = job.step.operation
    if not isinstance(operation, DrillingTypeOperation):
        raise job.fault("is no operation that makes holes", job.step.operation_ref)
    with job.program.using(job.step.operation_ref, *job.step.features):
        holes = tuple(_holes(job, operation))
        if not holes:
            raise job.fault("its pattern omits every hole", job.step.features[0])
        course = Course(job, holes[0].at(job.security_z))
        _notes(course, job, operation)
        cuts = [_cut(course, job, operation, hole) for hole in holes]
        for last, cut in zip([None, *cuts[:-1]], cuts, strict=True):
            if last is not None:
                _link(course, last, cut)
            course.descend(cut.hole.at(cut.retract_z))
            _make(course, cut)
        course.rapid(cuts[-1].hole.at(job.security_z))
        return course.finished()


def _holes(job: Job, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes that the operation makes."""
    if isinstance(operation, BackBoring):
        return back_holes(job)
    if isinstance(operation, ThreadDrilling):
        return threaded_holes(job, operation)
    return holes_of(job, operation)


def _make(course: Course, cut: HoleCut) -> None:
    """Make one hole; the tool stands above it on the retract plane, and ends there."""
    if isinstance(cut.operation, BackBoring):
        bore_back(course, cut)
    elif isinstance(cut.operation, ThreadDrilling):
        drill_thread(course, cut, cut.operation)
    else:
        cut_hole(course, cut)


def _notes(course: Course, job: Job, operation: DrillingTypeOperation) -> None:
    """What is assumed about the operation as a whole."""
    if operation.retract_plane is None:
        text = f"no retract plane: {DEFAULT_CLEARANCE:g} mm above the feature assumed"
        course.find(job.note(text, attribute="retract_plane"))
    if operation.start_point is not None:
        x, y, _ = point_of(job.program, operation.start_point)
        if hypot(x, y) > ON_AXIS:
            text = f"start point {hypot(x, y):g} mm beside the axis: the hole stays on its axis"
            course.find(job.warning(text, attribute="start_point"))


def _cut(course: Course, job: Job, operation: DrillingTypeOperation, hole: Hole) -> HoleCut:
    """How one hole is made."""
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


def _back_cut(course: Course, job: Job, operation: BackBoring, hole: Hole) -> HoleCut:
    """How one hole is bored from behind."""
    bore = bore_of(job, operation, hole)
    for finding in back_findings(job, operation, hole, bore):
        course.find(finding)
    return HoleCut(
        job=job,
        operation=operation,
        hole=hole,
        retract_z=_retract_z(job, operation, hole),
        bottom_z=bore.below_z,
        stages=(Stage(end_z=bore.below_z, feed=job.feed),),
    )


def _retract_z(job: Job, operation: DrillingTypeOperation, hole: Hole) -> float:
    """Height of the retract plane, which never lies above the security plane."""
    above = operation.retract_plane
    if above is None:
        above = DEFAULT_CLEARANCE
    if not 0.0 < above < inf:
        message = f"{above:g} mm: it must lie above the feature"
        raise job.fault(message, job.step.operation_ref, "retract_plane")
    if job.security_z <= hole.entry_z:
        message = (
            f"the security plane z = {job.security_z:g} mm does not lie above the hole, "
            f"whose top is z = {hole.entry_z:g} mm"
        )
        raise job.fault(message, job.step.ref, "its_secplane")
    return min(hole.entry_z + above, job.security_z)


def _link(course: Course, last: HoleCut, cut: HoleCut) -> None:
    """Over to the next hole: on the retract plane where no stock can stand in the way."""
    height = max(last.retract_z, cut.retract_z)
    stock = cut.job.stock
    if stock is None or stock.high[2] >= height:
        height = cut.job.security_z
    course.rapid(last.hole.at(height))
    course.rapid(cut.hole.at(height))
