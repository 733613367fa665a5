"""Setup of a controlled run: nominal course of the program, its plan and its workingsteps."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from controller.reference import Reference, reference_of
from controller.signals.preview import Preview
from controller.states.loop_settings import LoopStep
from optimiser.advice import Advice, Plan
from optimiser.cuts.cut import CutKind
from optimiser.cuts.source import from_features
from optimiser.modes import Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.safety import LEAST_QUANTILE
from service.control.expected_results import PlannedWorkingstep
from service.control.loads import ReferenceLoad
from service.knowledge.plan_corrections import factors_for
from service.programs.machine_choice import library_material
from service.progress import Tell, Ticker, bar
from service.simulation.run import place_in
from service.simulation.run_collector import require_sense
from service.simulation.setup import PreparedRun
from simulator.errors import ProgramFault, SimulationError
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode
from simulator.machine.virtual import VirtualMachine
from simulator.plant.course import NominalCourse, course_of
from simulator.plant.hidden_behaviour import HiddenQuantity, HiddenTruth
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import ProgrammedQuantity, programmed
from stepnc_model.units import mm_min_from_speed

MOST_SECONDS = 86_400.0
"""Longest program under control, in s; its course takes 10 MB of memory per 1000 s."""

CHIP = 0.1
"""Chip thickness at which materials are compared, in mm."""


def planned_course(prepared: PreparedRun, virtual: VirtualMachine, tell: Tell) -> NominalCourse:
    """Compute the course of the program at an override of 1."""
    ticker = Ticker(tell)

    def episodes() -> Iterator[Episode]:
        for episode in virtual.run(interpret(prepared.blocks, virtual.machine)):
            require_sense(episode)
            if episode.end > MOST_SECONDS:
                raise _too_long(prepared, virtual, episode)
            ticker(lambda: f"{bar(prepared.done())}  planning the run")
            yield episode

    try:
        return course_of(episodes(), virtual.machine)
    except SimulationError as error:
        raise SimulationError(f"{place_in(prepared, virtual)}: {error}") from error


def _too_long(prepared: PreparedRun, virtual: VirtualMachine, episode: Episode) -> StepNcError:
    """Error that names the workingstep at which a program becomes too long, and its feed."""
    text = (
        f"{episode.end:.3g} s of machining exceeds {MOST_SECONDS:g} s, the limit under control"
    )
    program = prepared.program
    at = virtual.workingsteps[-1] if virtual.workingsteps else ""
    steps = () if program is None else program.workingsteps
    step = next((each for each in steps if each.id == at), None)
    if program is None or step is None:
        return ProgramFault(text, episode.state.line)
    feed = programmed(program, step.technology_ref).feed
    if feed.quantity is ProgrammedQuantity.FEED:
        text += f": the feed of '{step.id}' is {mm_min_from_speed(feed.value):.3g} mm/min"
    return program.error(text, feed.ref, feed.attribute)


def require_teeth(hidden: HiddenTruth, course: NominalCourse) -> None:
    """Refuse a tooth number that no cutter of the program has.

    Raises
    ------
    StepNcError
        With the largest number of teeth in the program.
    """
    most = int(course.teeth.max())
    for change in hidden.changes:
        if change.what is HiddenQuantity.TOOTH and change.value >= most:
            text = f"tooth {change.value + 1.0:g}: the cutters have at most {most} teeth"
            raise StepNcError(f"disturbance: {text}")


def preview_of(course: NominalCourse) -> Preview:
    """Preview of the program: expected forces where the override acts, zero elsewhere."""
    force = np.where(course.can_override, course.force, np.float32(0.0))
    return Preview(
        until=course.until,
        force=force,
        peak=course.peak,
        wall=course.wall,
        workingstep=course.workingstep,
        land_force=course.land_force,
        arcs=course.arcs,
    )


def hardness_against(match: MaterialMatch) -> Callable[[str], float]:
    """Return the ratio of another material's k_c to that of the workpiece, at a 0.1 mm chip."""
    cut = match.material.kienzle

    def ratio(name: str) -> float:
        other = library_material(name).material.kienzle
        return float(other.k_c11 / cut.k_c11 * CHIP ** (cut.m_c - other.m_c))

    return ratio


def plan_as_it_is(
    program: Program,
    machine: Machine,
    *,
    material: MaterialMatch,
    mode: Mode,
    knowledge: str | None,
    left_out: frozenset[int] | None = None,
) -> Plan:
    """Plan of the unchanged program, corrected by a knowledge base unless that is None.

    Parameters
    ----------
    knowledge : str or None
        Location of the knowledge base; empty: the usual one; None: none.
    left_out : frozenset of int, optional
        Instances of workingsteps that are not run. Where some are, another that cannot be
        planned keeps its feed; None: all are run.
    """
    factors = (
        ()
        if knowledge is None
        else factors_for(
            knowledge,
            program,
            program.workingsteps,
            machine=machine,
            material=material,
            safety=LEAST_QUANTILE,
            is_new_allowed=True,
        )
    )
    task = OptimisationTask(
        mode=mode,
        free=frozenset(),
        force_factors={each.tool: each.factor for each in factors},
        safety=LEAST_QUANTILE,
        source=from_features,
        keep_going=left_out is not None,
    )
    without = left_out or frozenset()
    return optimise_program(
        program,
        machine=machine,
        material=material,
        task=task,
        selected=lambda step: int(step.ref) not in without,
    )


def advices_in_order(
    names: Sequence[str], advices: Sequence[Advice]
) -> tuple[Advice | None, ...]:
    """Advice of each workingstep that is run; those with the same id follow in their order.

    Parameters
    ----------
    names : sequence of str
        Ids of the workingsteps in the order of the run.
    advices : sequence of Advice
        Advices in the order of the program.
    """
    waiting: dict[str, deque[Advice]] = {}
    for each in advices:
        waiting.setdefault(each.workingstep.id, deque()).append(each)
    found: list[Advice | None] = []
    for name in names:
        queue = waiting.get(name)
        # The last one also stands for what is run again.
        found.append(None if not queue else queue.popleft() if len(queue) > 1 else queue[0])
    return tuple(found)


def steps_of(
    planned: Mapping[int, PlannedWorkingstep],
    advices: Sequence[Advice | None],
    taught: Sequence[ReferenceLoad | None] = (),
) -> list[LoopStep]:
    """Return the loop's steps, with what is planned and what sharp tools have taught."""
    steps = [
        _step(planned.get(number, PlannedWorkingstep()), advice)
        for number, advice in enumerate(advices, 1)
    ]
    if not taught:
        return steps
    return [
        step if load is None else replace(step, taught=load.kc_factor)
        for step, load in zip(steps, taught, strict=True)
    ]


def _step(planned: PlannedWorkingstep, advice: Advice | None) -> LoopStep:
    if advice is None:
        inhibition = "the program states no limits"
        return LoopStep(reference=Reference(workingstep="", inhibition=inhibition))
    return LoopStep(
        reference=_reference(planned, advice),
        tool=advice.tool.id,
        exponent=planned.exponent,
        diameter=planned.diameter,
    )


def _reference(planned: PlannedWorkingstep, advice: Advice) -> Reference:
    """Force reference of a workingstep, scaled to the force that is measured.

    The plan states the force of one lip of a drill at its rim; the measured force is the torque
    of all lips over the radius at the middle of the lips.
    """
    reference, cut = reference_of(advice), advice.cut
    if cut is None or cut.kind is not CutKind.DRILLING or not planned.diameter:
        return reference
    return reference.scaled(cut.diameter / planned.diameter)
