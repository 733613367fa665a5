"""Tool paths as text and JSON. Keys carry their units."""

from dataclasses import dataclass
from typing import Any

from service.paths.toolpaths import Paths
from service.rendering.columns import Column
from service.rendering.records import dump, finding_record
from service.rendering.text import print_findings, print_line, print_table
from stepnc_model.toolpath.path import (
    Dwell,
    Function,
    Move,
    MoveType,
    SpindleSpeedChange,
    Step,
    ToolPath,
    length,
)
from stepnc_model.units import deg_from_rad, mm_min_from_speed


@dataclass(frozen=True, slots=True, kw_only=True)
class PathRow:
    """Row of the path table: a tool path with its lengths in mm, or a stop between paths."""

    name: str
    operation: str
    tool: str = ""
    moves: int | None = None
    arcs: int | None = None
    contact: float | None = None
    air: float | None = None
    rapid: float | None = None
    lowest: float | None = None


PATHS: tuple[Column[PathRow], ...] = (
    Column(heading="workingstep", value=lambda row: row.name, is_key=True),
    Column(heading="operation", value=lambda row: row.operation),
    Column(heading="tool", value=lambda row: row.tool),
    Column(heading="moves", value=lambda row: row.moves),
    Column(heading="arcs", value=lambda row: row.arcs),
    Column(heading="contact mm", form=".0f", value=lambda row: row.contact),
    Column(heading="air mm", form=".0f", value=lambda row: row.air),
    Column(heading="rapid mm", form=".0f", value=lambda row: row.rapid),
    Column(heading="lowest z", form="g", value=lambda row: row.lowest),
)


def print_paths(paths: Paths) -> None:
    """Print a row for each tool path, then the assumptions made."""
    print_line(f"{paths.program.name}: {len(paths.paths)} tool paths")
    print_table(PATHS, [_row(paths, item) for item in paths.items])
    print_findings(paths.findings, told=paths.told)


def _row(paths: Paths, item: ToolPath | Function) -> PathRow:
    if isinstance(item, Function):
        return PathRow(name=item.id, operation=item.keyword.lower())
    contact = air = rapid = 0.0
    for start, move in item.segments():
        size = length(start, move)
        if move.feed is None:
            rapid += size
        elif move.type is MoveType.CONTACT:
            contact += size
        else:
            air += size
    program = paths.program
    tool = program.get(item.tool_ref) if item.tool_ref is not None else None
    return PathRow(
        name=item.id,
        operation=program.file.keyword(int(item.operation_ref)).lower(),
        tool=getattr(tool, "its_id", ""),
        moves=len(item.moves),
        arcs=sum(move.arc is not None for move in item.moves),
        contact=contact,
        air=air,
        rapid=rapid,
        lowest=min((move.end[2] for move in item.moves), default=item.start[2]),
    )


def paths_json(paths: Paths) -> str:
    """Return every move of every tool path as JSON."""
    return dump({
        "program": paths.program.name,
        "clamping_positions_mm": paths.clamps,
        "items": [_item(item) for item in paths.items],
        "left_out": [str(fault) for fault in paths.faults],
        "findings": [finding_record(finding) for finding in paths.findings],
    })


def _item(item: ToolPath | Function) -> dict[str, Any]:
    """Return a tool path or a function as a JSON object."""
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
    """Return a move, a dwell or a spindle command as a JSON object."""
    if isinstance(step, Dwell):
        return {"dwell_s": step.seconds, "dwell_revolutions": step.revolutions}
    if isinstance(step, SpindleSpeedChange):
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
