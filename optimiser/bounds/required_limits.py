"""Limits that must be looked at before advice counts as checked, by kind of tool.

A limit that has no bound of its own, or that stands on windows of another group, is listed with
the datum that would bring it. Measured modes of vibration and work-holding are not required:
hardly any shop has them, so stability is told as a risk and work-holding as its demand.

Cuts that are impossible, with the reason: a tool that is unsuited, or that nobody makes.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from optimiser.bounds.limits import allowance_limits
from optimiser.bounds.speed_limits import why_no_speed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, Texture
from optimiser.solver import workingstep as exact
from optimiser.solver.problem import BoundSide, Limit, LimitName
from simulator.spec import CuttingMaterial, Machine, ToolKind, WorkMaterial
from simulator.tool_kind import edge_material
from simulator.tools.tool_table import why_unsuited
from stepnc_model.programs.tool import Tool

CHIP = (LimitName.FEED_PER_TOOTH, LimitName.CUTTING_SPEED, LimitName.MOTOR_POWER)
"""Limits required of every tool whose feed may be chosen."""

SURFACE = (LimitName.ROUGHNESS,)
"""Limit required of tools that leave a surface, where a roughness is asked for."""

REQUIRED: dict[ToolKind, tuple[LimitName, ...]] = {
    ToolKind.ENDMILL: (*CHIP, LimitName.AXIAL_DEPTH, LimitName.SHANK_STRENGTH, *SURFACE),
    ToolKind.FACEMILL: (*CHIP, LimitName.AXIAL_DEPTH, *SURFACE),
    ToolKind.DRILL: CHIP,
    ToolKind.CENTER_DRILL: CHIP,
    ToolKind.COUNTERSINK: CHIP,
    ToolKind.REAMER: (*CHIP, LimitName.ALLOWANCE, *SURFACE),
    ToolKind.BORING_BAR: (*CHIP, *SURFACE),
    ToolKind.TURNING: (*CHIP, LimitName.AXIAL_DEPTH, *SURFACE),
    ToolKind.GROOVING: CHIP,
    ToolKind.TAP: (LimitName.CUTTING_SPEED,),
    ToolKind.THREADING: (LimitName.CUTTING_SPEED,),
}
"""Limits that each kind of tool must have."""

DATA = {
    LimitName.FEED_PER_TOOTH: "a greatest feed: max_feed_mm of the tool in a tool table",
    LimitName.CUTTING_SPEED: "a [[window]] of cutting speeds in the material's file",
    LimitName.AXIAL_DEPTH: "cutting_edge_length of the tool",
    LimitName.MOTOR_POWER: "the power curve of the machine's spindle",
    LimitName.SHANK_STRENGTH: "the engagement of the tool: a tool path and a stock",
    LimitName.ALLOWANCE: "previous_diameter of the operation, or the drilling before it",
    LimitName.ROUGHNESS: "a measured roughness of this tool: its feed does not determine it",
}
"""Datum that brings each required limit where nothing better is known."""

CORNER_DATUM = "edge_radius of the tool, from which the roughness follows"
TEETH_DATUM = 'number_of_teeth of the tool (--teeth "TOOL=N")'


@dataclass(frozen=True, slots=True, kw_only=True)
class UncheckedLimit:
    """Required limit that could not be looked at, or only by a stand-in."""

    name: LimitName
    why: str
    datum: str
    """What would bring the limit."""

    @property
    def words(self) -> str:
        """Name of the limit, and what would bring it."""
        return f"{self.name.words}, give {self.datum}"


def unchecked_limits(
    cut: Cut, at: CuttingConditions, limits: tuple[Limit, ...]
) -> tuple[UncheckedLimit, ...]:
    """Required limits of a cut that could not be looked at.

    Parameters
    ----------
    at : CuttingConditions
        On a machine with only stated limits nothing else is required.
    limits : tuple of Limit
        Limits that were applied.
    """
    if at.machine.only_stated_limits or cut.is_air:
        return ()
    return tuple(_unchecked(cut, at, limits))


def _unchecked(
    cut: Cut, at: CuttingConditions, limits: tuple[Limit, ...]
) -> Iterator[UncheckedLimit]:
    most = [limit for limit in limits if limit.sense is BoundSide.AT_MOST]
    for name in REQUIRED[cut.tool_kind]:
        if name is LimitName.ROUGHNESS and at.roughness is None:
            continue
        found = [limit for limit in most if name in {limit.name, limit.stands_for}]
        missing = next((limit for limit in found if limit.datum), None)
        if missing is not None:
            borrowed = at.grade.borrowed if at.grade is not None else ""
            why = borrowed or missing.origin
            yield UncheckedLimit(name=name, why=why, datum=missing.datum)
        elif not found:
            datum = DATA[name]
            if name is LimitName.ROUGHNESS and _lacks_corner(cut):
                datum = CORNER_DATUM
            yield UncheckedLimit(name=name, why="no source gives a bound", datum=datum)
        elif name is LimitName.FEED_PER_TOOTH and _lacks_teeth(cut):
            yield UncheckedLimit(name=name, why="one tooth is assumed", datum=TEETH_DATUM)


def _lacks_corner(cut: Cut) -> bool:
    """True if the roughness of a mill is unknown only for want of its corner radius."""
    is_mill = cut.tool_kind in {ToolKind.ENDMILL, ToolKind.FACEMILL}
    return is_mill and cut.texture is Texture.NONE and not cut.tool.corner_radius


def _lacks_teeth(cut: Cut) -> bool:
    """True if the number of teeth of a rotating tool is assumed."""
    return not cut.kind.is_turned and not cut.tool.has_teeth


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
        or _unreamable_allowance(cut, at)
    )


def _unreamable_allowance(cut: Cut, at: CuttingConditions) -> str:
    """Allowance that a reamer cannot take off; empty if it can, or if it is too small."""
    for limit in allowance_limits(cut, at):
        if limit.sense is BoundSide.AT_MOST and not limit.holds(1.0, 1.0, 1.0):
            load = limit.load.value(1.0, 1.0, 1.0)
            return f"{exact.violation_text(limit, load, 1.0)} {limit.origin}"
    return ""


def why_thread_impossible(tool: Tool, machine: Machine, material: WorkMaterial) -> str:
    """Reason why a threading tool cannot cut this material; empty if it can."""
    if machine.only_stated_limits:
        return ""
    edge = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    return why_unsuited(edge, material)
