"""Paths of NC code, prepared for runs: moves with a known place and tool, in parts by tool.

Moves that are not understood, that are cut with cutter compensation, in another frame, at an
unknown feed, with a tool that the table lacks, or that the operator may skip are left out: they
remove nothing from the stock, so that later moves meet more material, never less. Where moves
are left out, the tool goes around the stock.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from re import IGNORECASE, compile

import numpy as np

from service.programs.raw_stock import GivenStock, larger_stock_map, raw_stock_of, stock_map
from service.requests.program_facts import RawPart
from service.simulation.detour import Detour
from service.simulation.line_spans import spans
from service.simulation.setup import CountedIterator, PreparedRun
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import table_tool
from simulator.machine.virtual import LoadedTool, StockMap
from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.engage import MillingStock
from simulator.removal.march_cache import KeptMarches
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tools.tool_table import TableTool
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.compensation import tool_moves
from stepnc_model.nc.fed_blocks import DEFINED_CYCLES, cycle_feed_blocks
from stepnc_model.nc.moves import (
    REASONS,
    UNADVISED,
    ModalSetting,
    MoveFlag,
    MoveKind,
    NcMoves,
)
from stepnc_model.nc.neutral_blocks import FED, neutral_blocks
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import (
    Comment,
    MachineType,
)
from stepnc_model.post.dialect import Dialect

SURFACE = compile(rb"[(;][^)\r\n]*?(FINISH|ROUGH)", IGNORECASE)
"""Comment that says whether what follows leaves final surfaces."""

NOT_PLACED = (
    MoveFlag.COMPENSATED
    | MoveFlag.TRANSFORMED
    | MoveFlag.ROTARY
    | MoveFlag.MACHINE
    | MoveFlag.CONDITIONAL
    | MoveFlag.SKIPPABLE
)
"""Flags of moves whose place over the stock is not known, or that may not be executed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPart:
    """Part of a program with one tool."""

    name: str
    tool: int
    row: int
    """Row of its first move among those that run."""
    is_finishing: bool
    """Whether a comment says that it leaves final surfaces."""


class CodePaths:
    """Moves of an NC program that can be run, with its tools and stock.

    Parameters
    ----------
    material : MaterialMatch or None
        None: nothing is cut.
    tools : dict or None
        Tools by number; None: any tool may run, and nothing is cut.
    stock : RawPart
        Numbers or a file; empty: nothing is cut.
    """

    def __init__(
        self,
        program: NcProgram,
        machine: Machine,
        material: MaterialMatch | None,
        *,
        name: str,
        tools: dict[int, TableTool] | None,
        stock: RawPart,
    ) -> None:
        self.machine, self.material, self.name = machine, material, name
        self.marches: KeptMarches | None = None
        """Marches of other runs, from which a mill reads again what its tools met before."""
        self.larger_marches: KeptMarches | None = None
        """The same of runs in larger stocks."""
        self.stock, self.tools = stock, tools or {}
        self._has_any_tool = tools is None
        self._mesh: GivenStock | None = None
        """Stock that serves several runs: only its map is cut."""
        stream, self._is_linuxcnc = program.stream, program.dialect is Dialect.LINUXCNC
        if program.machine is MachineType.MILL:
            stream = tool_moves(stream, self._radius, is_square=self._is_linuxcnc)
        stream = _with_length_wear(_defined(stream, program.dialect))
        self.program = replace(program, stream=stream)
        moves = self.program.moves
        self._is_fed = is_fed = np.isin(moves.kind, list(FED))
        is_thread = moves.kind == MoveKind.THREAD
        fed = np.flatnonzero(moves.is_advisable)
        frame = int(moves.frame[fed[0]]) if len(fed) else 0
        self.frame = moves.frames[frame]
        """Frame in which the stock stands: that of the first cut."""
        is_here = (moves.frame == frame) | (not stock)
        is_known = np.isin(moves.tool, list(self.tools)) | (tools is None)
        is_sure = ~_is_uncertain(moves)
        is_placed = is_here & ((moves.flags & int(NOT_PLACED)) == 0) & is_sure
        is_placed &= (moves.kind != MoveKind.UNKNOWN) & ~np.isnan(_length_wear(moves))
        self._is_run = is_placed & is_known & (~is_fed | moves.has_rate)
        self.parts = tuple(self._parts())
        """Parts in the order of execution."""
        lines = program.text.lines[moves.block]
        size = int(program.text.lines.max(initial=0)) + 2
        feeding = cycle_feed_blocks(moves, program.dialect)
        is_defined = (moves.flags & int(MoveFlag.CYCLE)) != 0
        is_defined &= ~np.isin(moves.fed_by, feeding) & (program.dialect in DEFINED_CYCLES)
        chosen = is_fed & self._is_run & moves.is_advisable & ~is_defined
        chosen &= ~np.isnan(moves.spindle)
        self.can_change = np.zeros(size, dtype=np.bool_)
        """Whether the feed of each line may change, (L,)."""
        self.can_change[lines[chosen]] = True
        self.can_change[lines[is_fed & ~chosen]] = False
        count = np.bincount(lines[is_fed], minlength=size)
        self.can_split = self.can_change & (count == 1)
        """Whether each line may be split, (L,)."""
        self.can_split[lines[~moves.is_splittable]] = False
        self._reasons = {
            "the tool is not in the tool table": ~is_known & (moves.tool >= 0),
            "no tool is known": moves.tool < 0,
            f"the stock stands in {self.frame}, not in their frame": ~is_here,
            "the operator may skip them": (moves.flags & int(MoveFlag.SKIPPABLE)) != 0,
            "they begin where moves end that the operator may skip": ~is_sure,
            "the feed of a cycle serves other moves as well": is_defined,
            "their feed is the lead of a thread": is_thread & moves.has_rate,
            "a feed per revolution while the spindle is stopped": (moves.word > 0.0)
            & ~is_thread
            & ~moves.has_rate,
            "their lead is not known, or the spindle stands": is_thread & ~moves.has_rate,
            "the spindle speed is not known (--spindle T1=RPM)": np.isnan(moves.spindle),
            "the length of the tool (DL) is not known": np.isnan(_length_wear(moves)),
            "their start or end is not known": ~moves.is_known,
        } | {
            name: (moves.flags & int(flag)) != 0
            for flag, name in REASONS.items()
            if flag & (NOT_PLACED | UNADVISED)
        }
        self._is_kept = is_fed & ~chosen

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Lines whose feeds stay as they are, and why."""
        kept = self._findings(self._is_kept, "the feeds of {} stay as programmed: {}")
        return (*kept, *self.contour_remarks)

    @property
    def left_out(self) -> tuple[Finding, ...]:
        """Lines of feed moves that do not run, and why."""
        moves = self.program.moves
        is_left = self._is_fed & ~(self._is_run & moves.is_known)
        return tuple(self._findings(is_left, "{} left out of the run: {}"))

    @property
    def contour_remarks(self) -> tuple[Finding, ...]:
        """Lines at which the tool goes beside a compensated contour."""
        return tuple(self._contour_remarks())

    def _radius(self, setting: ModalSetting) -> float | None:
        """Radius by which a contour is offset, mm; None if it is not known."""
        side = setting.side
        if side is not None and side.diameter is not None:
            return 0.5 * side.diameter
        number = setting.tool
        if side is not None and side.number and self._is_linuxcnc:
            number = side.number
        tool = None if number is None else self.tools.get(number)
        shape = None if tool is None else tool.shape
        if not isinstance(shape, Cutter):
            return None
        return 0.5 * shape.diameter + setting.radius_wear

    def _contour_remarks(self) -> Iterator[Finding]:
        moves, text = self.program.moves, self.program.text
        is_beside = (moves.flags & int(MoveFlag.BESIDE)) != 0
        rows = np.flatnonzero(is_beside & np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)))
        if len(rows):
            lines = np.unique(text.lines[moves.block[rows]])
            yield Finding(
                severity=Severity.WARNING,
                message=f"{spans(lines)}: the tool goes beside the compensated contour by its "
                "radius in the tool table; is this the radius in the control?",
                line=int(lines[0]),
            )

    def prepared(self, margin: float) -> PreparedRun:
        """Program prepared anew, in a stock that is larger by a margin, mm.

        Raises
        ------
        StepNcError
            When the stock is invalid.
        """
        raw = self._raw()
        stream = self._run_stream()
        begins = zip(_part_rows(stream, self.parts), self.parts, strict=True)
        beginning = {
            row: Comment(text=part.name, workingstep=part.name) for row, part in begins
        }
        code = replace(self.program, stream=stream)
        blocks = CountedIterator(neutral_blocks(code, name=self.name, before=beginning))
        material = self.material
        tools = None
        if material is not None:
            tools = {n: table_tool(tool, material.material) for n, tool in self.tools.items()}
        clamped = None if raw is None else self.recalled(margin)
        return PreparedRun(
            name=self.name,
            machine=self.machine,
            material=material,
            blocks=iter(blocks) if raw is None else self._detour(raw, tools).led_around(blocks),
            tools=tools or None,
            stock=lambda _: clamped,
            raw=None if raw is None else raw.bounds,
            done=lambda: blocks.share(len(stream)),
            read=lambda: blocks.count,
        )

    def _run_stream(self) -> NcMoves:
        """Moves that run, with the switches between them that the operator cannot skip."""
        stream = self.program.stream
        is_run = (stream.flags & int(MoveFlag.CONDITIONAL | MoveFlag.SKIPPABLE)) == 0
        is_run &= np.isin(stream.tool, [-1, *self.tools]) | self._has_any_tool
        is_run[~stream.is_switch] = self._is_run
        return replace(stream, rows=stream.rows[is_run])

    def uncut(self, margin: float) -> StockMap:
        """Stock as given, larger by a margin, mm.

        Raises
        ------
        StepNcError
            When the stock is invalid or not known.
        """
        raw = self._raw()
        if raw is None:
            raise StepNcError("the stock is not known: name it with --stock")
        return self._map(raw, margin)

    def recalled(self, margin: float) -> StockMap:
        """Stock as :meth:`uncut` gives it, whose marches are kept for other runs."""
        found = self.uncut(margin)
        if isinstance(found, MillingStock):
            found.marches = self.larger_marches if margin > 0.0 else self.marches
        return found

    def _raw(self) -> GivenStock | None:
        """Raw part; None if it is not known."""
        if not self.stock:
            return None
        raw = self._mesh or raw_stock_of(self.stock)
        if raw.triangles is not None:
            self._mesh = raw
        return raw

    def _map(self, raw: GivenStock, margin: float) -> StockMap:
        if margin > 0.0:
            return larger_stock_map(self.machine, raw, margin)
        return stock_map(self.machine, raw)

    def _detour(self, raw: GivenStock, tools: dict[int, LoadedTool] | None) -> "Detour":
        is_lathe = self.machine.kind is MachineKind.LATHE
        # Inserts that come to the stock from outside, across the axis.
        inserts = {
            number
            for number, tool in (tools or {}).items()
            if is_lathe and isinstance(tool.shape, Insert) and not tool.shape.is_inside
        }
        return Detour(raw.bounds, inserts)

    def line(self, part: ToolPart) -> int:
        """Line of the first move of a part."""
        rows = np.flatnonzero(self._is_run)
        return self.program.text.line(int(self.program.moves.block[rows[part.row]]))

    def blocks_at(self, lines: Sequence[int]) -> Ints:
        """Indices of the blocks on some lines."""
        return np.searchsorted(self.program.text.lines, np.array(lines, dtype=np.int64))

    def fastest(self, block: int) -> float:
        """Greatest spindle speed at which a block moves at a feed, rev/s; 0 if not known."""
        return self.program.moves.fastest(self.rows_of(block))

    def rows_of(self, block: int) -> Ints:
        """Rows of the moves of a block at a feed."""
        order, blocks = self._by_block
        low, high = np.searchsorted(blocks, (block, block + 1))
        return order[low:high]

    @cached_property
    def _by_block(self) -> tuple[Ints, Ints]:
        """Rows that move at a feed, and their blocks, in the order of the file."""
        moves = self.program.moves
        rows = np.flatnonzero(np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)))
        order = rows[np.argsort(moves.block[rows], kind="stable")]
        return order, moves.block[order].astype(np.int64)

    def _parts(self) -> Iterator[ToolPart]:
        """Parts that begin with a tool, or with a comment about roughing or finishing."""
        moves = self.program.moves
        rows = np.flatnonzero(self._is_run)
        tools = moves.tool[rows]
        begins = dict.fromkeys(np.flatnonzero(np.diff(tools, prepend=-1)).tolist(), False)
        begins |= self._surfaces(rows)
        names: dict[int, int] = {}
        for row in sorted(begins):
            tool = int(tools[row])
            names[tool] = names.get(tool, 0) + 1
            yield ToolPart(
                name=_part_name(tool, names[tool]),
                tool=tool,
                row=row,
                is_finishing=begins[row],
            )

    def _surfaces(self, rows: Ints) -> dict[int, bool]:
        """Rows that follow a comment about surfaces, and whether it says finishing.

        A comment stands between two moves of one execution, or before the first move of a
        subprogram in the file.
        """
        moves, text = self.program.moves, self.program.text
        found = list(SURFACE.finditer(text.data))
        if not found:
            return {}
        starts = np.array([each.start() for each in found])
        blocks = np.searchsorted(text.starts, starts, side="right") - 1
        moving = np.unique(moves.block).astype(np.int64)
        at: dict[int, bool] = {}
        last: dict[int, int] = {}
        for row, (block, call) in enumerate(
            zip(moves.block[rows].tolist(), moves.call[rows].tolist(), strict=True)
        ):
            before = last.get(call)
            if before is None or before > block:
                place = int(np.searchsorted(moving, block)) - 1
                before = int(moving[place]) if place >= 0 else -1
            last[call] = block
            low, high = np.searchsorted(blocks, (before + 1, block))
            if low < high:
                at[row] = found[high - 1][1].upper() == b"FINISH"
        return at

    def _findings(self, is_left: Bools, message: str) -> Iterator[Finding]:
        """Lines of some moves by reason; the message has a place for both."""
        moves, text = self.program.moves, self.program.text
        for reason, is_so in self._reasons.items():
            rows = np.flatnonzero(is_left & is_so)
            if not len(rows):
                continue
            lines = np.unique(text.lines[moves.block[rows]])
            yield Finding(
                severity=Severity.WARNING,
                message=message.format(spans(lines), reason),
                line=int(lines[0]),
            )


def _defined(moves: NcMoves, dialect: Dialect) -> NcMoves:
    """Moves in which those of defined cycles belong to the blocks that hold their feed."""
    feeding = cycle_feed_blocks(moves, dialect)
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC))
    rows = np.flatnonzero(is_fed & np.isin(moves.fed_by, feeding))
    if not len(rows):
        return moves
    table = moves.rows.copy()
    table["block"][rows] = table["fed_by"][rows]
    return replace(moves, rows=table)


def _part_rows(stream: NcMoves, parts: Sequence[ToolPart]) -> Iterator[int]:
    """Rows where parts begin: at the switches before their first move that have its tool."""
    moving, tools = np.flatnonzero(~stream.is_switch), stream.tool
    for part in parts:
        row = int(moving[part.row])
        while row and stream.is_switch[row - 1] and tools[row - 1] == tools[row]:
            row -= 1
        yield row


def _part_name(tool: int, count: int) -> str:
    """Name of the n-th part with a tool; a negative number is none."""
    name = f"T{tool}" if tool >= 0 else "no tool"
    return name if count == 1 else f"{name} ({count})"


def _length_wear(moves: NcMoves) -> Floats:
    """Distance along Z of the tip from the programmed place, (N,), mm."""
    stated = np.array([each.length_wear for each in moves.settings] or [0.0])
    wear: Floats = stated[moves.rows["setting"]]
    return wear


def _with_length_wear(moves: NcMoves) -> NcMoves:
    """Moves at the places where the tip of the tool goes."""
    wear = _length_wear(moves)
    if not np.any(wear):
        return moves
    table = moves.rows.copy()
    for name in ("start", "end"):
        table[name][:, 2] += wear
    return replace(moves, rows=table)


def _is_uncertain(moves: NcMoves) -> Bools:
    """True if a move begins or ends where moves that the operator may skip have led, (N,)."""
    uncertain = np.zeros(len(moves), dtype=np.bool_)
    is_skipped = (moves.flags & int(MoveFlag.SKIPPABLE)) != 0
    doubtful = np.zeros(3, dtype=np.bool_)
    known_until = -1
    for first in np.flatnonzero(is_skipped).tolist():
        if first <= known_until:
            continue
        for row in range(first, len(moves)):
            known_until = row
            move = moves.rows[row]
            is_stated = (move["end"] != move["start"]) & ~np.isnan(move["end"])
            if is_skipped[row]:
                doubtful |= move["end"] != move["start"]
                continue
            uncertain[row] = doubtful.any()
            doubtful &= ~is_stated
            if not doubtful.any():
                break
    return uncertain


class CodeBlocks:
    """Blocks of NC code numbered by their line: a line has one feed, however often it runs."""

    def __init__(self, blocks: Iterable[Numbered], code: CodePaths) -> None:
        self._blocks, self._code = blocks, code

    def __iter__(self) -> Iterator[Numbered]:
        """Yield the blocks with their lines."""
        return iter(self._blocks)

    def can_change(self, numbers: Ints) -> Bools:
        """True if the feeds of lines may change."""
        changes: Bools = self._code.can_change[numbers]
        return changes

    def can_split(self, numbers: Ints) -> Bools:
        """True if lines may be split."""
        splits: Bools = self._code.can_split[numbers]
        return splits

    def line(self, number: int) -> int:
        """Line of the program: the number itself."""
        return number
