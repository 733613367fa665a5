"""Machining cycles of parts on machines, by runs of the virtual machine in memory.

A run is remembered by what determines it: the bytes of the program, its units and stock, the
values of machine and material, and the settings.
"""

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from hashlib import sha256

from extras.factory.model.cycle import PartCycle, cycle_of
from extras.factory.model.interpolation import CycleTable, SettingsDesign, cycle_table
from service.progress import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.run import machine_of
from service.simulation.setup import PreparedRun, prepared_program
from simulator.machine.interpreter import interpret
from simulator.spec import Machine, MachineKind, MaterialMatch, WorkMaterial
from stepnc_model.editing.cut_settings import CutSettings, with_settings
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.technology import ProgrammedQuantity, programmed
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.units import (
    UnitProfile,
    mm_min_from_speed,
    rpm_from_rev_s,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleKey:
    """Everything that determines a machining cycle."""

    program: bytes
    """Digest of the program's bytes."""
    units: UnitProfile
    stock: Stock | None
    machine: Machine
    material: WorkMaterial
    settings: CutSettings | None
    workingsteps: tuple[str, ...]


@dataclass(slots=True, kw_only=True)
class PartCycles:
    """Machining cycles that have been run. Running state."""

    tell: Tell = silent
    _known: dict[CycleKey, PartCycle] = field(default_factory=dict)

    def cycle(
        self,
        program: Program,
        machine: Machine,
        material: MaterialMatch,
        settings: CutSettings | None = None,
        workingsteps: tuple[str, ...] = (),
    ) -> PartCycle:
        """Cycle of :func:`part_cycle`, run once.

        Raises
        ------
        StepNcError
            When the machine cannot run the program.
        """
        key = CycleKey(
            program=sha256(program.file.data).digest(),
            units=program.units,
            stock=program.stock,
            machine=machine,
            material=material.material,
            settings=settings,
            workingsteps=workingsteps,
        )
        if key not in self._known:
            self._known[key] = part_cycle(
                program,
                machine,
                material,
                settings=settings,
                workingsteps=workingsteps,
                tell=self.tell,
            )
        return self._known[key]

    def table(
        self,
        program: Program,
        machine: Machine,
        material: MaterialMatch,
        design: SettingsDesign,
        workingsteps: tuple[str, ...] = (),
    ) -> CycleTable:
        """Cycles of a program as a function of its settings, interpolated.

        Raises
        ------
        StepNcError
            When the machine cannot run the program with settings of the design, or the cycles
            cannot be interpolated.
        """

        def layers(depth: float) -> Hashable:
            told = with_settings(program, CutSettings(depth=depth), workingsteps)
            paths = (item for item in generate(told) if isinstance(item, ToolPath))
            return tuple(len(path.steps) for path in paths)

        def run(settings: CutSettings) -> PartCycle:
            return self.cycle(program, machine, material, settings, workingsteps)

        return cycle_table(design, run, layers)


def part_cycle(  # noqa: PLR0913 (each is a choice of the caller)
    program: Program,
    machine: Machine,
    material: MaterialMatch,
    *,
    settings: CutSettings | None = None,
    workingsteps: tuple[str, ...] = (),
    flank_wear: float = 0.0,
    tell: Tell = silent,
) -> PartCycle:
    """Run a program on the virtual machine and return its machining cycle.

    The run is that of ``stepnc simulate`` without options: wear does not grow, and there is no
    noise or deviation.

    Parameters
    ----------
    settings : CutSettings, optional
        Feed, spindle speed and depth instead of the program's own.
    workingsteps : tuple of str
        Ids of the workingsteps that get them; none: all that mill or turn.
    flank_wear : float, mm
        Flank wear of each tool.
    tell : callable
        Receives progress, and what the run found: a cut that is not modelled, a collision.

    Raises
    ------
    StepNcError
        When the machine cannot run the program; with program, machine, workingstep and bound.
    """
    where = place_text(program, machine)
    try:
        told = program if settings is None else with_settings(program, settings, workingsteps)
        for step in told.workingsteps:
            _require_possible(told, step, machine)
        prepared = prepared_program(told, machine, material, tell=tell)
        virtual = machine_of(SimulationRequest(), _worn(prepared, flank_wear))
    except StepNcError as error:
        raise StepNcError(f"{where}: {error}") from error
    try:
        cycle = cycle_of(virtual.run(interpret(prepared.blocks, machine)), machine)
    except StepNcError as error:
        at = "".join(f": workingstep '{name}'" for name in virtual.workingsteps[-1:])
        raise StepNcError(f"{where}{at}: {error}") from error
    if cycle.time <= 0.0:
        raise StepNcError(f"{where}: the program contains nothing that takes time")
    for finding in (*prepared.findings, *virtual.findings):
        tell(f"{where}: {finding.message}")
    return cycle


def _worn(prepared: PreparedRun, flank_wear: float) -> PreparedRun:
    """Run whose tools are worn when the program starts."""
    tools = {
        number: replace(tool, flank_wear=flank_wear)
        for number, tool in (prepared.tools or {}).items()
    }
    return replace(prepared, tools=tools) if prepared.tools is not None else prepared


def place_text(program: Program, machine: Machine) -> str:
    """Program and machine, for messages."""
    return f"{program.name} on machine '{machine.name}'"


def _require_possible(program: Program, step: ResolvedWorkingstep, machine: Machine) -> None:
    """Refuse a workingstep for another kind of machine, or beyond its speeds."""
    is_turning = isinstance(step.operation, TurningMachiningOperation)
    if is_turning is not (machine.kind is MachineKind.LATHE):
        work = "turning" if is_turning else "milling or drilling"
        text = f"{work}, but the machine is a {machine.kind.value}"
        raise StepNcError(f"workingstep '{step.id}': {text}")
    told = programmed(program, step.technology_ref)
    tool = tool_of(program, step.tool_ref)
    if told.speed.quantity is ProgrammedQuantity.CUTTING_SPEED and tool.diameter <= 0.0:
        return
    speed = told.spindle_speed(tool.diameter)
    slowest, fastest = machine.spindle.min_speed, machine.spindle.max_speed
    shown = f"workingstep '{step.id}': spindle speed {rpm_from_rev_s(speed):g} rpm"
    if fastest is not None and speed > fastest * (1.0 + ROUNDING):
        raise StepNcError(f"{shown} exceeds {rpm_from_rev_s(fastest):g} rpm")
    if slowest is not None and speed < slowest * (1.0 - ROUNDING):
        raise StepNcError(f"{shown} is below {rpm_from_rev_s(slowest):g} rpm")
    feed = told.feed_per_tooth(speed, tool.teeth) * tool.teeth * speed
    most = machine.max_feed
    if most is not None and feed > most * (1.0 + ROUNDING):
        raise StepNcError(
            f"workingstep '{step.id}': feed {mm_min_from_speed(feed):g} mm/min exceeds "
            f"{mm_min_from_speed(most):g} mm/min"
        )


ROUNDING = 1e-9
"""Share by which a number of a file may exceed a bound because of rounding."""
