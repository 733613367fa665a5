"""Cycles of all programs of a shop on their machines, run before the shop is."""

from pathlib import Path

from service.chosen import material_for
from service.factory.cycles import PartCycles
from service.reading import read_program
from simulator.factory.machining import MachiningPlan, Place, ProgramCycle
from simulator.factory.shop import Product, RouteStep, Shop
from stepnc_model.cut_settings import CutSettings
from stepnc_model.errors import StepNcError
from stepnc_model.program import Program


def machining_plan(shop: Shop, cycles: PartCycles, *, place: str) -> MachiningPlan:
    """Run each program of a shop once on each kind of machine of its step.

    Parameters
    ----------
    shop : Shop
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
    rows = {machine.name: row for row, machine in enumerate(shop.machines)}
    for number, product in enumerate(shop.products):
        for at, step in enumerate(product.steps):
            if not step.program:
                continue
            key = f"{place}: product[{number + 1}].step[{at + 1}].program"
            try:
                program = read_program(Path(step.program), units="iso")
                for name in step.machines:
                    cycle = _cycle(shop, product, step, program, rows[name], cycles)
                    found[number, at, rows[name]] = cycle
            except StepNcError as error:
                raise StepNcError(f"{key}: {error}") from error
    return MachiningPlan(cycles=found)


def materials_of(shop: Shop) -> dict[int, str]:
    """Names of the work materials of the products, for tables."""
    return {row: product.material or "" for row, product in enumerate(shop.products)}


def _cycle(  # noqa: PLR0913, PLR0917 (one place of the plan)
    shop: Shop,
    product: Product,
    step: RouteStep,
    program: Program,
    row: int,
    cycles: PartCycles,
) -> ProgramCycle:
    machine = shop.machines[row].machine
    if machine is None:
        raise StepNcError(
            f"machine '{shop.machines[row].name}' has only times: name its machine of the "
            "library, or give the step a time_s instead of a program"
        )
    material = material_for(product.material, program)
    return ProgramCycle(cycle=cycles.cycle(program, machine, material), settings=CutSettings())
