"""Limits on cutting speed and spindle speed, and the speed that is kept where it is not free.

Where the spindle speed is not free it stays as programmed, but never above what tool and
machine allow. A speed below the recommended window costs time and wears the edge in other
ways; a speed above it burns the edge. So a speed is lowered to its bound and never raised,
except to the least speed of the spindle.

Bound of a tool with its origin: of its own window, of another group, or without a source.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, pi

from optimiser.bounds.chip_load import borrowed_datum
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.solver.problem import BoundSide, Limit, LimitName, Monomial
from optimiser.solver.workingstep import violation_text
from simulator.library import find_window
from simulator.physics.holding import usable_speed
from simulator.spec import CuttingMaterial, Machine, ToolKind, WorkMaterial
from simulator.tool_kind import edge_material
from simulator.tools.tool_table import grade_for
from simulator.work_holding import Chuck
from stepnc_model.programs.technology import Programmed
from stepnc_model.programs.tool import Tool
from stepnc_model.units import m_min_from_speed, rpm_from_rev_s


@dataclass(frozen=True, slots=True, kw_only=True)
class SourcedBound:
    """Bound with its origin, and the datum that would bring a better one."""

    bound: float | None = None
    origin: str = ""
    datum: str = ""


def borrowed_bound(bound: float, programmed: float, at: CuttingConditions) -> SourcedBound:
    """Bound by a window of the tool: one of another group does not slow a program down."""
    if at.grade is None or not at.grade.borrowed:
        return SourcedBound(bound=bound)
    above = "as programmed, above " if programmed > bound else ""
    origin = f"{above}{at.grade.borrowed}"
    return SourcedBound(bound=max(bound, programmed), origin=origin, datum=borrowed_datum(at))


M_MIN, RPM = m_min_from_speed(1.0), rpm_from_rev_s(1.0)
"""Factors from canonical units to user units."""

WRITTEN = 1e-6
"""Relative excess that is attributed to the rounding of numbers in a file."""


def speed_range(cut: Cut, at: CuttingConditions) -> tuple[float, float]:
    """Least and greatest spindle speed allowed by machine and tool, rev/s."""
    low, high = 0.0, inf
    for limit in speed_limits(cut, at):
        bound = limit.bound / limit.load.coefficient
        if limit.sense is BoundSide.AT_MOST:
            high = min(high, bound)
        else:
            low = max(low, bound)
    return low, high


def speed_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on cutting speed and spindle speed."""
    low, high = cutting_speed_window(at)[0], _greatest_cutting_speed(cut, at)
    spindle = at.machine.spindle
    velocity = Monomial(coefficient=pi * cut.diameter, speed_exponent=1.0)
    turning = Monomial(coefficient=1.0, speed_exponent=1.0)
    for name, load, bound, sense in (
        (LimitName.CUTTING_SPEED, velocity, high.bound, BoundSide.AT_MOST),
        (LimitName.CUTTING_SPEED, velocity, low, BoundSide.AT_LEAST),
        (LimitName.SPINDLE_SPEED, turning, spindle.max_speed, BoundSide.AT_MOST),
        (LimitName.SPINDLE_SPEED, turning, spindle.min_speed, BoundSide.AT_LEAST),
        (LimitName.SPINDLE_SPEED, turning, _chuck_speed(at), BoundSide.AT_MOST),
    ):
        if bound is None or bound <= 0.0:
            continue
        is_velocity = name is LimitName.CUTTING_SPEED
        yield Limit(
            name=name,
            load=load,
            bound=bound,
            sense=sense,
            unit="m/min" if is_velocity else "rpm",
            scale=M_MIN if is_velocity else RPM,
            step=10.0 if is_velocity else 100.0,
            origin=high.origin if is_velocity and sense is BoundSide.AT_MOST else "",
            datum=high.datum if is_velocity and sense is BoundSide.AT_MOST else "",
        )


def _greatest_cutting_speed(cut: Cut, at: CuttingConditions) -> SourcedBound:
    """Greatest cutting speed, mm/s; the programmed one without a source."""
    high, grade = cutting_speed_window(at)[1], at.grade
    if grade is None or at.machine.only_stated_limits:
        return SourcedBound(bound=high)
    given = pi * cut.diameter * cut.programmed.speed
    if high is None:
        datum = f"a [[window]] of {at.cutting_material} in the file of '{at.material.name}'"
        origin = f"no source for more with {grade.name}"
        return SourcedBound(bound=given, origin=origin, datum=datum)
    if high != grade.max_cutting_speed:
        return SourcedBound(bound=high)
    return borrowed_bound(high, given, at)


def _chuck_speed(at: CuttingConditions) -> float | None:
    """Speed above which a chuck holds too little to be used, rev/s; None for other holding."""
    if not isinstance(at.holding, Chuck):
        return None
    speed = usable_speed(at.holding)
    return None if speed == inf else speed


def cutting_speed_window(at: CuttingConditions) -> tuple[float | None, float | None]:
    """Recommended cutting speeds of the grade, or else of the material, mm/s."""
    grade = at.grade
    if grade is None:
        return None, None
    window = find_window(at.material, grade.tool_kind, at.cutting_material)
    low, high = grade.min_cutting_speed, grade.max_cutting_speed
    if grade.borrowed:
        # What the material's own file says goes before what another group says.
        if window is None or window.max_cutting_speed is None:
            return None, high
        return window.min_cutting_speed, window.max_cutting_speed
    if window is not None:
        low = low if low is not None else window.min_cutting_speed
        high = high if high is not None else window.max_cutting_speed
    return low, high


def held_speed(cut: Cut, at: CuttingConditions) -> float:
    """Spindle speed of a workingstep whose speed is not free, rev/s."""
    passed = {
        limit.sense: limit.bound / limit.load.coefficient
        for limit in sorted(_passed_speeds(cut, at), key=_greatest_speed, reverse=True)
    }
    low, high = (passed.get(sense) for sense in (BoundSide.AT_LEAST, BoundSide.AT_MOST))
    return high or low or cut.programmed.speed


def why_too_fast(cut: Cut, at: CuttingConditions) -> str:
    """Text naming the limit that the programmed speed exceeds; empty if it exceeds none."""
    speed = cut.programmed.speed
    passed = min(_passed_speeds(cut, at), key=_greatest_speed, default=None)
    return (
        ""
        if passed is None
        else violation_text(passed, passed.load.value(1.0, 1.0, speed), speed)
    )


def why_no_speed(cut: Cut, at: CuttingConditions) -> str:
    """Text on a spindle that cannot turn as slowly as the tool demands; empty if it can."""
    low, high = speed_range(cut, at)
    least = at.machine.spindle.min_speed
    if least is None or not low > high * (1.0 + WRITTEN) or low > least * (1.0 + WRITTEN):
        return ""
    limits = [each for each in speed_limits(cut, at) if each.sense is BoundSide.AT_MOST]
    passed = min(limits, key=_greatest_speed)
    words = violation_text(passed, passed.load.value(1.0, 1.0, least), least)
    return f"{words} at the least speed of the spindle, {rpm_from_rev_s(least):.4g} rpm"


def why_thread_too_fast(
    tool: Tool,
    conditions: Programmed,
    machine: Machine,
    material: WorkMaterial,
    *,
    diameter: float,
) -> str:
    """Text naming the limit that the speed of a thread exceeds; empty if it exceeds none.

    Parameters
    ----------
    diameter : float
        Thread diameter, mm; 0: not known, so the speed is not checked.
    """
    if diameter <= 0.0:
        return ""
    spindle = conditions.spindle_speed(diameter)
    highest = machine.spindle.max_speed
    if highest is not None and spindle > highest * (1.0 + WRITTEN):
        return (
            f"spindle speed {rpm_from_rev_s(spindle):.4g} rpm exceeds "
            f"{rpm_from_rev_s(highest):.4g} rpm"
        )
    edge = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    kind = ToolKind.TAP if tool.keyword == "TAP" else ToolKind.THREADING
    at = CuttingConditions(
        machine=machine,
        material=material,
        cutting_material=edge,
        grade=grade_for(kind, edge, material),
        roughness=None,
    )
    high = cutting_speed_window(at)[1]
    velocity = pi * diameter * spindle
    if high is None or velocity <= high * (1.0 + WRITTEN):
        return ""
    return (
        f"cutting speed {m_min_from_speed(velocity):.4g} m/min exceeds "
        f"{m_min_from_speed(high):.4g} m/min"
    )


def _passed_speeds(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Speed limits that the programmed speed violates, except the tool's least speed."""
    speed = cut.programmed.speed
    for limit in speed_limits(cut, at):
        is_most = limit.sense is BoundSide.AT_MOST
        if not is_most and limit.name is LimitName.CUTTING_SPEED:
            continue
        ratio = limit.load.value(1.0, 1.0, speed) / limit.bound
        if ratio > 1.0 + WRITTEN if is_most else ratio < 1.0 - WRITTEN:
            yield limit


def _greatest_speed(limit: Limit) -> float:
    """Spindle speed at the bound of a speed limit, rev/s."""
    return limit.bound / limit.load.coefficient
