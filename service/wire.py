"""The JSON of the command line. Keys carry their units and are fixed: others parse them."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

from optimiser.advice import Advice, Load, Plan, State, tightest
from service.confirmation import Confirmation
from service.contents import Contents
from simulator.spec import Machine, Material
from stepnc_model.errors import Finding
from stepnc_model.units import (
    kw_from_watts,
    mm_min_from_speed,
    nm_from_nmm,
    rpm_from_rev_s,
    um_from_mm,
)


def plan_json(plan: Plan, confirmation: Confirmation | None = None) -> str:
    """A plan as JSON, and what its run found where one was asked for."""
    found = {} if confirmation is None else {"confirmation": _confirmation(confirmation)}
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
        "total_time_s": {"before": plan.time_before, "after": plan.time_after},
        "findings": [finding_json(finding) for finding in plan.findings],
        **found,
    })


def _confirmation(confirmation: Confirmation) -> dict[str, Any]:
    """What was promised and found."""
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
                    }
                    for figure in step.figures
                },
            }
            for step in confirmation.steps
        ],
        "passed": list(confirmation.passed),
    }


def contents_json(contents: Contents) -> str:
    """What a file holds, as JSON."""
    program = contents.program
    steps = program.workingsteps if program is not None else ()
    executables = program.executables if program is not None else ()
    return dump({
        "program": contents.name,
        "schemas": list(contents.schemas),
        "instances": contents.instances,
        "is_usable": contents.is_usable,
        "executables": [
            {
                "instance": str(each.ref),
                "entity": each.keyword,
                "id": each.id,
                "level": each.level,
            }
            for each in executables
        ],
        "workingsteps": [
            {
                "id": step.id,
                "instance": str(step.ref),
                "operation": step.operation_type,
                "tool": str(step.tool_ref),
            }
            for step in steps
        ],
        "findings": [finding_json(finding) for finding in contents.findings],
    })


def entry_json(entry: Machine | Material) -> str:
    """One machine or material as JSON, in canonical units (mm, s, N, W, rev/s)."""
    return dump(_finite(asdict(entry)))


def entries_json(entries: Sequence[Machine | Material]) -> str:
    """All machines or materials by name and title."""
    return dump([{"name": entry.name, "title": entry.title} for entry in entries])


def _advice(advice: Advice) -> dict[str, Any]:
    """One workingstep."""
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
        "programmed": _setting(before),
        "advised": _setting(after),
        "active_limit": advice.active.value if advice.active else None,
        "limits": [_load(load) for load in tightest(shown.loads)] if shown else [],
        "motor_power_kw": kw_from_watts(shown.motor_power) if shown else None,
        "cutting_force_n": shown.cutting_force if shown else None,
        "roughness_ra_um": um_from_mm(shown.roughness) if shown and shown.roughness else None,
        "energy_j": shown.energy if shown else None,
        "time_s": {
            "before": before.time if before else None,
            "after": after.time if after else None,
        },
        "sensitivity": _sensitivity(advice),
        "deepest_pass_first_time_s": advice.deepest_first_time,
        "stability": _stability(advice),
        "plunge": _plunge(advice),
        "holding_load": _holding_load(advice),
        "prices": {name.value: price for name, price in advice.prices},
        "pareto": [
            {
                "time_s": point.state.time,
                "roughness_ra_um": um_from_mm(point.state.roughness or 0.0) or None,
                "energy_j": point.state.energy,
                "feed_mm_min": mm_min_from_speed(point.state.feed),
                "spindle_rpm": rpm_from_rev_s(point.state.setting.speed),
                "passes": point.state.setting.passes,
            }
            for point in advice.front
        ],
    }


def _stability(advice: Advice) -> dict[str, Any] | None:
    """What is known of it; the bound itself is one of the limits."""
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
    """What holds the plunge feed; null where no way down has one of its own."""
    shown = advice.after or advice.before
    if shown is None or not (shown.plunge_loads or advice.plunge_fault):
        return None
    return {
        "reason": advice.plunge_reason,
        "fault": advice.plunge_fault or None,
        "limits": [_load(load) for load in tightest(shown.plunge_loads)],
    }


def _holding_load(advice: Advice) -> dict[str, float] | None:
    """What is asked of chuck, vice or clamps; their bounds are among the limits."""
    load = advice.holding_load
    if load is None:
        return None
    return {
        "torque_nm": nm_from_nmm(load.torque),
        "moment_nm": nm_from_nmm(load.moment),
        "force_n": load.force,
        "lift_n": load.lift,
    }


def _setting(state: State | None) -> dict[str, Any] | None:
    """Feed, speed and depth in shop units."""
    if state is None:
        return None
    setting = state.setting
    return {
        "feed_mm_min": mm_min_from_speed(state.feed),
        "spindle_rpm": rpm_from_rev_s(setting.speed),
        "feed_per_tooth_mm": setting.feed,
        "axial_depth_mm": setting.depth,
        "passes": setting.passes,
        "plunge_feed_mm_min": _mm_min(state.plunge_feed),
        "plunge_feed_per_tooth_mm": setting.plunge_feed,
    }


def _mm_min(feed: float | None) -> float | None:
    return None if feed is None else mm_min_from_speed(feed)


def _load(load: Load) -> dict[str, Any]:
    """One limit with its margin as a share of the bound, after the safety factor."""
    limit = load.limit
    return {
        "name": limit.name.value,
        "value": load.value * limit.scale,
        "bound": load.bound * limit.scale,
        "unit": limit.unit,
        "sense": limit.sense.value,
        "safety_factor": limit.safety_factor,
        "margin": load.margin,
    }


def _sensitivity(advice: Advice) -> dict[str, Any] | None:
    """What one more of the active limit's unit would save."""
    if advice.active is None or advice.after is None:
        return None
    limit = next(load.limit for load in advice.after.loads if load.limit.name is advice.active)
    return {
        "limit": advice.active.value,
        "one_more": limit.step,
        "unit": limit.unit,
        "saves_s": advice.saving_of_one_more,
    }


def finding_json(finding: Finding) -> dict[str, Any]:
    """One finding."""
    return {
        "severity": finding.severity.value,
        "message": finding.message,
        "entity": finding.entity,
        "attribute": finding.attribute,
        "line": finding.line,
        "rule": finding.rule,
    }


def _finite(value: Any) -> Any:
    """The same value with null where a number is infinite: not limited."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def dump(value: object) -> str:
    """Readable JSON without NaN."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False, default=str)
