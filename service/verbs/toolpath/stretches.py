"""Moves of NC code by tool: a row for each stretch between two tool calls."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepnc_model.nc.moves import ModalSetting, MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram

CalledTool = tuple[int | None, str]
"""Number and name by which NC code calls a tool; neither before the first call."""

FEEDS = (MoveKind.LINE, MoveKind.ARC, MoveKind.THREAD)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolStretch:
    """Moves between two tool calls, with their lengths in mm."""

    tool: str
    first_line: int
    """Line of the first of its blocks that is executed."""
    moves: int
    arcs: int
    feed: float
    """Length of the moves at a feed."""
    rapid: float
    unknown: int
    """Moves of which start, end or centre are not known."""
    lowest: float | None
    """Least z at the end of a move; None if no end is known."""


def called_tool(setting: ModalSetting) -> CalledTool:
    """Tool that a setting has in the spindle."""
    return setting.tool, setting.tool_name


def tool_label(called: CalledTool) -> str:
    """Name of a called tool: its own, ``T`` and its number, or nothing."""
    number, name = called
    return name or ("" if number is None else f"T{number}")


def stretches(program: NcProgram) -> tuple[ToolStretch, ...]:
    """Stretches of a program, in the order of execution."""
    return tuple(_stretches(program))


def _stretches(program: NcProgram) -> Iterator[ToolStretch]:
    moves = program.moves
    order: dict[CalledTool, int] = {}
    numbers = [order.setdefault(called_tool(each), len(order)) for each in moves.settings]
    tools = np.array(numbers or [0])[moves.rows["setting"]]
    edges = np.flatnonzero(np.diff(tools)) + 1
    names = list(order)
    for low, high in pairwise([0, *edges.tolist(), len(moves)]):
        if low < high:
            part = moves.part(low, high)
            line = program.text.line(int(part.block[0]))
            yield _stretch(part, tool_label(names[tools[low]]), line)


def _stretch(moves: NcMoves, tool: str, line: int) -> ToolStretch:
    kind, length, ends = moves.kind, moves.length, moves.end[:, 2]
    is_known = moves.is_known & (kind != MoveKind.DWELL)
    is_fed = np.isin(kind, FEEDS)
    heights = ends[~np.isnan(ends)]
    return ToolStretch(
        tool=tool,
        first_line=line,
        moves=int((kind != MoveKind.DWELL).sum()),
        arcs=int((kind == MoveKind.ARC).sum()),
        feed=float(length[is_known & is_fed].sum()),
        rapid=float(length[is_known & (kind == MoveKind.RAPID)].sum()),
        unknown=int((~moves.is_known & (kind != MoveKind.DWELL)).sum()),
        lowest=float(heights.min()) if len(heights) else None,
    )
