"""The spindle speed where it is not free: as programmed, but never beyond tool and machine.

A speed below the recommended window costs time and wears an edge by other ways; one above it
burns the edge. So a speed is lowered to its bound and never raised, except to the least that
the spindle turns.
"""

from collections.abc import Iterator
from math import pi

from optimiser.conditions import Conditions
from optimiser.cut import Cut
from optimiser.limit import Limit, LimitName, Sense
from optimiser.limits import cutting_speed_window, speed_limits
from optimiser.workingstep import told
from simulator.edge_material import edge_material
from simulator.library import grade_for
from simulator.spec import CuttingMaterial, Machine, Material, ToolKind
from stepnc_model.technology import Programmed
from stepnc_model.tool import Tool
from stepnc_model.units import m_min_from_speed, rpm_from_rev_s

WRITTEN = 1e-6
"""relative excess that is the rounding of a number in a file"""


def held_speed(cut: Cut, at: Conditions) -> float:
    """Spindle speed of a workingstep whose speed is not free, rev/s."""
    passed = {
        limit.sense: limit.bound / limit.load.coefficient
        for limit in sorted(_passed(cut, at), key=_greatest_speed, reverse=True)
    }
    low, high = (passed.get(sense) for sense in (Sense.AT_LEAST, Sense.AT_MOST))
    return high or low or cut.programmed.speed


def why_too_fast(cut: Cut, at: Conditions) -> str:
    """Which limit the programmed speed passes; empty where it keeps all."""
    speed = cut.programmed.speed
    passed = min(_passed(cut, at), key=_greatest_speed, default=None)
    return "" if passed is None else told(passed, passed.load.value(1.0, 1.0, speed), speed)


def why_thread_too_fast(
    tool: Tool,
    conditions: Programmed,
    machine: Machine,
    material: Material,
    *,
    diameter: float,
) -> str:
    """What the speed of a thread passes, whose cut nothing else is known of; else empty.

    Parameters
    ----------
    tool : Tool
    conditions : Programmed
    machine : Machine
    material : Material
    diameter : float
        Of the thread, mm; 0: not known, so nothing is.
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
    at = Conditions(
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


def _passed(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Limits that the programmed speed passes; below the window of the tool it may be."""
    speed = cut.programmed.speed
    for limit in speed_limits(cut, at):
        is_most = limit.sense is Sense.AT_MOST
        if not is_most and limit.name is LimitName.CUTTING_SPEED:
            continue
        ratio = limit.load.value(1.0, 1.0, speed) / limit.bound
        if ratio > 1.0 + WRITTEN if is_most else ratio < 1.0 - WRITTEN:
            yield limit


def _greatest_speed(limit: Limit) -> float:
    """Spindle speed at the bound of a limit, rev/s."""
    return limit.bound / limit.load.coefficient
