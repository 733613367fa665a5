"""The tool path of one turning workingstep, from its features, tool and strategy.

Procedure and types of moves after Shin et al., "Developing a virtual machining model to
generate MTConnect machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54 (2016)
4487-4505, section 3.2.2: removal volume, offset by the nose, scan lines, net cuts, approach
and retract, links. What is programmed is the imaginary tool tip: see
:mod:`stepnc_model.toolpath.turning.plane`.
"""

from stepnc_model.entities.turning import (
    Contouring,
    Facing,
    Grooving,
    Knurling,
    Threading,
)
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.job import DEFAULT_CLEARANCE, Job
from stepnc_model.toolpath.path import Point, ToolPath
from stepnc_model.toolpath.turning.contour import contour, plane_of
from stepnc_model.toolpath.turning.groove import groove
from stepnc_model.toolpath.turning.history import bar_of
from stepnc_model.toolpath.turning.knurl import knurl
from stepnc_model.toolpath.turning.outline import Outline, outline_of
from stepnc_model.toolpath.turning.plane import tip_of
from stepnc_model.toolpath.turning.setting import clearance_of
from stepnc_model.toolpath.turning.stock import Bar, operation_of
from stepnc_model.toolpath.turning.thread import thread, threaded_feature


def turning_path(job: Job) -> ToolPath:
    """Tool path of a turning workingstep.

    Parameters
    ----------
    job : Job

    Returns
    -------
    ToolPath
        Positions of the imaginary tool tip in the coordinates of the setup: x is the radius.

    Raises
    ------
    PathError, SchemaError
        When feature, tool, stock or strategy allow no path.
    """
    operation = operation_of(job)
    with job.program.using(job.step.operation_ref, *job.step.features):
        outlines = _outlines(job)
        bar = bar_of(job, outlines)
        course = Course(job, _safe_point(job, bar), is_turning=True)
        for finding in bar.findings:
            course.find(finding)
        if operation.retract_plane is None:
            text = f"no retract plane: {DEFAULT_CLEARANCE:g} mm off the stock assumed"
            course.find(job.note(text, attribute="retract_plane"))
        _make(job, course, bar, outlines)
    return course.finished()


def _make(job: Job, course: Course, bar: Bar, outlines: tuple[Outline, ...]) -> None:
    """The path by the kind of the operation."""
    operation = job.step.operation
    if isinstance(operation, (Contouring, Facing)):
        tool = job.program.get(job.step.tool_ref)
        if not isinstance(tool, TurningMachineCuttingTool):
            raise job.fault("is no turning tool", job.step.tool_ref)
        if job.tool.corner_radius is None:
            text = "no nose radius: a sharp tool assumed"
            course.find(job.note(text, job.step.tool_ref, "cutting_edge"))
        tip = tip_of(tool.hand_of_tool, job.tool.corner_radius or 0.0)
        contour(job, course, bar, outlines, plane_of(job, tip))
    elif isinstance(operation, Grooving):
        groove(job, course, bar, outlines)
    elif isinstance(operation, Threading):
        thread(job, course, bar, outlines[0])
    elif isinstance(operation, Knurling):
        knurl(job, course, bar, outlines[0])
    else:
        raise job.fault("no path is made for this kind of operation", job.step.operation_ref)


def _outlines(job: Job) -> tuple[Outline, ...]:
    """Outlines of the features, the foremost one first, all of them within the bar."""
    if not job.step.features:
        raise job.fault("has no feature: nothing tells what to turn", job.step.ref)
    reach = _reach(job)
    found = tuple(
        outline_of(job, threaded_feature(job, ref), reach) for ref in job.step.features
    )
    if job.stock is not None:
        for outline in found:
            _check_bar(job, outline)
    return tuple(sorted(found, key=lambda outline: -outline.high))


def _reach(job: Job) -> float:
    """Radius of the bar, or 0 where none is known."""
    if job.stock is None:
        return 0.0
    return job.stock.radius or max(map(abs, (*job.stock.low[:2], *job.stock.high[:2])))


def _check_bar(job: Job, outline: Outline) -> None:
    """A feature must lie within the bar: not behind it, not around it."""
    stock = job.stock
    if stock is None:
        return
    if outline.low < stock.low[2] or outline.low > stock.high[2]:
        message = (
            f"reaches to z = {outline.low:g} mm; "
            f"the bar from {stock.low[2]:g} to {stock.high[2]:g} mm"
        )
        raise job.fault(message, outline.ref)
    least = outline.radii[0]
    if least > _reach(job):
        message = f"a radius of {least:g} mm: that of the bar is {_reach(job):g} mm"
        raise job.fault(message, outline.ref)
    if least < 0.0:
        raise job.fault(f"a radius of {least:g} mm: it must not be negative", outline.ref)


def _safe_point(job: Job, bar: Bar) -> Point:
    """Outside the bar and in front of it."""
    clearance = clearance_of(job)
    front = bar.raw.high + clearance
    return bar.radius + clearance, 0.0, max(job.security_z, front)
