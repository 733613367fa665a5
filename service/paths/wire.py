"""Tool paths as JSON. Keys carry their units."""

from typing import Any

from service.paths.toolpaths import Paths
from service.wire import dump, finding_json
from stepnc_model.toolpath.function import Function
from stepnc_model.toolpath.path import Dwell, Move, SpindleSpeed, Step, ToolPath
from stepnc_model.units import deg_from_rad, mm_min_from_speed


def paths_json(paths: Paths) -> str:
    """Every move of every tool path."""
    return dump({
        "program": paths.program.name,
        "clamping_positions_mm": paths.clamps,
        "items": [_item(item) for item in paths.items],
        "left_out": [str(fault) for fault in paths.faults],
        "findings": [finding_json(finding) for finding in paths.findings],
    })


def _item(item: ToolPath | Function) -> dict[str, Any]:
    """A tool path or a function."""
    if isinstance(item, Function):
        return {"function": item.keyword, "id": item.id, "text": item.text}
    return {
        "workingstep": str(item.workingstep),
        "id": item.id,
        "operation": str(item.operation_ref),
        "tool": None if item.tool_ref is None else str(item.tool_ref),
        "start_mm": item.start,
        "steps": [_step(step) for step in item.steps],
    }


def _step(step: Step) -> dict[str, Any]:
    """A move, a pause, or what the spindle does."""
    if isinstance(step, Dwell):
        return {"dwell_s": step.seconds, "dwell_revolutions": step.revolutions}
    if isinstance(step, SpindleSpeed):
        return {"spindle_technology": str(step.technology)}
    if not isinstance(step, Move):
        return {"spindle": step.value}
    found: dict[str, Any] = {"type": step.type.value, "end_mm": step.end}
    if step.arc is not None:
        found["arc"] = {
            "centre_mm": step.arc.centre,
            "turn_deg": deg_from_rad(step.arc.turn),
            "plane": step.arc.plane.value,
        }
    if step.feed is not None:
        feed = step.feed
        found["feed"] = {
            "technology": str(feed.technology),
            "ratio": feed.ratio,
            "speed_ratio": feed.speed_ratio,
            "per_revolution_mm": feed.per_revolution,
            "velocity_mm_min": None
            if feed.velocity is None
            else mm_min_from_speed(feed.velocity),
            "is_synchronised": feed.is_synchronised,
        }
    return found
