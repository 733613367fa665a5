"""Cycles of all programs of a shop on their machines, run before the shop is."""

from pathlib import Path

from extras.factory.cycles import PartCycles
from extras.factory.model.interpolation import CycleTable
from extras.factory.model.machining import MachiningPlan, Place, ProgramCycle
from extras.factory.model.shop import Shop, ShopMachine
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from simulator.spec import Machine
from stepnc_model.editing.cut_settings import common_settings
from stepnc_model.errors import StepNcError


def machining_plan(shop: Shop, cycles: PartCycles, *, place: str) -> MachiningPlan:
    """Run each program of a shop once on each kind of machine of its step.

    Parameters
    ----------
    cycles : PartCycles
        Cycles that were run before.
    place : str
        Name of the shop file, for messages.

    Raises
    ------
    StepNcError
        With the key of the step whose program cannot be read, or not be made by a machine.
    """
    found: dict[Place, ProgramCycle] = {}
    tables: dict[Place, CycleTable] = {}
    materials = {row: each.material for row, each in enumerate(shop.products)}
    rows = {machine.name: row for row, machine in enumerate(shop.machines)}
    for number, product in enumerate(shop.products):
        for at, step in enumerate(product.steps):
            if not step.program:
                continue
            key = f"{place}: product[{number + 1}].step[{at + 1}].program"
            try:
                program = read_program(Path(step.program), units="iso")
                material = material_for(product.material, program)
                materials[number] = product.material or material.material.title
                for name in step.machines:
                    machine = _machine(shop.machines[rows[name]])
                    where = (number, at, rows[name])
                    if step.design is None:
                        found[where] = ProgramCycle(
                            cycle=cycles.cycle(program, machine, material),
                            settings=common_settings(program),
                        )
                    else:
                        tables[where] = cycles.table(program, machine, material, step.design)
            except StepNcError as error:
                raise StepNcError(f"{key}: {error}") from error
    return MachiningPlan(cycles=found, tables=tables, materials=materials)


def _machine(spec: ShopMachine) -> Machine:
    """Machine of the library that runs programs in the shop."""
    if spec.machine is None:
        raise StepNcError(
            f"machine '{spec.name}' has only times: name its machine of the library, or give "
            "the step a time_s instead of a program"
        )
    return spec.machine
