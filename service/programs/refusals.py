"""Reasons to refuse a program or single workingsteps before their feeds are optimised."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from optimiser.advice import RefusedWorkingstep
from stepnc_model.editing.own_operation import can_be_copied, with_own_operations
from stepnc_model.editing.writeback import WorkingstepUpdate
from stepnc_model.entities.executables import Parallel
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.programs.plausibility import refusal
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.program_listing import ProgramLine, is_followed, not_followed
from stepnc_model.programs.remedy import error_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Advisable:
    """Workingsteps whose feeds can be optimised, and those that are refused."""

    steps: tuple[ResolvedWorkingstep, ...]
    refused: tuple[RefusedWorkingstep, ...] = ()


def advisable(
    program: Program, chosen: Sequence[ResolvedWorkingstep], *, keep_going: bool
) -> Advisable:
    """Workingsteps that can be advised: all that are chosen, or those without a fault.

    Parameters
    ----------
    keep_going : bool
        Whether a fault refuses its workingstep only.

    Raises
    ------
    SchemaError
        With the first fault, unless other workingsteps can be advised and it keeps going.
    """
    if not keep_going:
        require_usable(program, chosen, program.file.findings + program.model.findings())
        return Advisable(steps=tuple(chosen))
    require_one_channel(program)
    refused = tuple(refused_workingsteps(program, chosen))
    left_out = {int(each.ref) for each in refused}
    steps = tuple(step for step in chosen if int(step.ref) not in left_out)
    if not steps and refused:
        raise SchemaError(f"'{refused[0].id}': {refused[0].reason}")
    require_any(steps)
    return Advisable(steps=steps, refused=refused)


@dataclass(frozen=True, slots=True, kw_only=True)
class Writable:
    """Updates that can be written without touching a refused workingstep."""

    program: Program
    """Program that takes them: operations shared with a refused workingstep are copied."""
    changes: tuple[WorkingstepUpdate, ...]
    findings: tuple[Finding, ...] = ()
    """Warnings about updates that cannot be written."""


def apart_from(
    program: Program,
    changes: Sequence[WorkingstepUpdate],
    refused: Sequence[RefusedWorkingstep],
) -> Writable:
    """Updates that leave the operations of refused workingsteps as they are.

    A workingstep that shares its operation with a refused one gets a copy of it. Operations of
    AP238 are not copied: their advice is shown, with a warning that it is not written.
    """
    refs = {int(each.ref) for each in refused}
    kept = {
        int(step.operation_ref): step for step in program.workingsteps if int(step.ref) in refs
    }
    shared = [each for each in changes if int(each.workingstep.operation_ref) in kept]
    if not shared:
        return Writable(program=program, changes=tuple(changes))
    if not can_be_copied(program):
        findings = tuple(
            _not_written(program, each, kept[int(each.workingstep.operation_ref)])
            for each in shared
        )
        rest = tuple(each for each in changes if each not in shared)
        return Writable(program=program, changes=rest, findings=findings)
    split = with_own_operations(program, {int(each.workingstep.ref) for each in shared})
    steps = {int(step.ref): step for step in split.workingsteps}
    return Writable(
        program=split,
        changes=tuple(
            replace(each, workingstep=steps[int(each.workingstep.ref)]) for each in changes
        ),
    )


def _not_written(
    program: Program, change: WorkingstepUpdate, refused: ResolvedWorkingstep
) -> Finding:
    """Warning about advice that would change the operation of a refused workingstep."""
    step = change.workingstep
    text = (
        f"the advice for '{step.id}' is not written: {program.label(step.operation_ref)} is "
        f"also the operation of '{refused.id}' ({refused.ref}), which stays as it is"
    )
    return program.finding(Severity.WARNING, text, step.ref, "its_operation")


def require_usable(
    program: Program, chosen: Sequence[ResolvedWorkingstep], findings: Sequence[Finding]
) -> None:
    """Refuse a program with errors, or whose numbers appear to be in other units.

    Broken workingsteps do not matter when others are selected by name.

    Raises
    ------
    SchemaError
        With the first reason.
    """
    if program.faults and len(chosen) == len(program.workingsteps):
        raise program.faults[0]
    require_any(chosen)
    if len(chosen) == len(program.workingsteps):
        for executable in program.executables:
            fault = _not_followed(program, executable)
            if fault is not None:
                raise fault
    require_one_channel(program)
    for finding in findings:
        if finding.severity is Severity.ERROR:
            raise error_of(finding)
    error = refusal(program, chosen)
    if error is not None:
        raise error


def require_one_channel(program: Program) -> None:
    """Refuse branches that run at the same time, which no code for one channel can say.

    Raises
    ------
    SchemaError
        With the option that chooses a branch.
    """
    for executable in program.executables:
        entity = program.model.entity(int(executable.ref))
        if isinstance(entity, Parallel) and len(entity.branches) > 1 and not executable.is_open:
            text = (
                "its branches run at the same time, which no code for one channel can say: "
                "`simulate` runs them one after another; --set "
                f'"{executable.ref}.branches=({entity.branches[0]})" chooses one'
            )
            raise program.error(text, executable.ref)


def require_any(chosen: Sequence[ResolvedWorkingstep]) -> None:
    """Refuse a program without a usable workingstep."""
    if not chosen:
        raise SchemaError("the program has no machining workingstep")


def refused_workingsteps(
    program: Program, chosen: Sequence[ResolvedWorkingstep]
) -> Iterator[RefusedWorkingstep]:
    """Workingsteps that cannot be advised, of those chosen, with the reason of each.

    Executables that could not be resolved are among them when nothing was selected by name.

    Yields
    ------
    RefusedWorkingstep
    """
    if len(chosen) == len(program.workingsteps):
        for executable in program.executables:
            if executable.is_open:
                continue
            fault = program.fault_of(executable.ref) or _not_followed(program, executable)
            if fault is not None:
                yield RefusedWorkingstep(
                    id=executable.id, ref=executable.ref, reason=str(fault)
                )
    for step in chosen:
        error = _refusal_of(program, step)
        if error is not None:
            yield RefusedWorkingstep(id=step.id, ref=step.ref, reason=str(error))


def _not_followed(program: Program, executable: ProgramLine) -> SchemaError | None:
    """Error about an executable that no run follows; None for one that can run."""
    is_faulty = program.fault_of(executable.ref) is not None
    if is_faulty or is_followed(program.model.entity(int(executable.ref))):
        return None
    return program.error(not_followed(executable.keyword), executable.ref)


def _refusal_of(program: Program, step: ResolvedWorkingstep) -> SchemaError | None:
    """Error in the instances that a workingstep uses, or in its numbers."""
    near = [step.ref, step.operation_ref, step.tool_ref, step.technology_ref, *step.features]
    if step.functions_ref is not None:
        near.append(step.functions_ref)
    fault = program.model.fault_near(*near)
    if fault is not None and fault.severity is Severity.ERROR:
        return error_of(fault)
    return refusal(program, (step,))
