"""Conversion of the optimiser's advice into the records that are written to the file."""

from dataclasses import dataclass
from math import isclose, pi

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, Plan
from optimiser.cuts.cut import Cut, CutKind
from optimiser.modes import Mode
from optimiser.solver.problem import BoundSide, LimitName
from simulator.physics.engagement import Engagement
from stepnc_model.editing.cut_settings import rounded
from stepnc_model.editing.record import GENERATOR, AdviceRecord
from stepnc_model.editing.record_edit import NO_LIMITS, RecordLimits
from stepnc_model.editing.writeback import WorkingstepUpdate
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import ProgrammedQuantity
from stepnc_model.units import (
    NMM_S_PER_WATT,
    deg_from_rad,
    kw_from_watts,
    mm_min_from_speed,
    um_from_mm,
)

UNCHANGED = 1e-9
"""Relative difference below which an advised number counts as unchanged."""


def changes_of(plan: Plan) -> list[WorkingstepUpdate]:
    """Return the file updates of all advised workingsteps."""
    return [
        _change(plan, _Advised(each, each.cut, each.before, each.after))
        for each in plan.advices
        if each.status is AdviceStatus.ADVISED and each.cut and each.before and each.after
    ]


def lost_plunge_feeds(program: Program, plan: Plan) -> tuple[Finding, ...]:
    """Warnings about plunge feeds that a file without records does not hold.

    ISO 14649-11 gives an operation one feed, and its approach strategies none, so that only a
    record keeps the second one.
    """
    return tuple(
        program.finding(
            Severity.WARNING,
            f"the plunge feed of {mm_min_from_speed(each.after.plunge_feed):.3g} mm/min is not "
            "written, as only a record can hold it (--records none): NC code made of this file "
            f"plunges at {mm_min_from_speed(each.after.feed):.3g} mm/min",
            each.workingstep.operation_ref,
        )
        for each in plan.advices
        if each.status is AdviceStatus.ADVISED
        and each.after is not None
        and each.after.plunge_feed is not None
        and each.after.plunge_feed < each.after.feed
    )


@dataclass(frozen=True, slots=True)
class _Advised:
    """An advice with its cut and its settings before and after, none of them missing."""

    advice: Advice
    cut: Cut
    before: EvaluatedSetting
    after: EvaluatedSetting


def _change(plan: Plan, advised: _Advised) -> WorkingstepUpdate:
    """Return the numbers to write for a workingstep, in the units of the file's attributes."""
    advice, cut = advised.advice, advised.cut
    conditions, before, after = advice.programmed, advised.before, advised.after
    given, best = before.setting, after.setting
    is_speed_new = not isclose(given.speed, best.speed, rel_tol=UNCHANGED)
    is_depth_new = not isclose(given.depth, best.depth, rel_tol=UNCHANGED)
    return WorkingstepUpdate(
        workingstep=advice.workingstep,
        programmed=conditions,
        record=_record(plan, advised),
        feed=conditions.feed_number(best.feed, speed=best.speed, teeth=cut.tool.teeth),
        speed=conditions.speed_number(best.speed, cut.diameter) if is_speed_new else None,
        depth=best.depth if is_depth_new else None,
    )


def _record(plan: Plan, advised: _Advised) -> AdviceRecord:
    """Return the record that documents an advice in the file."""
    advice, cut = advised.advice, advised.cut
    before, after = advised.before, advised.after
    spindle = plan.machine.spindle
    available = max(point.power for point in spindle.curve)
    best = after.setting
    clockwise = -1.0 if advice.programmed.speed.scale < 0.0 else 1.0
    cutting = after.motor_power * spindle.efficiency
    removal = _removal_rate(cut, after)
    feed, speed = advice.programmed.feed, advice.programmed.speed
    raw_feed, raw_speed = feed.in_file(feed.value), speed.in_file(speed.value)
    is_feed = feed.quantity is ProgrammedQuantity.FEED
    is_spindle = speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
    engagement = cut.engagement
    bounds = _bounds(advice)
    if bounds.motor_power is not None:
        available = min(available, bounds.motor_power)
    is_time_critical = plan.mode is Mode.TC
    power_bound = bounds.motor_power
    return AdviceRecord(
        mode=plan.mode.value,
        id=advice.workingstep.operation.its_id,
        description=_description(advice),
        machine=plan.machine.name,
        material=plan.material.material.name,
        generator=GENERATOR,
        active_limit=advice.active.value if advice.active else "",
        number_of_passes=best.passes,
        feed_per_tooth=_predicted(best.feed),
        axial_depth=rounded(best.depth),
        machine_power=rounded(kw_from_watts(available)),
        cutting_power=_predicted(kw_from_watts(cutting)),
        spindle_speed=rounded(clockwise * best.speed),
        specific_cutting_resistance=_predicted(cutting * NMM_S_PER_WATT / removal),
        machining_time=_predicted(after.time),
        motor_power=_predicted(kw_from_watts(after.motor_power)),
        cutting_force=_predicted(after.cutting_force),
        energy=_predicted(after.energy),
        surface_roughness=_predicted(um_from_mm(after.roughness)) if after.roughness else None,
        contact_angle=rounded(deg_from_rad(engagement.contact_angle)) if engagement else None,
        immersion=immersion(engagement) if engagement else None,
        programmed_feedrate=raw_feed if is_feed else None,
        programmed_feedrate_per_tooth=None if is_feed else raw_feed,
        programmed_cutspeed=None if is_spindle else raw_speed,
        programmed_spindle=raw_speed if is_spindle else None,
        programmed_axial_depth=float(before.setting.depth),
        plunge_feed_per_tooth=None if best.plunge_feed is None else rounded(best.plunge_feed),
        feed_per_tooth_max=rounded(_greatest_feed(advised)) if is_time_critical else None,
        axial_depth_max=rounded(_greatest_depth(advised)) if is_time_critical else None,
        machine_power_bound=None
        if power_bound is None
        else rounded(kw_from_watts(power_bound)),
        feed_per_tooth_bound=bounds.feed_per_tooth,
        axial_depth_bound=bounds.axial_depth,
    )


def _description(advice: Advice) -> str:
    """Return the reason of an advice, and the required limits that could not be looked at."""
    unchecked = "; ".join(limit.words for limit in advice.unchecked)
    return f"{advice.reason}; unchecked: {unchecked}" if unchecked else advice.reason


def _bounds(advice: Advice) -> RecordLimits:
    """Return the limits of the record in the file that an advice keeps."""
    return NO_LIMITS if advice.conditions is None else advice.conditions.bounds


def _greatest_feed(advised: _Advised) -> float:
    """Return the greatest feed per tooth that the record or the tool allows, mm."""
    best, bound = advised.after.setting.feed, _bounds(advised.advice).feed_per_tooth
    if bound is not None:
        return max(best, bound)
    return max(best, best * _room(advised.after, LimitName.FEED_PER_TOOTH))


def _greatest_depth(advised: _Advised) -> float:
    """Return the greatest depth of a pass that the record or the tool allows, mm."""
    best, bound = advised.after.setting.depth, _bounds(advised.advice).axial_depth
    if bound is not None:
        return max(best, bound)
    return max(best, best * _room(advised.after, LimitName.AXIAL_DEPTH))


def _room(state: EvaluatedSetting, name: LimitName) -> float:
    """Return the least bound of a limit over its load; 1 where there is no such limit."""
    ratios = [
        load.bound / (load.limit.safety_factor * load.value)
        for load in state.loads
        if load.limit.name is name and load.limit.sense is BoundSide.AT_MOST and load.value > 0
    ]
    return min(ratios, default=1.0)


def _removal_rate(cut: Cut, after: EvaluatedSetting) -> float:
    """Material removal rate while the tool cuts, in mm³/s."""
    best = after.setting
    if cut.kind is CutKind.MILLING:
        return cut.radial_width * cut.depth_share * best.depth * after.feed
    if cut.kind is CutKind.DRILLING:
        return pi / 4.0 * (cut.diameter**2 - cut.previous_diameter**2) * after.feed
    width = cut.depth_share * best.depth
    if cut.kind is CutKind.GROOVING:
        width = cut.radial_width
    return width * best.feed * pi * cut.diameter * best.speed


def immersion(engagement: Engagement) -> str:
    """Return the type of face milling by its immersion: full, unilateral or bilateral."""
    half = 0.5 * pi
    if engagement.contact_angle >= 2.0 * half - 1e-9:
        return "FULL_IMMERSION"
    middle = 0.5 * (engagement.entry_angle + engagement.exit_angle)
    is_centred = abs(middle - half) < 1e-9
    return "BILATERAL_PART_IMMERSION" if is_centred else "UNIDIRECTIONAL_PART_IMMERSION"


def _predicted(value: float) -> float:
    """Round what follows from the written feed to fewer digits than the feed has.

    A second run reads the feed with the digits that were written, and must predict the same.
    """
    return float(f"{value:.9g}")
