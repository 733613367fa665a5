"""Timelines of parts: what the axes of a machine do while it machines a program.

A timeline is a run of the virtual machine with the settings as programmed, without deviation.
Parts whose settings are drawn have none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from service.chosen import material_for
from service.factory.cycles import place_text
from service.reading import Tell, read_program, silent
from service.requests.runs import SimulationRequest
from service.simulation.run import machine_of
from service.simulation.setup import prepared_program
from simulator.factory.machining import MachiningPlan, Place
from simulator.factory.shop import Shop
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Samples, joined
from simulator.machine.sensing import Sampler
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import StepNcError
from stepnc_model.program import Program

FASTEST = 10.0
"""Highest rate of a timeline, in samples per simulated second."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartTimeline:
    """Samples of the machining of a part."""

    samples: Samples
    workingsteps: Sequence[str]


def part_timelines(
    shop: Shop, plan: MachiningPlan, *, rate: float, tell: Tell
) -> Mapping[Place, PartTimeline]:
    """Run each program of a shop with fixed settings once on each kind of machine.

    Parameters
    ----------
    shop : Shop
    plan : MachiningPlan
    rate : float, 1/s
        Samples per simulated second, at most :data:`FASTEST`.
    tell : callable

    Raises
    ------
    StepNcError
        When a program cannot be read or run.
    """
    known: dict[tuple[str, str, str], PartTimeline] = {}
    found: dict[Place, PartTimeline] = {}
    for place in plan.cycles:
        product, step, row = place
        spec = shop.machines[row].machine
        if spec is None:
            continue
        path = shop.products[product].steps[step].program
        key = (path, shop.products[product].material, spec.name)
        if key not in known:
            tell(f"timeline of {Path(path).name} on {spec.name}")
            program = read_program(Path(path), units="iso")
            material = material_for(shop.products[product].material, program)
            known[key] = part_timeline(program, spec, material, rate=min(rate, FASTEST))
        found[place] = known[key]
    return found


def part_timeline(
    program: Program, machine: Machine, material: MaterialMatch, *, rate: float
) -> PartTimeline:
    """Run a program with its own settings and return its samples.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    prepared = prepared_program(program, machine, material, tell=silent)
    virtual = machine_of(SimulationRequest(), prepared)
    sampler = Sampler(machine, rate=rate)
    try:
        parts = [
            samples
            for episode in virtual.run(interpret(prepared.blocks, machine))
            for samples in sampler.samples(episode)
        ]
    except StepNcError as error:
        raise StepNcError(f"{place_text(program, machine)}: {error}") from error
    return PartTimeline(samples=joined(parts), workingsteps=tuple(virtual.workingsteps))
