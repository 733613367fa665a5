"""The one public verb: advice for every workingstep of a program.

Same inputs, same result: corrections of the cutting force come as an argument.
"""

from collections.abc import Callable
from dataclasses import replace
from math import isfinite

from optimiser import workingstep as exact
from optimiser.advice import Advice, Load, Plan, State, Status
from optimiser.cut import Cut, CutKind
from optimiser.errors import Infeasible, OptimisationError
from optimiser.estimate import milling_cut
from optimiser.estimate_hole import hole_cut, is_hole_making
from optimiser.estimate_turning import mean_diameter, turning_cut
from optimiser.formulate import Task, problem_of, state_of
from optimiser.front import front_of
from optimiser.limit import Limit, LimitName
from optimiser.limits import Conditions, roughness_load
from optimiser.modes import Mode
from optimiser.problem import Problem
from optimiser.requirement import required_roughness
from simulator.edge_material import edge_material
from simulator.errors import LibraryError
from simulator.library import find_grade
from simulator.spec import CuttingMaterial, Grade, Machine, MachineKind, MaterialMatch
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, Workingstep
from stepnc_model.technology import Programmed, programmed
from stepnc_model.tool import Tool, tool_of

DEFAULT_QUALITY = 3.2e-3
"""mm, Ra that QC keeps where neither user nor file asks for one: ISO 1302 general machining"""


def optimise(
    program: Program,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: Task,
    selected: Callable[[Workingstep], bool] = lambda _: True,
    progress: Callable[[], None] = lambda: None,
) -> Plan:
    """Advise every selected workingstep of a program.

    Parameters
    ----------
    program : Program
    machine : Machine
    material : MaterialMatch
    task : Task
    selected : callable
        Which workingsteps are wanted.
    progress : callable
        Called after each of them.

    Returns
    -------
    Plan

    Raises
    ------
    SchemaError
        When a selected workingstep lacks what a cut needs.
    """
    findings: list[Finding] = []
    advices = []
    for step in program.workingsteps:
        if not selected(step):
            continue
        advice, found = advise(program, step, machine=machine, material=material, task=task)
        advices.append(advice)
        progress()
        findings += found
    return Plan(
        program=program.name,
        mode=task.mode,
        machine=machine,
        material=material,
        advices=tuple(advices),
        findings=tuple(findings),
    )


def advise(
    program: Program,
    step: Workingstep,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: Task,
) -> tuple[Advice, list[Finding]]:
    """Advice for one workingstep, with what was assumed on the way."""
    with program.using(step.operation_ref):
        return _advise(program, step, machine=machine, material=material, task=task)


def _advise(
    program: Program,
    step: Workingstep,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: Task,
) -> tuple[Advice, list[Finding]]:
    """Advise one workingstep; whoever calls it names the place of what goes wrong."""
    tool = tool_of(program, step.tool_ref)
    conditions = programmed(program, step.technology_ref)
    untouched = Advice(
        workingstep=step,
        tool=tool,
        programmed=conditions,
        status=Status.UNTOUCHED,
        reason=conditions.inhibition,
        cut=None,
        before=None,
        after=None,
    )
    if conditions.is_synchronised or not _is_cut_with_feed(step):
        reason = "the feed is bound to the pitch of the thread"
        return replace(untouched, reason=reason), []
    cut, findings = _cut(program, step, tool, conditions)
    at, found = _conditions(program, step, cut, machine=machine, material=material, task=task)
    findings += found
    problem = problem_of(cut, at, task)
    before = state_of(cut, problem, at, problem.programmed)
    if not isfinite(before.time) or not isfinite(before.energy):
        raise ValueError(f"a time of {before.time:g} s: its numbers are beyond all machines")
    untouched = replace(untouched, cut=cut, before=before, after=before)
    advice = untouched
    if conditions.inhibition:
        reason = f"{conditions.inhibition}: nobody may touch this feed"
        advice = replace(untouched, reason=reason)
    else:
        try:
            advice = _solved(untouched, cut, problem, at, task)
        except Infeasible as conflict:
            reason = str(conflict)
            advice = replace(untouched, status=Status.INFEASIBLE, reason=reason, after=None)
        except OptimisationError as error:
            raise OptimisationError(f"{program.label(step.operation_ref)}: {error}") from error
    return advice, findings + _passed_limits(program, advice)


def _solved(
    untouched: Advice, cut: Cut, problem: Problem, at: Conditions, task: Task
) -> Advice:
    """Advice from the exact solution, or the geometric program when tools wear out."""
    prices: tuple[tuple[LimitName, float], ...] = ()
    if task.tool_change > 0.0:
        from optimiser import program as general  # noqa: PLC0415 (cvxpy takes a second)

        optimum = general.solve(problem, task.mode)
        prices = tuple((name, price) for name, price in optimum.prices.items())
        solution = exact.settled(problem, general.snapped(problem, optimum))
    else:
        solution = exact.solve(problem, task.mode)
    after = state_of(cut, problem, at, solution.setting)
    saving = 0.0
    if task.tool_change == 0.0:
        saving = exact.saving_of_one_more(problem, task.mode, solution)
    return replace(
        untouched,
        status=Status.ADVISED,
        reason=reason_of(after, solution.holding),
        after=after,
        active=solution.active,
        active_words=solution.holding.words,
        saving_of_one_more=saving,
        deepest_first_time=solution.deepest_first_time,
        prices=prices,
        front=front_of(problem, cut, at) if task.front else (),
    )


def reason_of(state: State, limit: Limit) -> str:
    """Sentence that names the limit that holds the feed."""
    load = next(load for load in state.loads if load.limit is limit)
    return (
        f"{limit.words} {load.value * limit.scale:.4g} {limit.unit} reaches its bound of "
        f"{load.bound * limit.scale:.4g} {limit.unit}"
    )


def _is_cut_with_feed(step: Workingstep) -> bool:
    """Whether the feed may be chosen at all: a thread's feed is its pitch."""
    return not any(word in step.operation_type for word in ("tapping", "thread"))


def _cut(
    program: Program, step: Workingstep, tool: Tool, conditions: Programmed
) -> tuple[Cut, list[Finding]]:
    """The cut of a workingstep, by the kind of its operation."""
    findings: list[Finding] = []
    operation = step.operation
    is_turning = isinstance(operation, TurningMachiningOperation)
    diameter = mean_diameter(program, step) if is_turning else tool.diameter
    if diameter <= 0.0:
        raise program.error("cuts at the axis: no cutting speed there", step.operation_ref)
    speed = conditions.spindle_speed(diameter)
    feed = conditions.feed_per_tooth(speed, tool.teeth)
    if not is_turning and not tool.has_teeth:
        text = "number_of_teeth is not given: one tooth assumed"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    if conditions.has_both_speeds:
        text = "cutspeed and spindle are both given (ISO 14649-11 WR1): the spindle counts"
        findings.append(
            program.finding(Severity.WARNING, text, step.technology_ref, "cutspeed")
        )
    make = milling_cut
    if is_turning:
        make = turning_cut
    elif is_hole_making(operation, tool):
        make = hole_cut
    cut, found = make(program, step, tool, speed=speed, feed=feed)
    return cut, findings + list(found)


def _conditions(
    program: Program,
    step: Workingstep,
    cut: Cut,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: Task,
) -> tuple[Conditions, list[Finding]]:
    """Grade, cutting material and roughness of a cut."""
    findings: list[Finding] = []
    cutting_material = edge_material(cut.tool.edge_material)
    if cutting_material is None:
        cutting_material = CuttingMaterial.CARBIDE
        text = f"tool '{cut.tool.id}' names no cutting material: carbide assumed"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    work = material.material
    grade: Grade | None = None
    if work.iso_group:
        try:
            grade = find_grade(cut.tool_kind, cutting_material, work.iso_group)
        except LibraryError as error:
            findings.append(program.finding(Severity.WARNING, str(error), step.tool_ref))
    is_turned = cut.kind in {CutKind.TURNING, CutKind.GROOVING}
    if is_turned is not (machine.kind is MachineKind.LATHE):
        text = f"{step.operation_type} on machine '{machine.name}', a {machine.kind.value}"
        findings.append(program.finding(Severity.WARNING, text, step.operation_ref))
    asked = _roughness(program, step, cut, task, findings)
    return (
        Conditions(
            machine=machine,
            material=work,
            cutting_material=cutting_material,
            grade=grade,
            roughness=asked,
            force_factor=task.force_factor,
        ),
        findings,
    )


def _roughness(
    program: Program, step: Workingstep, cut: Cut, task: Task, findings: list[Finding]
) -> float | None:
    """Ra in mm that this workingstep must keep: asked for, in the file, or QC's default."""
    if not cut.is_finishing:
        return None
    drawn = required_roughness(program, step)
    asked = task.roughness or drawn
    if asked is not None and drawn is not None and asked > drawn:
        text = (
            f"Ra {asked * 1e3:g} µm as asked for is coarser than "
            f"Ra {drawn * 1e3:g} µm in the file"
        )
        findings.append(program.finding(Severity.WARNING, text, step.operation_ref))
    if asked is None and task.mode is Mode.QC:
        asked = DEFAULT_QUALITY
        text = f"no roughness is asked for: QC keeps Ra {DEFAULT_QUALITY * 1e3:g} µm"
        findings.append(program.finding(Severity.NOTE, text, step.operation_ref))
    if asked is not None and roughness_load(cut) is None:
        text = (
            f"Ra {asked * 1e3:g} µm is asked for, but the feed does not describe this surface"
        )
        findings.append(program.finding(Severity.NOTE, text, step.operation_ref))
    return asked


def _passed_limits(program: Program, advice: Advice) -> list[Finding]:
    """Limits that the programmed setting passes, and the advised one too: a held speed's."""
    if advice.before is None:
        return []
    still = set()
    if advice.status is Status.ADVISED and advice.after is not None:
        still = {
            load.limit.name for load in advice.after.loads if _is_passed(load, advice.after)
        }
    found = {}
    for load in advice.before.loads:
        if _is_passed(load, advice.before):
            name = load.limit.name
            when = "as programmed and as advised" if name in still else "as programmed"
            text = f"{when}: {exact.told(load.limit, load.value, advice.before.setting.speed)}"
            ref = advice.workingstep.technology_ref
            found[name] = program.finding(Severity.WARNING, text, ref)
    return list(found.values())


def _is_passed(load: Load, state: State) -> bool:
    at = state.setting
    return not load.limit.holds(at.feed, at.depth, at.speed)
