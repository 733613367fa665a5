"""Reasons to refuse a program or single workingsteps before their feeds are optimised."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from optimiser.advice import RefusedWorkingstep
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.plausibility import refusal
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.remedy import error_of
from stepnc_model.writeback import WorkingstepUpdate


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
    program : Program
    chosen : sequence of ResolvedWorkingstep
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
    refused = tuple(refused_workingsteps(program, chosen))
    left_out = {int(each.ref) for each in refused}
    steps = tuple(step for step in chosen if int(step.ref) not in left_out)
    if not steps and refused:
        raise SchemaError(f"'{refused[0].id}': {refused[0].reason}")
    require_any(steps)
    return Advisable(steps=steps, refused=refused)


def apart_from(
    program: Program,
    changes: Sequence[WorkingstepUpdate],
    refused: Sequence[RefusedWorkingstep],
) -> list[WorkingstepUpdate]:
    """Updates of operations that no refused workingstep shares, which must stay as it is."""
    refs = {int(each.ref) for each in refused}
    kept = {int(step.operation_ref) for step in program.workingsteps if int(step.ref) in refs}
    return [each for each in changes if int(each.workingstep.operation_ref) not in kept]


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
    for finding in findings:
        if finding.severity is Severity.ERROR:
            raise error_of(finding)
    error = refusal(program, chosen)
    if error is not None:
        raise error


def require_any(chosen: Sequence[ResolvedWorkingstep]) -> None:
    """Refuse a program without a usable workingstep."""
    if not chosen:
        raise SchemaError("the program has no machining workingstep")


def refused_workingsteps(
    program: Program, chosen: Sequence[ResolvedWorkingstep]
) -> Iterator[RefusedWorkingstep]:
    """Workingsteps that cannot be advised, of those chosen, with the reason of each.

    Executables that could not be resolved are among them when nothing was selected by name.

    Parameters
    ----------
    program : Program
    chosen : sequence of ResolvedWorkingstep

    Yields
    ------
    RefusedWorkingstep
    """
    if len(chosen) == len(program.workingsteps):
        for executable in program.executables:
            fault = program.fault_of(executable.ref)
            if fault is not None:
                yield RefusedWorkingstep(
                    id=executable.id, ref=executable.ref, reason=str(fault)
                )
    for step in chosen:
        error = _refusal_of(program, step)
        if error is not None:
            yield RefusedWorkingstep(id=step.id, ref=step.ref, reason=str(error))


def _refusal_of(program: Program, step: ResolvedWorkingstep) -> SchemaError | None:
    """Error in the instances that a workingstep uses, or in its numbers."""
    near = [step.ref, step.operation_ref, step.tool_ref, step.technology_ref, *step.features]
    if step.functions_ref is not None:
        near.append(step.functions_ref)
    fault = program.model.fault_near(*near)
    if fault is not None and fault.severity is Severity.ERROR:
        return error_of(fault)
    return refusal(program, (step,))
