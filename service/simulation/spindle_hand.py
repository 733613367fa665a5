"""Tools of NC code that turn against their hand: their edges rub with the back and do not cut.

M3 turns a right-hand tool so that it cuts, M4 a left-hand one. Left out are taps and threading
tools, which go back against their hand, boring bars, which bore back, and lathes, whose spindle
turns the workpiece.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from service.simulation.line_spans import spans
from simulator.removal.cutter import ENDS
from simulator.spec import ToolKind
from simulator.tools.tool_table import TableTool
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.neutral_blocks import FED
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import MachineType

HANDED = {ToolKind.ENDMILL, ToolKind.FACEMILL} | ENDS
"""Kinds of tools that only cut as their hand says."""


def turned_against(
    program: NcProgram, tools: Mapping[int, TableTool]
) -> Iterator[tuple[int, Finding]]:
    """Tools that turn against their hand at a feed, by number, each with a warning.

    Parameters
    ----------
    tools : mapping
        Tools by their numbers.
    """
    if program.machine is MachineType.LATHE:
        return
    moves = program.moves
    spindle = np.where(np.isin(moves.kind, list(FED)), np.nan_to_num(moves.spindle), 0.0)
    for number, tool in tools.items():
        if tool.kind not in HANDED or tool.hand is HandOfToolType.NEUTRAL:
            continue
        is_left = tool.hand is HandOfToolType.LEFT
        is_wrong = spindle > 0.0 if is_left else spindle < 0.0
        rows = np.flatnonzero((moves.tool == number) & is_wrong)
        if not len(rows):
            continue
        lines = np.unique(program.text.lines[moves.block[rows]])
        turns, hand = ("M3", "left") if is_left else ("M4", "right")
        text = (
            f"tool '{tool.id}': the spindle turns with {turns} ({spans(lines)}), against a "
            f"{hand}-hand tool; hand in the tool table says "
            "if it is another"
        )
        yield number, Finding(severity=Severity.WARNING, message=text, line=int(lines[0]))
