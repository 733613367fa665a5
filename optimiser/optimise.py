"""Feed advice for every workingstep of a program.

Lengths, engagement and times are those of the real tool paths in the remaining stock, run by
the machine's axes, unless another source of cuts is chosen. The optimum is exact for these
numbers. It is solved again with the path of the advice itself until the advice no longer
changes, so that its time is that of the path that the file will give.

The result depends on the arguments alone: corrections of the cutting force are passed by tool.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isfinite

from optimiser.advice import (
    Advice,
    AdviceStatus,
    EvaluatedSetting,
    Plan,
    RefusedWorkingstep,
)
from optimiser.bounds.holding import holding_load
from optimiser.bounds.limits import is_bent
from optimiser.bounds.plunge_feed import plunge_fault, plunge_findings
from optimiser.bounds.required_limits import (
    unchecked_limits,
    why_impossible,
    why_thread_impossible,
)
from optimiser.bounds.roughness import LAND_SHARE, is_dry, required_roughness, roughness_load
from optimiser.bounds.speed_limits import why_thread_too_fast, why_too_fast
from optimiser.bounds.stability import RISK, estimate_texts, stability_of
from optimiser.bounds.tolerance import permitted_deflection
from optimiser.cuts.conditions import CuttingConditions, PermittedDeflection, tool_grade
from optimiser.cuts.cut import Cut
from optimiser.cuts.feature_cuts import mean_diameter
from optimiser.cuts.source import CutSource, WiperCutSource, why_elsewhere
from optimiser.errors import Infeasible, OptimisationError
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import OptimisationTask, front_of, problem_of, state_of
from optimiser.planning.holding_demand import holding_findings, with_holding
from optimiser.planning.passes import AdviceContext, best_of, untried_words
from optimiser.planning.reasons import passed_limits, plunge_reason, reason_of
from optimiser.solver import workingstep as exact
from optimiser.solver.problem import Problem
from simulator.spec import CuttingMaterial, Machine, MachineKind, MaterialMatch
from simulator.tool_kind import edge_material
from stepnc_model.editing.record_edit import NO_LIMITS, RecordLimits, record_limits
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, SchemaError, Severity, StepNcError
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import Programmed, programmed
from stepnc_model.programs.tool import Tool, tool_of
from stepnc_model.units import um_from_mm

_Outcome = Advice | RefusedWorkingstep | None

DEFAULT_QUALITY = 3.2e-3
"""Roughness Ra kept in QC mode when none is required, mm: ISO 1302 general machining."""


def optimise_program(
    program: Program,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: OptimisationTask,
    selected: Callable[[ResolvedWorkingstep], bool] = lambda _: True,
    progress: Callable[[], None] = lambda: None,
) -> Plan:
    """Optimise the feeds of every selected workingstep of a program.

    Parameters
    ----------
    selected : callable
        Predicate that selects the workingsteps.
    progress : callable
        Called after each optimised workingstep.

    Returns
    -------
    Plan

    Raises
    ------
    SchemaError
        When a selected workingstep lacks what a cut needs, unless the task keeps going.
    OptimisationError
        When cost is to be least and the machine states no rates.
    """
    if task.mode is Mode.CC and machine.costs is None:
        raise OptimisationError(
            f"mode CC: machine {machine.name} has no [cost] table: currency, "
            "rate_per_hour, edge_change_s and the prices of edges"
        )
    findings: list[Finding] = []
    advices = []
    refused = []
    cuts = task.source(program, machine, material.material)
    if task.wipers:
        cuts = WiperCutSource(cuts, task.wipers)
    last = max((step.index for step in program.workingsteps if selected(step)), default=-1)

    def do(step: ResolvedWorkingstep) -> tuple[_Outcome, list[Finding]]:
        if not selected(step):
            cuts.leave_out(step)
            return None, []
        try:
            with program.using(step.operation_ref, *step.features, step.setup):
                return advise(
                    program, step, cuts, machine=machine, material=material, task=task
                )
        except StepNcError as error:
            if not task.keep_going:
                raise
            cuts.leave_out(step)
            return _refused(step, error), []

    for advice, found in cuts.map_workingsteps(program.workingsteps[: last + 1], do):
        if advice is None:
            continue
        if isinstance(advice, RefusedWorkingstep):
            refused.append(advice)
        else:
            advices.append(advice)
        progress()
        # Workingsteps that share a tool produce the same findings about it.
        findings += [finding for finding in found if finding not in findings]
    findings += _estimates(program, advices)
    if task.free:
        # If nothing may change, the run under control reports the loads instead of an estimate.
        findings += holding_findings(program, advices, machine)
    return Plan(
        program=program.name,
        mode=task.mode,
        machine=machine,
        material=material,
        advices=tuple(advices),
        findings=tuple(findings),
        safety=task.safety,
        roughness_quantile=task.roughness_quantile,
        refused=tuple(refused),
    )


def _refused(step: ResolvedWorkingstep, error: StepNcError) -> RefusedWorkingstep:
    """Workingstep that is left as it is because of an error."""
    return RefusedWorkingstep(
        id=step.id,
        ref=step.ref,
        reason=str(error),
        is_infeasible=isinstance(error, OptimisationError),
    )


def advise(
    program: Program,
    step: ResolvedWorkingstep,
    cuts: CutSource,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: OptimisationTask,
) -> tuple[Advice, list[Finding]]:
    """Optimise the feed of one workingstep; the findings state assumptions."""
    tool = tool_of(program, step.tool_ref)
    conditions = programmed(program, step.technology_ref)
    untouched = Advice(
        workingstep=step,
        tool=tool,
        programmed=conditions,
        status=AdviceStatus.UNTOUCHED,
        reason=conditions.inhibition,
        cut=None,
        before=None,
        after=None,
    )
    if conditions.is_synchronised or not _is_cut_with_feed(step):
        cuts.leave_out(step)
        return _thread(program, untouched, machine, material)
    elsewhere = why_elsewhere(step, machine)
    if elsewhere:
        cuts.leave_out(step)
        return replace(untouched, status=AdviceStatus.INFEASIBLE, reason=elsewhere), []
    cut, findings = cuts.cut(step)
    bounds, noted = _bounds(program, step, task)
    at, found = _conditions(program, step, cut, machine=machine, material=material, task=task)
    at, held = with_holding(replace(at, bounds=bounds), program, step)
    findings += noted + found + held
    problem = problem_of(cut, at, task)
    before = state_of(cut, problem, at, problem.programmed)
    if not isfinite(before.time) or not isfinite(before.energy):
        raise ValueError(f"machining time {before.time:g} s: time and energy must be finite")
    untouched = replace(
        untouched,
        conditions=at,
        force_factor=at.force_factor,
        safety_factor=at.safety_factor,
        cut=cut,
        before=before,
        after=before,
        stability=stability_of(cut, at),
    )
    idle = _why_idle(cut)
    if idle:
        findings.append(program.finding(Severity.WARNING, idle, step.operation_ref))
        state = _in_air(before) if cut.is_air else before
        return replace(untouched, reason=idle, before=state, after=state), findings
    impossible = why_impossible(cut, at, tool)
    if impossible:
        status = AdviceStatus.INFEASIBLE
        return replace(untouched, status=status, reason=impossible, after=None), findings
    asked = AdviceContext(step=step, at=at, task=task, cuts=cuts)
    advice, found = _chosen(program, untouched, cut, problem, asked)
    used, may = advice.cut or cut, task.allow_plunge
    state = advice.after or before
    advice = replace(
        advice,
        plunge_fault=plunge_fault(used, at, is_allowed=may),
        holding_load=holding_load(used, at, state.setting),
        unchecked=unchecked_limits(used, at, tuple(load.limit for load in state.loads)),
    )
    findings += [*found, *plunge_findings(program, step, used, at, is_allowed=may)]
    return advice, findings + passed_limits(program, advice)


def _chosen(
    program: Program, untouched: Advice, cut: Cut, problem: Problem, context: AdviceContext
) -> tuple[Advice, list[Finding]]:
    """Advice on a cut with a feed: locked, solved, or without a solution."""
    step, conditions = untouched.workingstep, untouched.programmed
    if conditions.inhibition:
        reason = f"{conditions.inhibition}: the program locks this feed"
        advice = _kept(untouched, reason, why_too_fast(cut, context.at))
        return advice, [_lock(program, step, conditions), *_too_fast(program, advice)]
    try:
        return _solved(program, untouched, cut, problem, context)
    except Infeasible as conflict:
        reason = str(conflict)
        return replace(untouched, status=AdviceStatus.INFEASIBLE, reason=reason, after=None), []
    except OptimisationError as error:
        raise OptimisationError(f"{program.label(step.operation_ref)}: {error}") from error


def _thread(
    program: Program, untouched: Advice, machine: Machine, material: MaterialMatch
) -> tuple[Advice, list[Finding]]:
    """Advice for a thread, whose feed is its pitch: only its speed can be checked."""
    step, tool = untouched.workingstep, untouched.tool
    unsuited = why_thread_impossible(tool, machine, material.material)
    if unsuited:
        return replace(untouched, status=AdviceStatus.INFEASIBLE, reason=unsuited), []
    too_fast = why_thread_too_fast(
        tool,
        untouched.programmed,
        machine,
        material.material,
        diameter=_thread_diameter(program, step, tool),
    )
    kept = _kept(untouched, "the feed is bound to the pitch of the thread", too_fast)
    return kept, _too_fast(program, kept)


def _bounds(
    program: Program, step: ResolvedWorkingstep, task: OptimisationTask
) -> tuple[RecordLimits, list[Finding]]:
    """Limits that the record in the file sets, with a note that says so."""
    bounds = record_limits(program, step)
    if not bounds:
        return bounds, []
    if task.ignores_records:
        text = f"ignored as requested: the record in the file allows {bounds.words}"
        return NO_LIMITS, [program.finding(Severity.NOTE, text, step.operation_ref)]
    text = f"kept: the record in the file allows {bounds.words} (--ignore-record)"
    return bounds, [program.finding(Severity.NOTE, text, step.operation_ref)]


def _thread_diameter(program: Program, step: ResolvedWorkingstep, tool: Tool) -> float:
    """Diameter of a thread, mm; 0 where its feature does not state it."""
    if not isinstance(step.operation, TurningMachiningOperation):
        return tool.diameter
    try:
        return mean_diameter(program, step)
    except SchemaError:
        return 0.0


def _kept(untouched: Advice, reason: str, too_fast: str) -> Advice:
    """Advice for a locked workingstep, with the limit that its speed exceeds."""
    told = f"{reason}, and {too_fast}" if too_fast else reason
    return replace(untouched, reason=told, speed_fault=too_fast)


def _too_fast(program: Program, advice: Advice) -> list[Finding]:
    """Finding on a locked spindle speed that exceeds its bound."""
    if not advice.speed_fault:
        return []
    text = f"the program locks the speed, and {advice.speed_fault}"
    return [program.finding(Severity.ERROR, text, advice.workingstep.technology_ref)]


def _estimates(program: Program, advices: Sequence[Advice]) -> list[Finding]:
    """Notes on the estimated stability of tools without measured modes, one per tool."""
    told = [
        (advice.tool, advice.stability, state.setting.depth)
        for advice in advices
        if advice.stability is not None and (state := advice.after or advice.before) is not None
    ]
    refs = {advice.tool.id: advice.workingstep.tool_ref for advice in advices}
    return [
        program.finding(_severity(text), text, refs[tool])
        for tool, text in estimate_texts(told)
    ]


def _severity(text: str) -> Severity:
    """Severity of an estimate of the stable depth: a risk is more than a note."""
    return Severity.WARNING if text.startswith(RISK) else Severity.NOTE


def _lock(program: Program, step: ResolvedWorkingstep, conditions: Programmed) -> Finding:
    """Note that names what locks a feed, and the option that unlocks it."""
    is_override = conditions.inhibition == "inhibit_feedrate_override"
    ref = step.technology_ref if is_override else conditions.feed.ref
    attribute = conditions.inhibition.split()[0]
    number = program.label(ref).split()[0]
    value = ".F." if is_override else ".T."
    text = f'locks the feed; --set "{number}.{attribute}={value}" unlocks it'
    return program.finding(Severity.NOTE, text, ref, attribute)


def _why_idle(cut: Cut) -> str:
    """Reason why no feed can be chosen; empty where one can."""
    if cut.is_air:
        return "the tool meets no material: the feed stays as programmed"
    if cut.length <= 0.0:
        return "no move runs at the programmed feed: the feed stays as programmed"
    return ""


def _in_air(state: EvaluatedSetting) -> EvaluatedSetting:
    """State of a cut in air, without loads."""
    return replace(state, motor_power=0.0, cutting_force=0.0, roughness=None, loads=())


def _solved(
    program: Program, untouched: Advice, cut: Cut, problem: Problem, context: AdviceContext
) -> tuple[Advice, list[Finding]]:
    """Advice from the best setting of a workingstep, with warnings."""
    at, task = context.at, context.task
    told = best_of(cut, problem, context)
    solution = told.optimum.solution
    after = state_of(told.cut, told.problem, at, solution.setting)
    saving = cost_of_safety = free_speed = 0.0
    if task.tool_change == 0.0:
        free_speed = _saving_of_free_speed(told.cut, at, task, solution)
        saving = exact.saving_of_one_more(told.problem, task.mode, solution)
        cost_of_safety = exact.cost_of_safety(told.problem, task.mode, solution)
    advice = replace(
        untouched,
        cut=told.cut,
        stability=stability_of(told.cut, at),
        status=AdviceStatus.ADVISED,
        reason=reason_of(after, solution.holding),
        plunge_reason=plunge_reason(after),
        after=after,
        active=solution.active,
        active_words=solution.holding.words,
        saving_of_one_more=saving,
        cost_of_safety=cost_of_safety,
        saving_of_free_speed=free_speed,
        deepest_first_time=solution.deepest_first_time,
        prices=told.optimum.prices,
        front=front_of(told.problem, told.cut, at) if task.front else (),
    )
    ref = untouched.workingstep.operation_ref
    warnings = untried_words(told.untried, solution.setting.passes)
    return advice, [program.finding(Severity.WARNING, text, ref) for text in warnings]


def _saving_of_free_speed(
    cut: Cut, at: CuttingConditions, task: OptimisationTask, solution: exact.Solution
) -> float:
    """Time that a free spindle speed would save on the same path, s."""
    if Free.SPEED in task.free:
        return 0.0
    free = problem_of(cut, at, replace(task, free=task.free | {Free.SPEED}))
    try:
        return max(0.0, solution.time - exact.solve(free, task.mode).time)
    except Infeasible:
        return 0.0


def _is_cut_with_feed(step: ResolvedWorkingstep) -> bool:
    """True if the feed may be chosen; the feed of a thread is its pitch."""
    return not any(word in step.operation_type for word in ("tapping", "thread"))


def _conditions(
    program: Program,
    step: ResolvedWorkingstep,
    cut: Cut,
    *,
    machine: Machine,
    material: MaterialMatch,
    task: OptimisationTask,
) -> tuple[CuttingConditions, list[Finding]]:
    """Grade, cutting material, roughness and permitted deflection of a cut, with findings."""
    findings: list[Finding] = []
    cutting_material = edge_material(cut.tool.edge_material)
    if cutting_material is None:
        cutting_material = CuttingMaterial.CARBIDE
        text = f"tool '{cut.tool.id}' names no cutting material: carbide assumed"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    work = material.material
    grade = tool_grade(cut.tool_kind, cutting_material, machine, work)
    if grade is not None and grade.borrowed:
        text = f"tool '{cut.tool.id}' has {grade.borrowed}"
        findings.append(program.finding(Severity.WARNING, text, step.tool_ref))
    is_turned = cut.kind.is_turned
    if is_turned is not (machine.kind is MachineKind.LATHE):
        text = f"{step.operation_type} on '{machine.name}', which is a {machine.kind.value}"
        findings.append(program.finding(Severity.WARNING, text, step.operation_ref))
    asked = _roughness(program, step, cut, task, findings)
    deflection = PermittedDeflection()
    if grade is not None and is_bent(cut) and not machine.only_stated_limits:
        deflection, found = permitted_deflection(program, step)
        findings += found
    factor = task.force_factor(cut.tool.id)
    if factor != 1.0:
        text = f"k_c × {factor:.4g} (accepted correction) for tool '{cut.tool.id}'"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    return (
        CuttingConditions(
            machine=machine,
            material=work,
            cutting_material=cutting_material,
            grade=grade,
            roughness=asked,
            roughness_quantile=task.roughness_quantile,
            is_dry=is_dry(program, step),
            deflection=deflection,
            force_factor=factor,
            centre_cutting=task.centre_cutting.get(cut.tool.id, cut.tool.centre_cutting),
            safety_factor=task.safety_factor(cut.tool.id, machine, work),
        ),
        findings,
    )


def _roughness(
    program: Program,
    step: ResolvedWorkingstep,
    cut: Cut,
    task: OptimisationTask,
    findings: list[Finding],
) -> float | None:
    """Roughness Ra that this workingstep must keep, mm: requested, in the file, or default."""
    if not cut.is_finishing:
        return None
    drawn = required_roughness(program, step)
    asked = task.roughness or drawn
    if asked is not None and drawn is not None and asked > drawn:
        text = (
            f"the requested Ra {um_from_mm(asked):g} µm is coarser than "
            f"Ra {um_from_mm(drawn):g} µm in the file"
        )
        findings.append(program.finding(Severity.WARNING, text, step.operation_ref))
    if asked is None and task.mode is Mode.QC:
        asked = DEFAULT_QUALITY
        text = f"no roughness is required: QC keeps Ra {um_from_mm(DEFAULT_QUALITY):g} µm"
        findings.append(program.finding(Severity.NOTE, text, step.operation_ref))
    if asked is not None and roughness_load(cut) is None:
        text = f"Ra {um_from_mm(asked):g} µm is required, but " + (
            f"the parallel land of {cut.parallel_land:g} mm that inserts usually have makes "
            f"this surface: the feed keeps {100.0 * LAND_SHARE:g} % of it in a revolution"
            if cut.parallel_land
            else "the roughness of this surface does not follow from the feed"
        )
        findings.append(program.finding(Severity.NOTE, text, step.operation_ref))
    return asked
