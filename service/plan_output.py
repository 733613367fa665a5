"""Output of a plan as text, JSON and one self-contained HTML page.

JSON keys carry their units and never change, because other programs read them.
"""

from collections.abc import Callable, Sequence
from functools import partial
from math import isfinite
from typing import TYPE_CHECKING, Any

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad, Plan, tightest
from optimiser.modes import Mode
from optimiser.problem import LimitName
from optimiser.remedies import slower_than_programmed
from optimiser.roughness import IDEAL
from optimiser.stability import Basis
from service.plan_checks import UNCHECKED, chatter_record, chatter_words, unchecked_words
from service.rendering.columns import Cell, Change, Column
from service.rendering.records import dump, finding_record, record, records
from service.rendering.text import RED, print_findings, print_line, print_table
from stepnc_model.errors import Finding
from stepnc_model.units import (
    kw_from_watts,
    mm_min_from_speed,
    nm_from_nmm,
    rpm_from_rev_s,
    um_from_mm,
)

if TYPE_CHECKING:
    from optimiser.advice import ParetoPoint
    from service.along_path.run import FeedsAlongPath
    from service.confirmation import Confirmation, ConfirmedStep


def _change(value: Callable[[EvaluatedSetting], Cell]) -> Callable[[Advice], Cell]:
    """Return a column value that pairs the programmed and the advised value."""

    def pair(advice: Advice) -> Cell:
        before, after = advice.before, advice.after
        if before is None:
            return None
        return Change(before=value(before), after=value(after or before))

    return pair


def _depth(state: EvaluatedSetting) -> str:
    return f"{state.setting.depth:.4g} x {state.setting.passes}"


def _plunge_feed(state: EvaluatedSetting) -> float | None:
    """Plunge feed into the material, in mm/min; None without a separate plunge feed."""
    return None if state.plunge_feed is None else mm_min_from_speed(state.plunge_feed)


def _energy(state: EvaluatedSetting) -> float:
    return state.energy


def _active(advice: Advice) -> str:
    """Active limit of an advice, or its status if no feed was advised."""
    is_advised = advice.after is not None and advice.status is AdviceStatus.ADVISED
    return advice.active_words if is_advised else advice.status.value


NAME: Column[Advice] = Column(
    heading="workingstep", value=lambda advice: advice.workingstep.id, is_key=True
)
TIME: Column[Advice] = Column(
    heading="time s", form=".1f", value=_change(lambda state: state.time)
)
SHOWN: tuple[Column[Advice], ...] = (
    NAME,
    Column(
        heading="operation", value=lambda advice: advice.workingstep.operation_type,
        is_words=True,
    ),
    Column(heading="tool", value=lambda advice: advice.tool.id, is_words=True),
    Column(
        heading="feed mm/min", form=".1f", help="v_f",
        value=_change(lambda state: mm_min_from_speed(state.feed)),
    ),
    Column(
        heading="plunge mm/min", form=".1f", help="plunge feed into the material",
        value=_change(_plunge_feed), is_optional=True,
    ),
    Column(
        heading="rpm", form=".1f", help="n",
        value=_change(lambda state: rpm_from_rev_s(state.setting.speed)),
    ),
    Column(heading="depth mm x passes", help="a_p", value=_change(_depth)),
)  # fmt: skip
ACTIVE: Column[Advice] = Column(heading="active limit", value=_active, is_words=True)
RISK: Column[Advice] = Column(
    heading="chatter risk", value=chatter_words, is_words=True, is_optional=True,
    help="depth cut, and the optimistic end of the estimated stable depth, mm",
)  # fmt: skip

TEXT = (
    *SHOWN,
    ACTIVE,
    RISK,
    TIME,
)
"""Columns of the plan table on a terminal."""

PAGE = (
    *SHOWN,
    Column(
        heading="kW", form=".2f", help="power that the cut draws from the motor",
        value=_change(lambda state: kw_from_watts(state.motor_power)),
    ),
    ACTIVE,
    RISK,
    TIME,
)  # fmt: skip
"""Columns of the plan table in the HTML report."""

FRONT: "tuple[Column[ParetoPoint], ...]" = (
    Column(key="time_s", heading="time s", form=".2f", value=lambda point: point.state.time),
    Column(
        key="roughness_ra_um", heading="ideal Ra µm", form=".3g",
        value=lambda point: um_from_mm(point.state.roughness or 0.0) or None,
    ),
    Column(
        key="energy_j", heading="energy kJ", form=".2f", scale=1e-3,
        value=lambda point: point.state.energy,
    ),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".1f",
        value=lambda point: mm_min_from_speed(point.state.feed),
    ),
    Column(
        key="spindle_rpm", heading="rpm", form=".0f",
        value=lambda point: rpm_from_rev_s(point.state.setting.speed),
    ),
    Column(key="passes", heading="passes", value=lambda point: point.state.setting.passes),
)  # fmt: skip

SETTING: tuple[Column[EvaluatedSetting], ...] = (
    Column(key="feed_mm_min", value=lambda state: mm_min_from_speed(state.feed)),
    Column(key="spindle_rpm", value=lambda state: rpm_from_rev_s(state.setting.speed)),
    Column(key="feed_per_tooth_mm", value=lambda state: state.setting.feed),
    Column(key="axial_depth_mm", value=lambda state: state.setting.depth),
    Column(key="passes", value=lambda state: state.setting.passes),
    Column(key="plunge_feed_mm_min", value=_plunge_feed),
    Column(key="plunge_feed_per_tooth_mm", value=lambda state: state.setting.plunge_feed),
)

LOAD: tuple[Column[LimitLoad], ...] = (
    Column(key="name", value=lambda load: load.limit.name.value),
    Column(key="value", value=lambda load: load.value * load.limit.scale),
    Column(key="bound", value=lambda load: load.bound * load.limit.scale),
    Column(key="unit", value=lambda load: load.limit.unit),
    Column(key="sense", value=lambda load: load.limit.sense.value),
    Column(key="safety_factor", value=lambda load: load.limit.safety_factor),
    Column(key="margin", value=lambda load: load.margin),
)
"""Columns of a limit; its margin is a share of the bound, after the safety factor."""


def print_plan(
    plan: Plan,
    confirmation: "Confirmation | None" = None,
    along: "FeedsAlongPath | None" = None,
    told: Sequence[Finding] = (),
) -> None:
    """Print the advice for a program: a row per workingstep, then totals and findings."""
    material = plan.material.material
    for text in slower_than_programmed(plan):
        print_line(text, RED)
    print_line(
        f"{plan.program}: mode {mode_words(plan.mode)}, machine {plan.machine.name} "
        f"({plan.machine.title}), material {material.title}{unchecked_words(plan)}"
    )
    total = f"{plan.time_before:.1f} -> {plan.time_after:.1f}"
    print_table(TEXT, plan.advices, foot={"workingstep": "total", "time s": total})
    print_line(_safety(plan))
    saving = sum(advice.saving_of_free_speed for advice in plan.advices)
    if saving > 0.0:
        print_line(f"a free spindle speed would save {saving:.1f} s (--free feed,depth,speed)")
    print_line(
        f"energy {plan.energy_before / 1e3:.1f} -> {plan.energy_after / 1e3:.1f} kJ; "
        f"totals leave out {plan.left_out}"
    )
    for advice in plan.advices:
        print_line(f"  {advice.workingstep.id}: {_reason(advice)}")
    for advice in plan.advices:
        if advice.front:
            print_line(f"front of {advice.workingstep.id} (Ra is {IDEAL}):")
            print_table(FRONT, advice.front)
    if confirmation is not None:
        _print_confirmation(confirmation)
    if along is not None:
        from service.along_path.output import print_along_path  # noqa: PLC0415 (numpy)

        print_along_path(along)
    print_findings(plan.findings, told=told)


def mode_words(mode: Mode) -> str:
    """Name of a mode; of QC with what its roughness is."""
    return f"{mode.value} (Ra is {IDEAL})" if mode is Mode.QC else mode.value


def _safety(plan: Plan) -> str:
    """State the k_c quantile at which bounds are kept, and the time that costs."""
    factors = [advice.safety_factor for advice in plan.advices if advice.safety_factor != 1.0]
    if not factors:
        return "loads are nominal: no margin is added for the spread of k_c"
    low, high = f"{min(factors):.3g}", f"{max(factors):.3g}"
    cost = sum(advice.cost_of_safety for advice in plan.advices)
    return (
        f"bounds are kept at the {100.0 * plan.safety:g} % quantile of k_c (--safety), nominal "
        f"loads × {low if low == high else f'{low} to {high}'}, which costs {cost:.1f} s"
    )


def _print_confirmation(confirmation: "Confirmation") -> None:
    """Print predicted and simulated values, with their ratios."""
    print_line("predicted -> found on the virtual machine (found / predicted)")
    columns: list[Column[ConfirmedStep]] = [
        Column(heading="workingstep", value=lambda step: step.id),
        *(
            Column(heading=figure.heading, value=partial(_figure_at, place))
            for place, figure in enumerate(confirmation.steps[0].figures)
        ),
    ]
    print_table(columns, confirmation.steps)
    print_line(_nearest(confirmation))
    for text in confirmation.passed:
        print_line(f"not as planned: {text}", RED)


def _nearest(confirmation: "Confirmation") -> str:
    """State the bound that the run comes nearest to, and whether the same stock is left."""
    nearest = confirmation.nearest
    text = "no bound to compare with"
    if nearest is not None:
        step, figure = nearest
        text = (
            f"at the {100.0 * confirmation.quantile:g} % quantile of k_c nearest to a bound: "
            f"{step}, {figure.heading} {figure.greatest:.4g} of {figure.bound:.4g}"
        )
    unknown = confirmation.unknown_stock
    if unknown:
        return f"{text}; the stock left is not compared: {', '.join(unknown)}"
    if any(step.left is not None and step.left.is_seen for step in confirmation.steps):
        return text
    return f"{text}; every workingstep leaves the stock that the program as given leaves"


def _figure_at(place: int, step: "ConfirmedStep") -> str:
    figure = step.figures[place]
    if figure.ratio is None:
        return "" if figure.found == 0.0 else f"0 -> {figure.found:.4g}"
    return f"{figure.promised:.4g} -> {figure.found:.4g} ({figure.ratio:.3f})"


def _reason(advice: Advice) -> str:
    """Explain the advised feed, and which change would allow a higher one."""
    if advice.status is not AdviceStatus.ADVISED or advice.after is None:
        return f"{advice.status.value}: {advice.reason}"
    text = advice.reason
    limit = next(load.limit for load in advice.after.loads if load.limit.name is advice.active)
    if advice.saving_of_one_more > 0.0:
        text += f"; {limit.step:g} {limit.unit} more saves {advice.saving_of_one_more:.2g} s"
    if (
        advice.after.roughness is not None
        and advice.cut is not None
        and advice.cut.is_finishing
    ):
        text += f"; leaves Ra {advice.after.roughness * 1e3:.3g} µm ({IDEAL})"
    if advice.cut is not None:
        text += "".join(f"; {each.words}" for each in advice.cut.refused_passes[:1])
    deepest = advice.deepest_first_time
    if deepest is not None and deepest > advice.after.time * 1.001:
        text += f"; the deepest passes would have taken {deepest:.1f} s"
    if advice.plunge_reason:
        text += f"; plunge feed: {advice.plunge_reason}"
    if advice.unchecked:
        text += "; unchecked: " + "; ".join(limit.words for limit in advice.unchecked)
    return text + _stability_words(advice, advice.after)


def _stability_words(advice: Advice, state: EvaluatedSetting) -> str:
    """Describe the stable depth by the measured modes, or why it is not bounded."""
    found = advice.stability
    if found is None or found.basis is Basis.ESTIMATED:
        return ""
    load = next((load for load in state.loads if load.limit.name is LimitName.STABILITY), None)
    if load is None:
        return f"; stability not bounded: {found.reason or 'damped at this speed'}"
    text = f"; stable to {load.bound:.3g} mm at this speed"
    if found.least is not None:
        text += f", {found.least:.3g} mm at any"
    return text + f" ({found.reason})"


def plan_json(
    plan: Plan,
    confirmation: "Confirmation | None" = None,
    along: "FeedsAlongPath | None" = None,
) -> str:
    """Return a plan as JSON, with its simulated run and feeds along paths if requested."""
    found = {} if confirmation is None else {"confirmation": _confirmation(confirmation)}
    if along is not None:
        from service.along_path.output import along_path_record  # noqa: PLC0415 (numpy)

        found["along_path"] = along_path_record(along)
    return dump({
        "program": plan.program,
        "mode": plan.mode.value,
        "machine": plan.machine.name,
        "material": plan.material.material.name,
        "safety": {
            "quantile": plan.safety,
            "cost_s": sum(advice.cost_of_safety for advice in plan.advices),
        },
        "free_speed_saves_s": sum(advice.saving_of_free_speed for advice in plan.advices),
        "workingsteps": [_advice(advice) for advice in plan.advices],
        "is_checked": not plan.unchecked,
        "total_time_s": {"before": plan.time_before, "after": plan.time_after},
        "slower_than_programmed": list(slower_than_programmed(plan)),
        "refused": [
            {
                "id": each.id,
                "instance": str(each.ref),
                "reason": each.reason,
                "is_infeasible": each.is_infeasible,
            }
            for each in plan.refused
        ],
        "findings": [finding_record(finding) for finding in plan.findings],
        **found,
    })


def _confirmation(confirmation: "Confirmation") -> dict[str, Any]:
    """Return predicted and found values as a JSON object."""
    return {
        "workingsteps": [
            {
                "id": step.id,
                **{
                    figure.key: {
                        "promised": figure.promised,
                        "found": figure.found,
                        "ratio": figure.ratio,
                        "bound": figure.bound if isfinite(figure.bound) else None,
                        "found_at_quantile": figure.at_quantile,
                    }
                    for figure in step.figures
                },
                "stock_left": step.left
                and {"volume_mm3": step.left.volume, "deviation_mm": step.left.deviation},
            }
            for step in confirmation.steps
        ],
        "quantile": confirmation.quantile,
        "passed": list(confirmation.passed),
    }


def _advice(advice: Advice) -> dict[str, Any]:
    """Return the advice for one workingstep as a JSON object."""
    before, after = advice.before, advice.after
    shown = after or before
    step = advice.workingstep
    return {
        "id": step.id,
        "instance": str(step.ref),
        "operation": step.operation_type,
        "tool": advice.tool.id,
        "status": advice.status.value,
        "reason": advice.reason,
        "programmed": before and record(SETTING, before),
        "advised": after and record(SETTING, after),
        "active_limit": advice.active.value if advice.active else None,
        "limits": records(LOAD, tightest(shown.loads)) if shown else [],
        "motor_power_kw": kw_from_watts(shown.motor_power) if shown else None,
        "cutting_force_n": shown.cutting_force if shown else None,
        "roughness_ra_um": um_from_mm(shown.roughness) if shown and shown.roughness else None,
        "roughness_basis": IDEAL if shown and shown.roughness else None,
        "energy_j": shown.energy if shown else None,
        "time_s": {
            "before": before.time if before else None,
            "after": after.time if after else None,
        },
        "sensitivity": _sensitivity(advice),
        "deepest_pass_first_time_s": advice.deepest_first_time,
        "refused_passes": [
            {"passes": each.passes, "reason": each.why}
            for each in (advice.cut.refused_passes if advice.cut else ())
        ],
        "stability": _stability(advice),
        "chatter_risk": chatter_record(advice),
        "unchecked": records(UNCHECKED, advice.unchecked),
        "plunge": _plunge(advice),
        "holding_load": _holding_load(advice),
        "prices": {name.value: price for name, price in advice.prices},
        "pareto": records(FRONT, advice.front),
    }


def _stability(advice: Advice) -> dict[str, Any] | None:
    """Return the chatter stability of a cut for JSON; its bound is one of the limits."""
    found = advice.stability
    if found is None:
        return None
    return {
        "basis": found.basis.value,
        "reason": found.reason,
        "stable_at_any_speed_mm": found.least,
        "band_mm": found.band,
    }


def _plunge(advice: Advice) -> dict[str, Any] | None:
    """Return the reason for the plunge feed and its limits for JSON; None if there is none."""
    shown = advice.after or advice.before
    if shown is None or not (shown.plunge_loads or advice.plunge_fault):
        return None
    return {
        "reason": advice.plunge_reason,
        "fault": advice.plunge_fault or None,
        "limits": records(LOAD, tightest(shown.plunge_loads)),
    }


def _holding_load(advice: Advice) -> dict[str, float] | None:
    """Return the loads on the chuck, vice or clamps; their bounds are among the limits."""
    load = advice.holding_load
    if load is None:
        return None
    return {
        "torque_nm": nm_from_nmm(load.torque),
        "moment_nm": nm_from_nmm(load.moment),
        "force_n": load.force,
        "lift_n": load.lift,
    }


def _sensitivity(advice: Advice) -> dict[str, Any] | None:
    """Return the time saved when the active limit is raised by one step."""
    if advice.active is None or advice.after is None:
        return None
    limit = next(load.limit for load in advice.after.loads if load.limit.name is advice.active)
    return {
        "limit": advice.active.value,
        "one_more": limit.step,
        "unit": limit.unit,
        "saves_s": advice.saving_of_one_more,
    }


def report_page(plan: Plan, along: "FeedsAlongPath | None" = None) -> str:
    """Return the HTML report of a plan."""
    from service.figures import plan_figures  # noqa: PLC0415 (plotly)
    from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

    along_figures: list[Any] = []
    along_columns: tuple[Any, ...] = ()
    if along is not None:
        from service.along_path.figures import along_path_figures  # noqa: PLC0415 (plotly)
        from service.along_path.output import STEP  # noqa: PLC0415 (numpy)

        along_figures, along_columns = along_path_figures(along), STEP
    before, after = plan.time_before, plan.time_after
    return rendered(
        "plan.html.jinja",
        plan=plan,
        mode=mode_words(plan.mode),
        columns=PAGE,
        unchecked=unchecked_words(plan).removeprefix("; "),
        change=f"{after / before - 1.0:+.0%}" if before else "",
        reasons=[
            (advice.status.value, f"{advice.workingstep.id}: {_reason(advice)}")
            for advice in plan.advices
        ],
        plots=[plot(each, f"plot{row}") for row, each in enumerate(plan_figures(plan))],
        along=along,
        along_columns=along_columns,
        along_plots=[plot(each, f"along{row}") for row, each in enumerate(along_figures)],
    )
