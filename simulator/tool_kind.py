"""Kind of a tool from its name in EXPRESS, as plans and runs take it."""

from simulator.spec import ToolKind
from stepnc_model.tool import Tool

KINDS = {
    "FACEMILL": ToolKind.FACEMILL,
    "TWIST_DRILL": ToolKind.DRILL,
    "SPADE_DRILL": ToolKind.DRILL,
    "STEP_DRILL": ToolKind.DRILL,
    "DRILL": ToolKind.DRILL,
    "CENTER_DRILL": ToolKind.CENTER_DRILL,
    "COUNTERSINK": ToolKind.COUNTERSINK,
    "COUNTERBORE": ToolKind.COUNTERSINK,
    "REAMER": ToolKind.REAMER,
    "TAPERED_REAMER": ToolKind.REAMER,
    "BORING_TOOL": ToolKind.BORING_BAR,
    "TAP": ToolKind.TAP,
    "TAPERED_TAP": ToolKind.TAP,
    "COMBINED_DRILL_AND_TAP": ToolKind.TAP,
    "GROOVING_TOOL": ToolKind.GROOVING,
    "TURNING_THREADING_TOOL": ToolKind.THREADING,
    "GENERAL_TURNING_TOOL": ToolKind.TURNING,
    "USER_DEFINED_TURNING_TOOL": ToolKind.TURNING,
    "KNURLING_TOOL": ToolKind.TURNING,
}

LEAST_FACEMILL = 25.0
"""Least diameter of a face mill, mm; files call smaller end mills FACEMILL too."""


def tool_kind(tool: Tool) -> ToolKind:
    """Kind of a tool from its EXPRESS name; an end mill if the name is not listed."""
    kind = KINDS.get(tool.keyword, ToolKind.ENDMILL)
    if kind is ToolKind.FACEMILL and tool.diameter < LEAST_FACEMILL:
        return ToolKind.ENDMILL
    return kind
