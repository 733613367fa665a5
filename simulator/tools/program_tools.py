"""Tools of a tool table as a program's file describes them."""

from math import isfinite, pi

from simulator.removal.cutter import Cutter, Insert
from simulator.spec import ToolKind
from simulator.tools.tool_table import TableTool
from stepnc_model.programs.user_tools import GivenInsert, GivenTool

BODIES = {
    ToolKind.FACEMILL: "FACEMILL",
    ToolKind.DRILL: "TWIST_DRILL",
    ToolKind.CENTER_DRILL: "CENTER_DRILL",
    ToolKind.COUNTERSINK: "COUNTERSINK",
    ToolKind.REAMER: "REAMER",
    ToolKind.BORING_BAR: "BORING_TOOL",
    ToolKind.TAP: "TAP",
}


def user_tool(tool: TableTool) -> GivenTool:
    """Tool of a table as data for a file that only names it."""
    shape = tool.shape
    if isinstance(shape, Insert):
        return GivenTool(
            number=tool.number,
            id=tool.id,
            body="GENERAL_TURNING_TOOL" if shape.width is None else "GROOVING_TOOL",
            diameter=0.0,
            teeth=1,
            corner_radius=shape.nose_radius,
            edge_length=tool.max_depth,
            insert=GivenInsert(
                cutting_edge_angle=shape.cutting_edge_angle,
                trailing_angle=shape.trailing_angle,
                width=shape.width,
                hand=shape.hand,
            ),
            edge_material=tool.cutting_material.value,
        )
    return GivenTool(
        number=tool.number,
        id=tool.id,
        body=BODIES.get(tool.kind) or _end_mill(shape),
        diameter=shape.diameter,
        teeth=tool.teeth,
        corner_radius=shape.corner_radius,
        edge_length=shape.edge_length if isfinite(shape.edge_length) else None,
        overhang=shape.overhang,
        point_angle=shape.point_angle if shape.point_angle < pi else None,
        edge_material=tool.cutting_material.value,
    )


def _end_mill(shape: Cutter) -> str:
    """Name of an end mill by its corner."""
    if shape.corner_radius <= 0.0:
        return "ENDMILL"
    is_ball = shape.corner_radius >= 0.5 * shape.diameter
    return "BALL_ENDMILL" if is_ball else "BULLNOSE_ENDMILL"
