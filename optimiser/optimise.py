"""The one public verb: advice for every workingstep of a program.

Same inputs, same result: corrections of the cutting force come as an argument.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi

from optimiser import workingstep as exact
from optimiser.advice import Advice, Load, Plan, State, Status
from optimiser.cut import Cut, CutKind
from optimiser.errors import Infeasible, OptimisationError
from optimiser.estimate import milling_cut
from optimiser.estimate_hole import hole_cut
from optimiser.estimate_turning import mean_diameter, turning_cut
from optimiser.limit import Limit, LimitName, Monomial, Sense
from optimiser.limits import (
    Conditions,
    force_load,
    limits_of,
    power_load,
    roughness_load,
    segment_at,
    speed_range,
    spindle_limits,
)
from optimiser.modes import Free, Mode
from optimiser.problem import Cost, Problem, Setting
from optimiser.requirement import required_roughness
from simulator.errors import LibraryError
from simulator.library import find_grade, find_window
from simulator.physics.spindle import curve_segments
from simulator.physics.tool_life import tool_life
from simulator.spec import CuttingMaterial, Grade, Machine, MachineKind, MaterialMatch
from stepnc_model.entities.drilling import DrillingTypeOperation
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, Workingstep
from stepnc_model.technology import Programmed, programmed
from stepnc_model.tool import Tool, tool_of

LEAST_DEPTH = 0.05
"""mm, no pass is planned shallower"""

DEFAULT_QUALITY = 3.2e-3
"""mm, Ra that QC keeps where neither user nor file asks for one: ISO 1302 general machining"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What is asked of the optimiser."""

    mode: Mode = Mode.TC
    free: frozenset[Free] = frozenset({Free.FEED, Free.DEPTH})
    roughness: float | None = None
    """Ra in mm for all finished surfaces, instead of what the file says"""
    tool_change: float = 0.0
    """s to change a worn tool; 0: tool life does not count"""
    force_factor: float = 1.0
    """accepted correction of k_c"""
    front: bool = False
    """whether the front between time, roughness and energy is wanted"""


def optimise(
    program: Program,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: Task,
    selected: Callable[[Workingstep], bool] = lambda _: True,
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
    problem = _problem(cut, at, task)
    before = state_of(cut, problem, at, problem.programmed)
    untouched = replace(untouched, cut=cut, before=before, after=before)
    findings += _programmed_findings(program, step, before)
    if conditions.inhibition:
        reason = f"{conditions.inhibition}: nobody may touch this feed"
        return replace(untouched, reason=reason), findings
    try:
        return _solved(untouched, cut, problem, at, task), findings
    except Infeasible as conflict:
        return (
            replace(untouched, status=Status.INFEASIBLE, reason=str(conflict), after=None),
            findings,
        )
    except OptimisationError as error:
        raise OptimisationError(f"{program.label(step.operation_ref)}: {error}") from error


def state_of(cut: Cut, problem: Problem, at: Conditions, setting: Setting) -> State:
    """Everything about a cut at one setting."""
    point = (setting.feed, setting.depth, setting.speed)
    roughness = roughness_load(cut)
    return State(
        setting=setting,
        feed=setting.feed * cut.tool.teeth * setting.speed,
        time=problem.cost.time(setting),
        energy=problem.cost.energy(setting),
        motor_power=power_load(cut, at).value(*point),
        cutting_force=force_load(cut, at).value(*point),
        roughness=roughness.value(*point) if roughness is not None else None,
        loads=tuple(
            Load(
                limit=limit,
                value=limit.load.value(*point),
                bound=limit.bound_at(setting.speed),
            )
            for limit in exact.limits_at(problem, setting.speed)
        ),
    )


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
        reason=reason_of(after, solution.active),
        after=after,
        active=solution.active,
        saving_of_one_more=saving,
        deepest_first_time=solution.deepest_first_time,
        prices=prices,
    )


def reason_of(state: State, active: LimitName) -> str:
    """Sentence that names the limit that holds the feed."""
    load = next(load for load in state.loads if load.limit.name is active)
    limit = load.limit
    return (
        f"{active.words} {load.value * limit.scale:.4g} {limit.unit} reaches its bound of "
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
    elif isinstance(operation, DrillingTypeOperation):
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
    cutting_material = _cutting_material(cut.tool)
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
    asked = task.roughness or required_roughness(program, step)
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


def _cutting_material(tool: Tool) -> CuttingMaterial | None:
    """What the edge is made of, by the words the file has for it."""
    words = " ".join(tool.edge_material).lower()
    for material, names in (
        (CuttingMaterial.CERAMIC, ("ceramic",)),
        (CuttingMaterial.CARBIDE, ("carbide", "hartmetall", "metal duro")),
        (CuttingMaterial.HSS, ("hss", "high speed steel", "high-speed steel")),
    ):
        if any(name in words for name in names):
            return material
    return None


def _problem(cut: Cut, at: Conditions, task: Task) -> Problem:
    """The mathematical problem of a cut."""
    limits = limits_of(cut, at)
    given = cut.programmed
    if Free.FEED not in task.free:
        limits += tuple(_held_feed(given.feed, sense) for sense in Sense)
    passes = (given.passes, given.passes)
    if Free.DEPTH in task.free and cut.is_depth_free:
        passes = (1, max(given.passes, int(cut.total_depth / LEAST_DEPTH)))
    speeds, stretches = _stretches(cut, at, task)
    return Problem(
        limits=limits,
        cost=_cost(cut, at, task),
        total_depth=cut.total_depth,
        passes=passes,
        speeds=speeds,
        programmed=given,
        stretches=stretches,
    )


def _held_feed(feed: float, sense: Sense) -> Limit:
    """The programmed feed as a limit, when it is not free."""
    return Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=feed,
        unit="mm",
        sense=sense,
        step=0.01,
    )


def _stretches(
    cut: Cut, at: Conditions, task: Task
) -> tuple[tuple[float, ...], tuple[tuple[Limit, ...], ...]]:
    """Speeds that may be chosen, and the spindle's limits on each stretch of its curve."""
    speed = cut.programmed.speed
    low, high = speed_range(cut, at)
    if Free.SPEED not in task.free or not low < high < float("inf"):
        return (speed,), (spindle_limits(cut, at, segment_at(at, speed)),)
    low = max(low, 0.1 * high)
    segments = [
        part
        for part in curve_segments(at.machine.spindle)
        if part.max_speed > low and part.min_speed < high
    ]
    inner = [part.max_speed for part in segments[:-1]]
    return (low, *inner, high), tuple(spindle_limits(cut, at, part) for part in segments)


def _cost(cut: Cut, at: Conditions, task: Task) -> Cost:
    """Time and energy of the cut on this machine."""
    machine = at.machine
    spindle = machine.spindle
    wear = _wear_rate(cut, at) if task.tool_change > 0.0 else None
    return Cost(
        length=cut.length,
        once_length=cut.floor.length if cut.floor is not None else 0.0,
        teeth=cut.tool.teeth,
        motor_power=power_load(cut, at),
        link_time=cut.link_length / machine.rapid if machine.rapid else 0.0,
        standby_power=machine.base_power + machine.coolant_power + spindle.idle_power,
        standby_power_per_speed=spindle.idle_power_per_speed,
        tool_change=task.tool_change if wear is not None else 0.0,
        wear_rate=wear,
    )


def _wear_rate(cut: Cut, at: Conditions) -> Monomial | None:
    """Tool lives used in one second: ``1/T = (v_c/C)^(1/n)``; None when no life is known."""
    window = find_window(at.material, cut.tool_kind, at.cutting_material)
    if window is None or window.taylor is None:
        return None
    exponent = 1.0 / window.taylor.exponent
    life = tool_life(window.taylor, pi * cut.diameter)
    return Monomial(coefficient=1.0 / life, speed_exponent=exponent)


def _programmed_findings(program: Program, step: Workingstep, before: State) -> list[Finding]:
    """Limits that the programmed setting itself does not keep."""
    found = {}
    for load in before.loads:
        at = before.setting
        if not load.limit.holds(at.feed, at.depth, at.speed):
            text = f"as programmed: {exact.told(load.limit, load.value, at.speed)}"
            ref = step.technology_ref
            found[load.limit.name] = program.finding(Severity.WARNING, text, ref)
    return list(found.values())
