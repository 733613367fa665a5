"""Shape of a program's tool, as the removal of material needs it."""

from math import inf, pi

from simulator.removal.cutter import Cutter, Insert
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.tools import MillingCuttingTool, TaperedEndmill
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.tool import Tool, tool_of
from stepnc_model.units import rad_from_deg

CUSTOMARY_POINT = rad_from_deg(118.0)

DRILLS = {"TWIST_DRILL", "SPADE_DRILL", "STEP_DRILL", "DRILL"}

ENDS = DRILLS | {"CENTER_DRILL", "COUNTERSINK", "COUNTERBORE", "REAMER", "TAPERED_REAMER"}
"""bodies that cut with their end only"""

THREADS = {"TAP", "TAPERED_TAP", "COMBINED_DRILL_AND_TAP", "TURNING_THREADING_TOOL"}
"""what they cut is no part of a stock's map"""


def shape_of(program: Program, ref: Ref[Entity]) -> Cutter | Insert | None:
    """Shape of a tool; None where its cut is not modelled: threads.

    Raises
    ------
    SchemaError
        When the tool cannot be used.
    """
    tool, entity = tool_of(program, ref), program.get(ref)
    if tool.keyword in THREADS:
        return None
    if isinstance(entity, TurningMachineCuttingTool):
        return _insert(tool, entity)
    return _cutter(program, tool, entity)


def _insert(tool: Tool, entity: Entity) -> Insert:
    radius, width = tool.corner_radius or 0.0, tool.width
    return Insert(
        nose_radius=radius if width is None else min(radius, 0.5 * width),
        cutting_edge_angle=tool.cutting_edge_angle,
        width=width,
        hand=getattr(entity, "hand_of_tool", None) or HandOfToolType.RIGHT,
    )


def _cutter(program: Program, tool: Tool, entity: Entity) -> Cutter:
    is_end = tool.keyword in ENDS
    point = tool.point_angle or (CUSTOMARY_POINT if tool.keyword in DRILLS else pi)
    return Cutter(
        diameter=tool.diameter,
        corner_radius=0.0 if is_end else min(tool.corner_radius or 0.0, 0.5 * tool.diameter),
        taper_angle=_taper(program, entity),
        point_angle=point if is_end else pi,
        teeth=tool.teeth,
        edge_length=tool.cutting_edge_length or inf,
        cutting_edge_angle=tool.cutting_edge_angle,
        is_drill=is_end,
    )


def _taper(program: Program, entity: Entity) -> float:
    body = program.get(entity.its_tool_body) if isinstance(entity, MillingCuttingTool) else None
    angle = body.taper_angle if isinstance(body, TaperedEndmill) else None
    return rad_from_deg(angle) if angle else 0.0
