"""Results of ``toolpath``: tool paths of a STEP-NC program, or moves of NC code."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, overload

from service.errors import BAD_INPUT, OK
from service.programs.toolpaths import Paths
from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from service.verbs.toolpath.stretches import ToolStretch, called_tool, stretches, tool_label
from stepnc_model.nc.moves import NcMove, NcMoves
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.text import NcText
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.path import (
    Dwell,
    Function,
    Move,
    MoveType,
    Point,
    SpindleSpeedChange,
    Step,
    ToolPath,
)
from stepnc_model.units import deg_from_rad, mm_min_from_speed, rpm_from_rev_s


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
    Column(key="workingstep", heading="workingstep", value=lambda row: row.name, is_key=True,
           kind=str),
    Column(key="operation", heading="operation", value=lambda row: row.operation, kind=str),
    Column(key="tool", heading="tool", value=lambda row: row.tool, kind=str),
    Column(key="moves", heading="moves", value=lambda row: row.moves, kind=int),
    Column(key="arcs", heading="arcs", value=lambda row: row.arcs, kind=int),
    Column(key="contact_mm", heading="contact mm", form=".0f", value=lambda row: row.contact),
    Column(key="air_mm", heading="air mm", form=".0f", value=lambda row: row.air),
    Column(key="rapid_mm", heading="rapid mm", form=".0f", value=lambda row: row.rapid),
    Column(key="lowest_z_mm", heading="lowest z", form="g", value=lambda row: row.lowest),
)  # fmt: skip

STRETCHES: tuple[Column[ToolStretch], ...] = (
    Column(key="tool", heading="tool", value=lambda row: row.tool, is_key=True, kind=str),
    Column(key="first_line", heading="from line", value=lambda row: row.first_line, kind=int),
    Column(key="moves", heading="moves", value=lambda row: row.moves, kind=int),
    Column(key="arcs", heading="arcs", value=lambda row: row.arcs, kind=int),
    Column(key="feed_mm", heading="feed mm", form=".0f", value=lambda row: row.feed),
    Column(key="rapid_mm", heading="rapid mm", form=".0f", value=lambda row: row.rapid),
    Column(
        key="unknown", heading="unknown", value=lambda row: row.unknown or None, kind=int,
        help="moves of which start, end or centre are not known", is_optional=True,
    ),
    Column(key="lowest_z_mm", heading="lowest z", form="g", value=lambda row: row.lowest),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToolPathResult(Result):
    """Tool paths of a STEP-NC program."""

    paths: Paths

    @property
    def exit_code(self) -> int:
        """Exit code of the command line; bad input if a workingstep was left out."""
        return BAD_INPUT if self.paths.faults else OK

    def picture(self) -> bytes:
        """Draw the paths as a PNG picture."""
        from service.verbs.toolpath.plot import path_png, sections_of_paths  # noqa: PLC0415 (matplotlib takes a second)

        paths = self.paths
        sections = sections_of_paths(paths.paths)
        return path_png(sections, paths.stock, paths.clamps, title=paths.program.name)

    def view(self) -> ResultView:
        """Return a row for each tool path, every move for programs, and the assumptions."""
        paths = self.paths
        return ResultView([
            TextLine(text=f"{paths.program.name}: {counted(len(paths.paths), 'tool path')}"),
            Fact(key="program", value=paths.program.name),
            Fact(key="clamping_positions_mm", value=paths.clamps),
            Fact(key="items", value=lambda: [_item(item) for item in paths.items]),
            Table(key="paths", columns=PATHS, rows=[_row(paths, item) for item in paths.items]),
            Fact(key="left_out", value=[str(fault) for fault in paths.faults]),
            Findings(findings=paths.findings, reported=paths.reported),
        ])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CodePathResult(Result):
    """Moves of NC code."""

    name: str
    program: NcProgram
    stock: Stock | None
    """Raw part that is drawn; None if none is given."""

    def picture(self) -> bytes:
        """Draw the moves as a PNG picture."""
        from service.verbs.toolpath.plot import path_png, sections_of_code  # noqa: PLC0415 (matplotlib takes a second)

        return path_png(sections_of_code(self.program), self.stock, title=self.name)

    def view(self) -> ResultView:
        """Return a row for each stretch of a tool, every move for programs, and findings."""
        program = self.program
        hints = f" (guessed from {', '.join(program.hints)})" if program.hints else ""
        return ResultView([
            TextLine(
                text=f"{self.name}: {program.dialect.value} {program.machine.value}{hints}, "
                f"{len(program.moves)} executed moves"
            ),
            Fact(key="program", value=self.name),
            Fact(key="control", value=program.dialect.value),
            Fact(key="machine", value=program.machine.value),
            Table(key="tools", columns=STRETCHES, rows=stretches(program)),
            Table(
                key="moves", columns=_move_columns(program.text),
                rows=_MoveSequence(program.moves), is_shown=False,
            ),
            Findings(findings=program.findings),
        ])  # fmt: skip


class _MoveSequence(Sequence[NcMove]):
    """Moves that become values when they are asked for."""

    def __init__(self, moves: NcMoves) -> None:
        self._moves = moves

    def __len__(self) -> int:
        return len(self._moves)

    @overload
    def __getitem__(self, index: int) -> NcMove: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[NcMove]: ...
    def __getitem__(self, index: int | slice) -> NcMove | Sequence[NcMove]:
        if isinstance(index, slice):
            return [self._moves.move(each) for each in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        return self._moves.move(index)


def _move_columns(text: NcText) -> tuple[Column[NcMove], ...]:
    """Columns of the moves of NC code."""
    return (
        Column(key="line", value=lambda move: text.line(move.block), kind=int),
        Column(key="tool", value=lambda move: tool_label(called_tool(move.setting)), kind=str),
        Column(key="kind", value=lambda move: move.kind.name.lower(), kind=str),
        *_axes("", lambda move: move.end),
        *_axes("centre_", lambda move: None if move.arc is None else move.arc.centre),
        Column(
            key="turn_deg",
            value=lambda move: None if move.arc is None else deg_from_rad(move.arc.turn),
        ),
        Column(
            key="plane", kind=str,
            value=lambda move: None if move.arc is None else move.arc.plane.value,
        ),
        Column(key="feed_mm_min", value=lambda move: mm_min_from_speed(move.feed)),
        Column(key="spindle_rpm", value=_spindle),
        Column(key="dwell_s", value=lambda move: move.seconds or None),
    )  # fmt: skip


def _axes(prefix: str, point_of: Callable[[NcMove], Point | None]) -> Iterator[Column[NcMove]]:
    """Columns of the coordinates of a point of a move."""
    for axis, name in enumerate("xyz"):

        def coordinate(move: NcMove, axis: int = axis) -> float | None:
            point = point_of(move)
            return None if point is None else point[axis]

        yield Column(key=f"{prefix}{name}_mm", value=coordinate)


def _spindle(move: NcMove) -> float | None:
    """Constant spindle speed in force, rpm; None if it is not known or not constant."""
    setting = move.setting
    if setting.spindle is None or setting.surface is not None:
        return None
    return rpm_from_rev_s(abs(setting.spindle))


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
