"""Advice for a workingstep as a JSON object. Keys carry their units.

Unchecked limits of a plan: required ones without a bound, and the risk of chatter.

Notes on depths of passes that a user sets and that do not divide the whole depth.
"""

from collections.abc import Iterable, Iterator, Mapping
from math import ceil
from typing import TYPE_CHECKING, Any

from optimiser.advice import Advice, EvaluatedSetting, LimitLoad, Plan, tightest
from optimiser.bounds.required_limits import UncheckedLimit
from optimiser.bounds.roughness import IDEAL
from optimiser.cuts.cut import CutKind
from service.rendering.columns import Column, record, records
from simulator.physics.surface_spread import LIKELY
from stepnc_model.editing.user_data import SetAttribute
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Value
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program
from stepnc_model.units import (
    kw_from_watts,
    mm_min_from_speed,
    nm_from_nmm,
    rpm_from_rev_s,
    um_from_mm,
)

if TYPE_CHECKING:
    from optimiser.advice import ParetoPoint

UNCHECKED: tuple[Column[UncheckedLimit], ...] = (
    Column(key="name", value=lambda limit: limit.name.value),
    Column(key="why", value=lambda limit: limit.why),
    Column(key="datum", value=lambda limit: limit.datum),
)
"""Columns of a required limit that could not be looked at."""


def unchecked_words(plan: Plan) -> str:
    """State which limits of a plan are in doubt; empty if none.

    Required ones that could not be looked at, and roughness that is not likely to be kept.
    """
    return _unchecked(plan) + _unlikely(plan)


def _unlikely(plan: Plan) -> str:
    """State how many surfaces may be rougher than required; empty if none."""
    count = len(plan.unlikely_surfaces)
    if not count:
        return ""
    keep = "surface keeps its" if count == 1 else "surfaces keep their"
    return f"; {count} {keep} Ra with less than {100.0 * LIKELY:g} % probability"


def _unchecked(plan: Plan) -> str:
    if not plan.unchecked:
        return ""
    steps = len({advice.workingstep.ref for advice, _ in plan.unchecked})
    limits = "limit is" if len(plan.unchecked) == 1 else "limits are"
    where = counted(steps, "workingstep")
    return f"; {len(plan.unchecked)} required {limits} unchecked in {where}"


def chatter_words(advice: Advice) -> str | None:
    """Depth beyond the estimated stable depth; None without such a risk."""
    risk = advice.chatter_risk
    return None if risk is None else risk.words


def chatter_record(advice: Advice) -> dict[str, float] | None:
    """Return depth and estimated stable depth for JSON; None without a risk."""
    risk = advice.chatter_risk
    if risk is None:
        return None
    return {"depth_mm": risk.depth, "stable_mm": risk.stable}


DEPTHS = {"axial_cutting_depth", "cutting_depth"}
"""Attributes that set the depth of passes."""

DIVIDES = 1e-6
"""Relative difference within which equal passes have the depth that was set."""

DECIMALS = 4


def depth_notes(
    program: Program, plan: Plan, given: Iterable[SetAttribute]
) -> tuple[Finding, ...]:
    """Notes on depths that were set and became passes of another depth."""
    depths = {int(each.ref): each.value for each in given if each.attribute in DEPTHS}
    return tuple(_notes(program, plan, depths)) if depths else ()


def _notes(program: Program, plan: Plan, depths: Mapping[int, Value]) -> Iterator[Finding]:
    for advice in plan.advices:
        step = advice.workingstep
        strategy = getattr(step.operation, "its_machining_strategy", None)
        places = (int(ref) for ref in (step.operation_ref, strategy) if ref is not None)
        depth = next((depths[place] for place in places if place in depths), None)
        if isinstance(depth, int | float):
            text = _text(advice, float(depth))
            if text:
                yield program.finding(Severity.NOTE, text, step.operation_ref)


def _text(advice: Advice, depth: float) -> str:
    """Number and depth of the passes as programmed; empty where the depth divides."""
    cut = advice.cut
    if cut is None or cut.kind is not CutKind.MILLING or not cut.is_depth_free:
        return ""
    given, whole = cut.programmed, cut.total_depth
    if depth > whole * (1.0 + DIVIDES):
        return f"a depth of {depth:g} mm is more than there is: one pass of {whole:.4g} mm"
    real = whole / given.passes
    if abs(real / given.depth - 1.0) <= DIVIDES:
        return ""
    text = (
        f"a depth of {given.depth:g} mm does not divide {whole:g} mm: as programmed they are "
        f"{counted(given.passes, 'pass', 'passes')} of {real:.4g} mm"
    )
    fewer = given.passes - 1
    if fewer < 1:
        return text
    least = ceil(whole / fewer * 10**DECIMALS - DIVIDES) / 10**DECIMALS
    passes = "1 pass needs" if fewer == 1 else f"{fewer} passes need"
    return f"{text}; {passes} at least {least:g} mm"


def plunge_feed_mm_min(state: EvaluatedSetting) -> float | None:
    """Plunge feed into the material, in mm/min; None without a separate plunge feed."""
    return None if state.plunge_feed is None else mm_min_from_speed(state.plunge_feed)


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
    Column(key="plunge_feed_mm_min", value=plunge_feed_mm_min),
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


def advice_record(advice: Advice) -> dict[str, Any]:
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
        "roughness_expected_um": um_from_mm(shown.surface.median)
        if shown and shown.surface
        else None,
        "roughness_probability": advice.roughness_probability,
        "energy_j": shown.energy if shown else None,
        "cost": shown.money if shown else None,
        "tool_lives_used": shown.lives if shown else None,
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
