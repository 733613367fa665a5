"""Work-holding of each workingstep, and notes on the loads of setups without work-holding."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from optimiser.advice import Advice
from optimiser.bounds.holding import HoldingLoad
from optimiser.bounds.tolerance import permitted_bar_deflection
from optimiser.cuts.conditions import BarGrip, CuttingConditions, grip_of, holding_of, setup_id
from simulator.spec import (
    Machine,
    MachineKind,
)
from simulator.work_holding import (
    Chuck,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.turning import Contouring, Grooving
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.units import nm_from_nmm


def with_holding(
    at: CuttingConditions, program: Program, step: ResolvedWorkingstep
) -> tuple[CuttingConditions, list[Finding]]:
    """Add the work-holding and the permitted bar deflection to the cutting conditions.

    Raises
    ------
    LibraryError
        When neither the chuck's table nor the program states where the chuck grips.
    """
    machine = at.machine
    if machine.only_stated_limits:
        return at, []
    holding = holding_of(program, step.setup, machine)
    if machine.kind is not MachineKind.LATHE:
        return replace(at, holding=holding), []
    chuck = holding if isinstance(holding, Chuck) else None
    at = replace(at, holding=chuck, grip=grip_of(program, step, chuck))
    if chuck is None or not isinstance(step.operation, (Contouring, Grooving)):
        return at, []
    deflection, findings = permitted_bar_deflection(program, step)
    return replace(at, bar_deflection=deflection), findings


def holding_findings(
    program: Program, advices: Sequence[Advice], machine: Machine
) -> list[Finding]:
    """Notes on setups without work-holding, and warnings on tables for unknown setups."""
    found = list(_unknown_setups(program, machine))
    if machine.only_stated_limits:
        return found
    by_setup: dict[Ref[Entity] | None, list[Advice]] = {}
    for advice in advices:
        if advice.holding_load is not None:
            by_setup.setdefault(advice.workingstep.setup, []).append(advice)
    for setup, held in by_setup.items():
        if holding_of(program, held[0].workingstep.setup, machine) is None:
            of = f"'{setup_id(program, held[0].workingstep.setup)}'" if setup else "the program"
            text = f"no [[holding]] table for {of}: {_greatest_loads(program, held)}"
            ref = setup if setup is not None else held[0].workingstep.ref
            found.append(program.finding(Severity.NOTE, text, ref))
    return found


def _unknown_setups(program: Program, machine: Machine) -> Iterator[Finding]:
    """Warn about work-holding tables that name a setup which the program does not have."""
    setups = {step.setup: None for step in program.workingsteps if step.setup is not None}
    known = [setup_id(program, setup) for setup in setups]
    for holding in machine.holdings:
        if holding.setup and holding.setup.casefold() not in map(str.casefold, known):
            names = ", ".join(f"'{name}'" for name in known) or "none"
            text = f"work-holding of unknown setup '{holding.setup}'; the program has: {names}"
            yield Finding(severity=Severity.WARNING, message=text)


def _greatest_loads(program: Program, held: Sequence[Advice]) -> str:
    """Describe the greatest work-holding loads of a setup and their workingsteps."""
    first = held[0]
    if first.cut is None or not first.cut.kind.is_turned:
        across = _greatest(held, lambda load: load.force, "N across the spindle")
        lift = _greatest(held, lambda load: load.lift, "N upwards")
        return f"the vice or clamps must hold {across}{lift and ' and ' + lift}"
    torque = _greatest(held, lambda load: nm_from_nmm(load.torque), "N·m about the axis")
    moment = _greatest(
        held, lambda load: nm_from_nmm(load.moment), "N·m of tilting about the jaws"
    )
    grip = grip_of(program, first.workingstep, None)
    return (
        f"the chuck must hold {torque}{moment and ' and ' + moment}"
        f"{'' if grip is None else '; ' + _jaw_position(grip)}"
    )


def _greatest(held: Sequence[Advice], of: Callable[[HoldingLoad], float], unit: str) -> str:
    """Describe the greatest value of one work-holding load; empty when it is zero."""
    loads = [
        (of(advice.holding_load), advice.workingstep.id)
        for advice in held
        if advice.holding_load is not None
    ]
    value, name = max(loads)
    return f"{value:.4g} {unit} ({name})" if value > 0.0 else ""


def _jaw_position(grip: BarGrip) -> str:
    """Describe the position of the chuck's jaws as stated by the program."""
    centre = ", with a tailstock" if grip.has_tailstock else ""
    return (
        f"by the program it grips {grip.size.length:.4g} mm on Ø{grip.size.diameter:.4g} mm, "
        f"overhang {grip.overhang:.4g} mm (L/D {grip.slenderness:.2g}){centre}"
    )
