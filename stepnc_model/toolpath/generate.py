"""Tool paths of a whole program, in program order.

An executable for which no path can be made raises an error, or is passed to the caller, who
continues with the workingsteps that do not depend on it by their geometry.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import NoReturn

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import (
    ProgramStop,
    RapidMovement,
    Setup,
)
from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.program_listing import (
    STRUCTURES,
    WITHOUT_MOVES,
    ProgramLine,
    is_followed,
    not_followed,
)
from stepnc_model.toolpath.explicit.operation import explicit_path, rapid_movement_path
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.milling.operation import milling_path
from stepnc_model.toolpath.omissions import LeftOut
from stepnc_model.toolpath.path import Function, ToolPath
from stepnc_model.toolpath.task import job_of
from stepnc_model.toolpath.turning.operation import turning_path

OnFault = Callable[[ProgramLine, SchemaError], None]
"""Callback for executables without a tool path, called with the reason."""


PathOf = Callable[[Program, ResolvedWorkingstep], ToolPath]
"""Function that makes the tool path of a workingstep, as :func:`workingstep_path`."""

MOST_STEPS = 20_000
"""Number of moves in paths that are kept; some 10 MB. Longer programs have paths made again."""


def raised(_executable: ProgramLine, error: SchemaError) -> NoReturn:
    """Raise the error of the first executable for which no path can be made."""
    raise error


def workingstep_path(program: Program, step: ResolvedWorkingstep) -> ToolPath:
    """Tool path of one workingstep: as given in the file, or else made from its feature.

    Raises
    ------
    SchemaError, PathError
        If the file lacks information, or the tool cannot do the operation.
    """
    with program.using(step.operation_ref, *step.features, step.setup, step.ref):
        job = job_of(program, step)
        operation = step.operation
        if operation.its_toolpath is not None:
            return explicit_path(job)
        if isinstance(operation, DrillingTypeOperation):
            return hole_path(job)
        if isinstance(operation, TurningMachiningOperation):
            return turning_path(job)
        return milling_path(job)


def generate(
    program: Program, on_fault: OnFault = raised, *, path_of: PathOf = workingstep_path
) -> Iterator[ToolPath | Function]:
    """Generate the tool paths and functions of a program, one after another.

    Parameters
    ----------
    on_fault : callable
        Called with each executable that is left out, and its error; by default raises it.
    path_of : callable
        Makes the path of a workingstep.

    Yields
    ------
    ToolPath or Function
        In program order; coordinates are those of the respective setup.

    Raises
    ------
    SchemaError
        Unless ``on_fault`` handles the error.
    """
    # A workingstep that runs several times is there as often.
    steps: dict[int, deque[ResolvedWorkingstep]] = {}
    for each in program.workingsteps:
        steps.setdefault(int(each.ref), deque()).append(each)
    skipped: int | None = None
    left_out = LeftOut(program)
    setup: Ref[Setup] | None = None
    for executable in program.executables:
        runs = None if executable.is_open else steps.get(int(executable.ref))
        step = runs.popleft() if runs else None
        if skipped is not None and executable.level > skipped:
            continue
        skipped = None
        path: ToolPath | None = None
        try:
            if step is not None:
                if setup is not None and step.setup != setup:
                    yield _new_setup(program, step)
                setup = step.setup
                path = path_of(program, step)
                left_out.require_ready(step, path)
                yield path
            else:
                yield from _other(program, executable)
        except SchemaError as error:
            skipped = executable.level
            if step is not None:
                left_out.add(step, path)
            on_fault(executable, error)


def require_ready(
    program: Program, step: ResolvedWorkingstep, missing: Mapping[int, str]
) -> None:
    """Raise an error if an earlier workingstep on the same feature was left out.

    A finishing cutter or a reamer would meet material that should have been removed before.

    Parameters
    ----------
    missing : mapping
        Name of the omitted workingstep by the instance number of its feature.
    """
    for feature in step.features:
        if int(feature) in missing:
            message = (
                f"the feature is not ready: workingstep '{missing[int(feature)]}' was left out"
            )
            at = step.ref
            raise PathError(message, entity=program.label(at), line=program.line(at))


class KeptPaths:
    """Paths of the workingsteps of a program as it is, made once. Running state.

    A path is kept for the very program and workingstep that it was made of; neither changes.
    """

    def __init__(self, most: int = MOST_STEPS) -> None:
        self._most = most
        self._kept: dict[int, tuple[Program, ResolvedWorkingstep, ToolPath]] = {}

    def __call__(self, program: Program, step: ResolvedWorkingstep) -> ToolPath:
        """Tool path of a workingstep, as :func:`workingstep_path` makes it."""
        kept = self._kept.get(int(step.ref))
        if kept is not None and kept[0] is program and kept[1] is step:
            return kept[2]
        path = workingstep_path(program, step)
        if kept is None and len(path.steps) <= self._most:
            self._most -= len(path.steps)
            self._kept[int(step.ref)] = program, step, path
        return path


def _other(program: Program, executable: ProgramLine) -> Iterator[ToolPath | Function]:
    """Paths and functions of an executable that is not a usable workingstep."""
    fault = program.fault_of(executable.ref)
    if fault is not None:
        raise fault
    entity = program.model.entity(int(executable.ref))
    if not is_followed(entity):
        raise program.error(not_followed(executable.keyword), executable.ref)
    if isinstance(entity, (*STRUCTURES, *WITHOUT_MOVES)):
        return
    if isinstance(entity, RapidMovement):
        # Without a path, the control moves over the security plane to what follows.
        path = rapid_movement_path(program, executable)
        yield path if path is not None else _function(executable, entity)
    elif entity is not None:
        yield _function(executable, entity)


def _function(executable: ProgramLine, entity: Entity) -> Function:
    """Function for a stop, a message, or a movement that is left to the control."""
    return Function(
        ref=executable.ref,
        keyword=executable.keyword,
        id=executable.id,
        text=getattr(entity, "its_text", ""),
    )


def _new_setup(program: Program, step: ResolvedWorkingstep) -> Function:
    """Program stop for clamping the workpiece in the next setup."""
    name = program.get(step.setup).its_id if step.setup is not None else ""
    return Function(
        ref=step.ref,
        keyword=ProgramStop.keyword,
        id=f"CLAMP FOR {name}".strip(),
    )
