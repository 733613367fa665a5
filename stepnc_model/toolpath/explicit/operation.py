"""Explicit tool paths of the file: lists of trajectories, connectors and pauses.

ISO 14649-10, ``its_toolpath`` of an operation or of a rapid movement. Interpretation:

* trajectories of a workingstep are in the coordinates of its feature, trajectories of a rapid
  movement and of machine axes in the coordinates of the setup;
* a connector (``CONNECT``) runs at feed unless its speed is rapid: values that a tool path
  leaves out come from its operation, and a file may connect within a pocket;
* trajectories that do not meet are joined straight where the gap is short, otherwise over the
  security plane, with rapid descent only beside or above the raw part.
"""

from collections.abc import Sequence

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import RapidMovement
from stepnc_model.entities.operations import Toolpath, ToolpathList
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.program_listing import ProgramLine
from stepnc_model.toolpath.explicit.path_builder import ExplicitPathBuilder, PathSurroundings
from stepnc_model.toolpath.frame import (
    Frame,
    compound_of,
    frame_of,
    placements,
    workpiece_frame,
)
from stepnc_model.toolpath.path import Point, ToolPath
from stepnc_model.toolpath.task import ToolPathTask, stock_of


def explicit_path(job: ToolPathTask) -> ToolPath:
    """Tool path of an operation exactly as given in the file.

    The path starts at the first point of the first trajectory and ends at the last point of the
    last one: no moves from or to the security plane are added, so that consecutive workingsteps
    can be joined directly.

    Returns
    -------
    ToolPath

    Raises
    ------
    PathError
        If the operation has no path, or its path cannot be followed.
    """
    step = job.step
    around = PathSurroundings(
        program=job.program,
        security_z=job.security_z,
        stock=job.stock,
        tool=lambda: job.tool,
        technology=step.technology_ref,
        functions=step.functions_ref,
        alike=step.technologies,
    )
    with job.program.using(step.operation_ref, *step.features):
        paths = _paths(job.program, step.operation_ref, step.operation.its_toolpath)
        walk, start = _walked(
            around, paths, path_frames(job.program, step), at=step.operation_ref
        )
        return ToolPath(
            workingstep=step.ref,
            id=step.id,
            operation_ref=step.operation_ref,
            tool_ref=step.tool_ref,
            technology_ref=step.technology_ref,
            functions_ref=step.functions_ref,
            is_turning=isinstance(step.operation, TurningMachiningOperation),
            start=start,
            steps=tuple(walk.steps),
            safe_z=around.security_z,
            findings=(*job.findings, *walk.findings),
        )


def path_frames(program: Program, step: ResolvedWorkingstep) -> tuple[Frame, ...]:
    """Frames in which an explicit path is followed: one for each copy of a pattern.

    A path for an element of a compound feature is given in the coordinates of the compound, as
    in example 3 of ISO 14649-11, where it begins on the security plane.

    Returns
    -------
    tuple of Frame
        In the coordinates of the setup; that of the workpiece if there is no feature.

    Raises
    ------
    PathError
        If a placement or a pattern is invalid.
    """
    if not step.features:
        return (workpiece_frame(program, step.setup),)
    feature = step.features[0]
    feature = compound_of(program, feature) or feature
    return tuple(each.frame for each in placements(program, step.setup, feature))


def rapid_movement_path(program: Program, executable: ProgramLine) -> ToolPath | None:
    """Path of a ``RAPID_MOVEMENT`` or ``RETURN_HOME``, all in rapid.

    Returns
    -------
    ToolPath or None
        None where the file leaves the route to the control: over the security plane to the next
        workingstep (ISO 14649-10).

    Raises
    ------
    PathError
        If the executable is not a rapid movement, or its path cannot be followed.
    """
    ref = executable.ref
    movement = program.get(ref)
    if not isinstance(movement, RapidMovement):
        raise program.path_error("is not a rapid movement", ref)
    if movement.its_toolpath is None:
        return None
    with program.using(ref):
        plane = frame_of(program, program.get(movement.its_secplane).position)
        around = PathSurroundings(
            program=program,
            security_z=plane.origin[2],
            stock=stock_of(program, executable.setup),
            tool=None,
            technology=None,
        )
        paths = _paths(program, ref, movement.its_toolpath)
        walk, start = _walked(around, paths, (Frame(),), at=ref)
        return ToolPath(
            workingstep=ref,
            id=executable.id,
            operation_ref=ref,
            tool_ref=None,
            technology_ref=None,
            functions_ref=None,
            is_turning=False,
            start=start,
            steps=tuple(walk.steps),
            safe_z=around.security_z,
            findings=tuple(walk.findings),
        )


def _walked(
    around: PathSurroundings,
    paths: Sequence[Ref[Toolpath]],
    frames: Sequence[Frame],
    *,
    at: Ref[Entity],
) -> tuple[ExplicitPathBuilder, Point]:
    """Follow paths in each of several frames; return the builder and the start point."""
    walk = ExplicitPathBuilder(around)
    for frame in frames:
        walk.follow(paths, frame)
    if walk.start is None:
        raise around.program.path_error("the tool path contains no moves", at, "its_toolpath")
    return walk, walk.start


def _paths(
    program: Program, ref: Ref[Entity], paths: Ref[ToolpathList] | None
) -> tuple[Ref[Toolpath], ...]:
    """Tool paths of an explicit path list, in order."""
    if paths is None:
        raise program.path_error("has no explicit tool path", ref, "its_toolpath")
    with program.using(paths):
        return tuple(program.get(paths).its_list)
