"""Paths of NC code, prepared for runs: moves with a known place and tool, in parts by tool.

Moves that are not understood, that are cut with cutter compensation, in another frame, or with
a tool that the table lacks are left out: they remove nothing from the stock, so that later
moves meet more material, never less. Where moves are left out, the tool goes over the stock.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from re import IGNORECASE, compile

import numpy as np

from service.raw_stock import larger_stock_map, raw_stock_of, stock_map
from service.simulation.setup import CountedIterator, PreparedRun
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import table_tool
from simulator.motion.segments import Bools, Ints
from simulator.spec import Machine, MaterialMatch
from simulator.tool_table import TableTool
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.moves import MoveFlag, MoveKind
from stepnc_model.nc.neutral_blocks import neutral_blocks
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import Block, Comment, Rapid, Retract, ToolChange

SURFACE = compile(rb"[(;][^)\r\n]*?(FINISH|ROUGH)", IGNORECASE)
"""Comment that says whether what follows leaves final surfaces."""

NOT_PLACED = (
    MoveFlag.COMPENSATED
    | MoveFlag.TRANSFORMED
    | MoveFlag.ROTARY
    | MoveFlag.MACHINE
    | MoveFlag.CONDITIONAL
)
"""Flags of moves whose place over the stock is not known."""

CLEARANCE = 5.0
"""Height over the stock at which the tool bridges moves that are left out, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPart:
    """Part of a program with one tool."""

    name: str
    tool: int
    is_new_tool: bool
    """Whether it begins with the change of its tool."""
    line: int
    """Line of its first move."""
    is_finishing: bool
    """Whether a comment says that it leaves final surfaces."""


class CodePaths:
    """Moves of an NC program that can be run, with its tools and stock."""

    def __init__(
        self,
        program: NcProgram,
        machine: Machine,
        material: MaterialMatch,
        *,
        name: str,
        tools: dict[int, TableTool],
        stock: str,
    ) -> None:
        self.program, self.machine, self.material = program, machine, material
        self.name, self.tools, self.stock = name, tools, stock
        moves = program.moves
        is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC, MoveKind.THREAD))
        fed = np.flatnonzero(moves.is_advisable)
        frame = int(moves.frame[fed[0]]) if len(fed) else 0
        self.frame = moves.frames[frame]
        """Frame in which the stock stands: that of the first cut."""
        is_placed = (moves.frame == frame) & ((moves.flags & int(NOT_PLACED)) == 0)
        is_placed &= moves.kind != MoveKind.UNKNOWN
        self._is_run = is_placed & (~is_fed | np.isin(moves.tool, list(tools)))
        self.parts = tuple(self._parts())
        """Parts in the order of execution."""
        self.findings = tuple(self._findings(is_fed, frame))
        """What is left out, and why."""
        lines = program.text.lines[moves.block]
        size = int(program.text.lines.max(initial=0)) + 2
        chosen = is_fed & self._is_run & moves.is_advisable
        self.can_change = np.zeros(size, dtype=np.bool_)
        """Whether the feed of each line may change, (L,)."""
        self.can_change[lines[chosen]] = True
        self.can_change[lines[is_fed & ~chosen]] = False
        count = np.bincount(lines[is_fed], minlength=size)
        self.can_split = self.can_change & (count == 1)
        """Whether each line may be split, (L,)."""
        self.can_split[lines[~moves.is_splittable]] = False

    def prepared(self, margin: float) -> PreparedRun:
        """Program prepared anew, in a stock that is larger by a margin, mm.

        Raises
        ------
        StepNcError
            When the stock is invalid.
        """
        raw = raw_stock_of(self.stock)
        if margin > 0.0:
            clamped = larger_stock_map(self.machine, raw, margin)
        else:
            clamped = stock_map(self.machine, raw)
        moves = replace(self.program.moves, rows=self.program.moves.rows[self._is_run])
        blocks = CountedIterator(
            neutral_blocks(replace(self.program, moves=moves), name=self.name)
        )
        over = raw.bounds.high[2] + CLEARANCE
        return PreparedRun(
            name=self.name,
            machine=self.machine,
            material=self.material,
            blocks=_in_parts(blocks, self.parts, over=over),
            tools={
                number: table_tool(tool, self.material.material)
                for number, tool in self.tools.items()
            },
            stock=lambda _: clamped,
            raw=raw.bounds,
            done=lambda: blocks.share(len(moves)),
            read=lambda: blocks.count,
        )

    def block_at(self, line: int) -> int:
        """Index of the block on a line."""
        return int(np.searchsorted(self.program.text.lines, line))

    def fastest(self, block: int) -> float:
        """Greatest spindle speed at which a block is executed, rev/s."""
        rows = np.flatnonzero(self.program.moves.block == block)
        return float(np.nanmax(np.abs(self.program.moves.spindle[rows])))

    def _parts(self) -> Iterator[ToolPart]:
        """Parts that begin with a tool, or with a comment about roughing or finishing."""
        moves, text = self.program.moves, self.program.text
        rows = np.flatnonzero(self._is_run & (moves.tool >= 0))
        if not len(rows):
            return
        blocks = moves.block[rows]
        is_tool = np.diff(moves.tool[rows], prepend=-1) != 0
        said = {
            int(np.searchsorted(text.starts, found.start(), side="right")) - 1: found
            for found in SURFACE.finditer(text.data)
        }
        begins = {int(row): b"" for row in np.flatnonzero(is_tool)}
        for block, found in said.items():
            row = int((blocks > block).argmax())
            if blocks[row] > block:
                begins[row] = found[1].upper()
        names: dict[int, int] = {}
        for row in sorted(begins):
            tool = int(moves.tool[rows[row]])
            names[tool] = names.get(tool, 0) + 1
            yield ToolPart(
                name=f"T{tool}" if names[tool] == 1 else f"T{tool} ({names[tool]})",
                tool=tool,
                is_new_tool=bool(is_tool[row]),
                line=text.line(int(blocks[row])),
                is_finishing=begins[row] == b"FINISH",
            )

    def _findings(self, is_fed: Bools, frame: int) -> Iterator[Finding]:
        """What is left out, and the tools that the table lacks."""
        moves = self.program.moves
        for tool in np.unique(moves.tool[is_fed]):
            if int(tool) not in self.tools and tool >= 0:
                text = f"T{tool} is not in the tool table: its feeds stay as they are"
                yield self._first(is_fed & (moves.tool == tool), text)
        for other in np.unique(moves.frame[is_fed]):
            if other != frame:
                text = (
                    f"{moves.frames[other]}: the stock stands in {self.frame}; feeds in other "
                    "frames stay as they are"
                )
                yield self._first(is_fed & (moves.frame == other), text)
        is_compensated = is_fed & ((moves.flags & int(MoveFlag.COMPENSATED)) != 0)
        if is_compensated.any():
            text = "cutter compensation: the path of the tool is not known, feeds stay"
            yield self._first(is_compensated, text)

    def _first(self, rows: Bools, text: str) -> Finding:
        block = int(self.program.moves.block[int(rows.argmax())])
        line = self.program.text.line(block)
        return Finding(severity=Severity.WARNING, message=text, line=line)


def _in_parts(
    blocks: Iterable[Numbered], parts: tuple[ToolPart, ...], *, over: float
) -> Iterator[Numbered]:
    """Blocks with the beginning of each part, and with bridges over the stock."""
    coming = list(parts)[::-1]
    for line, block in blocks:
        if coming and _begins(coming[-1], line, block):
            name = coming.pop().name
            yield line, Comment(text=name, workingstep=name)
        if isinstance(block, Rapid) and block.is_way:
            x, y, z = block.end
            yield line, Retract(z=max(over, z), is_way=True)
            yield line, Rapid(end=(x, y, max(over, z)), is_way=True)
        yield line, block


def _begins(part: ToolPart, line: int, block: Block) -> bool:
    """Whether a part begins with a block."""
    return isinstance(block, ToolChange) if part.is_new_tool else line >= part.line


class CodeBlocks:
    """Blocks of NC code numbered by their line: a line has one feed, however often it runs."""

    def __init__(self, blocks: Iterable[Numbered], code: CodePaths) -> None:
        self._blocks, self._code = blocks, code

    def __iter__(self) -> Iterator[Numbered]:
        """Yield the blocks with their lines."""
        return iter(self._blocks)

    def can_change(self, numbers: Ints) -> Bools:
        """Whether the feeds of lines may change."""
        changes: Bools = self._code.can_change[numbers]
        return changes

    def can_split(self, numbers: Ints) -> Bools:
        """Whether lines may be split."""
        splits: Bools = self._code.can_split[numbers]
        return splits

    def line(self, number: int) -> int:
        """Line of the program: the number itself."""
        return number
