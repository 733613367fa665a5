"""What cannot be cut at all, with the reason: a tool that is unsuited, or that nobody makes."""

from optimiser import workingstep as exact
from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.limits import allowance_limits
from optimiser.problem import BoundSide
from optimiser.speed_limits import why_no_speed
from simulator.edge_material import edge_material
from simulator.spec import CuttingMaterial, Machine, WorkMaterial
from simulator.tool_windows import why_unsuited
from stepnc_model.tool import Tool


def why_impossible(cut: Cut, at: CuttingConditions, tool: Tool) -> str:
    """Reason why this tool cannot cut this material; empty if it can, or if nothing is known.

    A machine with only stated limits knows nothing beyond its source.
    """
    if at.machine.only_stated_limits:
        return ""
    if at.grade is None:
        return f"the library knows no such tool of {at.cutting_material} as '{tool.id}'"
    return (
        why_unsuited(at.cutting_material, at.material)
        or why_no_speed(cut, at)
        or _why_not_reamed(cut, at)
    )


def _why_not_reamed(cut: Cut, at: CuttingConditions) -> str:
    """Allowance that a reamer cannot take off; empty if it can, or if it is too small."""
    for limit in allowance_limits(cut, at):
        if limit.sense is BoundSide.AT_MOST and not limit.holds(1.0, 1.0, 1.0):
            return f"{exact.told(limit, limit.load.value(1.0, 1.0, 1.0), 1.0)} {limit.origin}"
    return ""


def why_thread_impossible(tool: Tool, machine: Machine, material: WorkMaterial) -> str:
    """Reason why a threading tool cannot cut this material; empty if it can."""
    if machine.only_stated_limits:
        return ""
    edge = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    return why_unsuited(edge, material)
