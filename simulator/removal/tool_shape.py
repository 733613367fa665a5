"""Shape of a program's tool for the simulation of material removal. Units mm and rad."""

from math import inf, pi

from simulator.physics.drilling import edge_angle
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.removal.profile import profile_of
from simulator.spec import ToolKind
from simulator.tool_kind import tool_kind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.tools import CuttingTool, MillingCuttingTool, TaperedEndmill
from stepnc_model.entities.turning_tools import (
    GroovingTool,
    KnurlingTool,
    TurningMachineCuttingTool,
)
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.tool import Tool, tool_of
from stepnc_model.units import rad_from_deg

HOLDER_SHARE = 2.0
"""Diameter of a holder over that of its tool if the program gives none, as for a collet
chuck."""


STEEPEST_DEG = 80.0
"""Largest angle between the flank of a tapered tool and its axis, degrees."""

ENDS = {ToolKind.DRILL, ToolKind.CENTER_DRILL, ToolKind.REAMER, ToolKind.COUNTERSINK}
"""Kinds of tools that cut with their end only."""

THREADS = {ToolKind.TAP, ToolKind.THREADING}
"""Kinds of tools that cut threads, which the map of a stock cannot represent."""


def shape_of(program: Program, ref: Ref[Entity]) -> Cutter | Insert | None:
    """Shape of a tool; None if the map cannot represent its cut (threads, knurls).

    Raises
    ------
    SchemaError
        If the tool cannot be used.
    """
    tool, entity = tool_of(program, ref), program.get(ref)
    if tool_kind(tool) in THREADS or isinstance(entity, KnurlingTool):
        return None
    try:
        if isinstance(entity, TurningMachineCuttingTool):
            return _insert(program, tool, entity)
        shape = _cutter(program, tool, entity)
        profile_of(shape, reach=shape.diameter)
    except ValueError as error:
        raise program.error(str(error), ref) from error
    return shape


def _insert(program: Program, tool: Tool, entity: TurningMachineCuttingTool) -> Insert:
    width, radius = tool.width, tool.corner_radius or 0.0
    if isinstance(entity, GroovingTool) and entity.corner_radius is not None:
        radius = entity.corner_radius
    shape = Insert(
        nose_radius=radius if width is None else min(radius, 0.5 * width),
        cutting_edge_angle=tool.cutting_edge_angle,
        width=width,
        hand=entity.hand_of_tool or HandOfToolType.RIGHT,
    )
    included = program.get(entity.cutting_edge).tool_included_angle
    if not included or width is not None:
        return shape
    trailing = pi - tool.cutting_edge_angle - rad_from_deg(included)
    return Insert(
        nose_radius=shape.nose_radius,
        cutting_edge_angle=shape.cutting_edge_angle,
        trailing_angle=min(max(trailing, 0.0), 0.49 * pi),
        hand=shape.hand,
    )


def _cutter(program: Program, tool: Tool, entity: Entity) -> Cutter:
    kind = tool_kind(tool)
    is_end = kind in ENDS
    return Cutter(
        diameter=tool.diameter,
        corner_radius=0.0 if is_end else min(tool.corner_radius or 0.0, 0.5 * tool.diameter),
        taper_angle=_taper(program, entity),
        point_angle=2.0 * edge_angle(kind, tool.point_angle) if is_end else pi,
        teeth=tool.teeth,
        edge_length=tool.cutting_edge_length or inf,
        cutting_edge_angle=tool.cutting_edge_angle,
        is_drill=is_end,
        holder=_holder(tool, entity),
    )


def _taper(program: Program, entity: Entity) -> float:
    if not isinstance(entity, MillingCuttingTool) or entity.its_tool_body is None:
        return 0.0
    body = program.get(entity.its_tool_body)
    angle = body.taper_angle if isinstance(body, TaperedEndmill) else None
    if angle is not None and not 0.0 <= angle <= STEEPEST_DEG:
        message = f"taper angle {angle:g}° is out of range; allowed: 0 to {STEEPEST_DEG:g}°"
        raise program.error(message, entity.its_tool_body, "taper_angle")
    return rad_from_deg(angle) if angle else 0.0


def _holder(tool: Tool, entity: Entity) -> Holder | None:
    """Collet chuck at the tool's assembly length; None if no length is given."""
    length = entity.overall_assembly_length if isinstance(entity, CuttingTool) else None
    if not length:
        return None
    return Holder(diameter=HOLDER_SHARE * tool.diameter, overhang=length)
