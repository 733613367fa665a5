"""Grade of a tool of a tool table: that of the library, with what the table says instead."""

from dataclasses import replace

from simulator.spec import ToolGrade, WorkMaterial
from simulator.tool_table import TableTool
from simulator.tool_windows import grade_for


def grade_of_table_tool(tool: TableTool, material: WorkMaterial) -> ToolGrade | None:
    """Grade of a tool in a material.

    The vendor's windows of feed, speed and depth, helix angle and name of the grade replace
    those of the library where the table gives them.

    Parameters
    ----------
    tool : TableTool
    material : WorkMaterial

    Returns
    -------
    ToolGrade or None
        None if the library has no grade of this kind for the material.
    """
    grade = grade_for(tool.kind, tool.cutting_material, material)
    if grade is None:
        return None
    if tool.helix_angle is not None:
        grade = replace(grade, helix_angle=tool.helix_angle)
    if tool.grade:
        grade = replace(grade, name=tool.grade)
    if tool.min_feed is not None or tool.max_feed is not None:
        # A window in mm takes the place of one relative to the diameter.
        grade = replace(
            grade,
            min_feed_ratio=None,
            max_feed_ratio=None,
            min_feed=tool.min_feed,
            max_feed=tool.max_feed,
            borrowed="" if tool.max_feed is not None else grade.borrowed,
        )
    if tool.max_depth is not None:
        grade = replace(grade, max_depth=tool.max_depth)
    if tool.min_cutting_speed is not None or tool.max_cutting_speed is not None:
        grade = replace(
            grade,
            min_cutting_speed=tool.min_cutting_speed,
            max_cutting_speed=tool.max_cutting_speed,
        )
    return grade
