"""Caution with NC code: how far its feeds may rise, and moves that cast doubt on the stock.

A tool that is fed at cutting feed and meets nothing says that there is material where the given
stock has none. Such a move keeps its feed, unless it goes through what the program itself has
removed, or lies outside the stock with clearance. The latter holds for no drill: nobody feeds a
drill through air on purpose, however far from the stock. A mill must go through what was
removed with its whole width: a pass beside the stock that overlaps the one before does not.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from optimiser.along_path.change_bounds import (
    is_straight_down,
    is_straight_up,
    plunge_feeds,
    programmed_rates,
    risen,
)
from optimiser.along_path.stretch import PathStretch
from optimiser.safety import USUAL_RISE
from service.along_path.misuse import MisuseWatch
from service.simulation.detour import BRIDGE
from service.simulation.line_spans import spans
from simulator.machine.virtual import Shape, StockMap, VirtualMachine
from simulator.motion.segments import Bools, Floats, Ints, Segments
from simulator.removal.cutter import Cutter
from simulator.removal.stations import Stations
from simulator.spec import MachineKind
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.written_lines import WrittenLines

CLEARANCE = 5.0
"""Distance from the stock from which a move that meets nothing is no doubt, mm; that of the
stock margin if it is more."""

MOST_WAITING = 50_000
"""Number of segments that wait for the larger stock to be cut, to bound memory."""

MARK = re.compile(rb"AT MOST ([0-9.]+) TIMES THE PROGRAMMED FEED", re.I)
"""Comment in code that was advised before: its feeds have risen already."""


def mark_of(rise: float) -> str:
    """Comment that says how far the feeds of a program have risen."""
    return f"AT MOST {rise:g} TIMES THE PROGRAMMED FEED"


def rise_left(data: bytes, rise: float) -> float:
    """Rise that code has left whose comment says how far it rose before; at least 1."""
    used = max((float(found[1]) for found in MARK.finditer(data)), default=1.0)
    return max(rise / used, 1.0)


class TrialStock(Protocol):
    """Stock that can be cut on trial."""

    def tried(self, segments: Segments, shape: Any, /) -> tuple[Stations, Any]:
        """Cut along segments but keep the stock; return the engagement."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubts:
    """Moves of one part of a program that cast doubt on the stock."""

    moves: frozenset[int] = frozenset()
    """Lines of moves near the stock."""
    drilled: frozenset[int] = frozenset()
    """Lines of moves and cycles of drills."""


@dataclass(slots=True, kw_only=True)
class Caution:
    """Doubts about one program, and its programmed feeds. Running state."""

    fresh: Callable[[float], Any]
    """Function that gives the uncut stock, larger by some mm."""
    larger: Callable[[float], Any] | None = None
    """The same for the stock that the whole program cuts; None: ``fresh``."""
    rise: float = USUAL_RISE
    """Greatest feed over the programmed one."""
    allows_plunge: bool = False
    """Whether straight plunges may be faster than programmed."""
    clearance: float = CLEARANCE
    unraised: Set[int] = frozenset()
    """Numbers of the tools whose feeds may only fall."""
    misuse: MisuseWatch | None = None
    base: Mapping[int, float] | None = None
    """Programmed feeds by block in the unit of the block; None: those of the program itself."""
    seen: dict[int, float] = field(default_factory=dict)
    """Least programmed feed of each block that was seen."""
    doubts: dict[str, Doubts] = field(default_factory=dict)
    """Doubts by part of the program."""
    _stocks: dict[float, TrialStock] = field(default_factory=dict)
    _larger: "LargerStock | None" = None

    def of_written(self, lines: WrittenLines) -> "Caution":
        """Caution with code that was written from this program: its feeds are the base."""
        return replace(
            self,
            base=_Origins(self.seen, lines),
            misuse=None if self.misuse is None else self.misuse.of_written(),
            seen={},
            doubts={},
        )

    def end_run(self) -> None:
        """Forget the stock as a run left it, at its end."""
        self._larger = None

    def bounded(self, stretch: PathStretch, machine: VirtualMachine) -> PathStretch:
        """Return a stretch with bounds on how its programmed feeds may change."""
        if machine.tool is None or machine.tool.shape is None:
            if self.misuse is not None:
                self.misuse.watched_tap(stretch, machine.state.tool, self._meeting)
            return stretch
        move = LargerMove(
            segments=stretch.segments,
            shape=machine.tool.shape,
            is_clockwise=machine.state.spindle_programmed >= 0.0,
        )
        if self._larger is None:
            # Not a lambda: it would keep this object, and its stocks, alive in a circle.
            self._larger = LargerStock(partial(self.larger or self.fresh, self.clearance))
        self._larger.add(move)
        watched = stretch
        if self.misuse is not None:
            watched = self.misuse.watched(stretch, machine.state.tool)
        if stretch.bounds is None:
            return watched
        shape, base = machine.tool.shape, self._base(stretch)
        is_mill = isinstance(shape, Cutter) and not shape.is_drill
        is_mill &= machine.machine.kind is MachineKind.MILL
        is_kept = self._doubted(watched, shape, is_mill=is_mill)
        if watched.is_kept is not None:
            is_kept |= watched.is_kept
        programmed = risen(stretch, base, 1.0)
        plunge = plunge_feeds(stretch, base, is_allowed=self.allows_plunge) if is_mill else None
        return replace(
            watched,
            is_kept=is_kept,
            rise=risen(stretch, base, self.rise),
            plunge=plunge,
            programmed=programmed,
            unraised=programmed if machine.state.tool in self.unraised else None,
        )

    def as_programmed(self, stretch: PathStretch, lines: Ints) -> PathStretch:
        """Return a stretch of a plan with the programmed feeds of its source lines, (N,)."""
        known = self.seen if self.base is None else self.base
        rates = programmed_rates(stretch)
        base = np.array([
            known.get(line, rate)
            for line, rate in zip(lines.tolist(), rates.tolist(), strict=True)
        ])
        judged = replace(stretch, programmed=risen(stretch, base, 1.0))
        return judged if self.misuse is None else self.misuse.as_kept(judged, lines)

    def _base(self, stretch: PathStretch) -> Floats:
        """Programmed feeds of the segments, (N,); noted by block."""
        rates = programmed_rates(stretch)
        for block, rate in zip(stretch.segments.block.tolist(), rates.tolist(), strict=True):
            self.seen[block] = min(rate, self.seen.get(block, rate))
        if self.base is None:
            return rates
        blocks = stretch.segments.block.tolist()
        return np.array([
            self.base.get(block, rate)
            for block, rate in zip(blocks, rates.tolist(), strict=True)
        ])

    def _doubted(self, stretch: PathStretch, shape: Shape, *, is_mill: bool) -> Bools:
        """True if blocks meet nothing where there might be material, (N,)."""
        segments = stretch.segments
        met = _greatest(stretch.met, len(segments))
        is_drill = isinstance(shape, Cutter) and not is_mill
        is_asked = stretch.is_free & (segments.length > 0.0)
        is_asked &= ~np.isin(segments.block, segments.block[met > 0.0])
        if is_mill:
            is_asked &= ~is_straight_up(stretch)
            # A straight plunge keeps its feed anyway.
            is_asked &= ~is_straight_down(stretch) | self.allows_plunge
        rows = np.flatnonzero(is_asked & (segments.block != BRIDGE))
        if len(rows) and not is_drill:
            near = self._meeting(segments, rows, shape, self.clearance)
            rows = rows[np.isin(segments.block[rows], near)]
        if not len(rows):
            return np.zeros(len(segments), dtype=np.bool_)
        removed = self._meeting(segments, rows, shape, 0.0)
        if is_mill and self._larger is not None and len(removed):
            through = rows[np.isin(segments.block[rows], removed)]
            removed = np.setdiff1d(removed, segments.block[self._larger.met(through)])
        blocks = np.setdiff1d(segments.block[rows], removed)
        self._note(stretch.workingstep, blocks, is_drill=is_drill)
        doubted: Bools = np.isin(segments.block, blocks) & ~segments.is_rapid
        return doubted

    def _meeting(self, segments: Segments, rows: Ints, shape: Shape, margin: float) -> Ints:
        """Blocks of some segments that meet the uncut stock, larger by a margin."""
        stock = self._stocks.get(margin)
        if stock is None:
            stock = self._stocks[margin] = self.fresh(margin)
        hit = rows[_sections(stock, segments[rows], shape) > 0.0]
        if not len(hit):
            return hit
        # What one move removes hides a later one: those without contact are tried alone.
        found = set(segments.block[hit].tolist())
        for row in rows.tolist():
            block = int(segments.block[row])
            if block not in found and _sections(stock, segments[row : row + 1], shape)[0] > 0.0:
                found.add(block)
        return np.array(sorted(found))

    def _note(self, part: str, blocks: Ints, *, is_drill: bool) -> None:
        if not len(blocks):
            return
        known, more = self.doubts.get(part, Doubts()), frozenset(blocks.tolist())
        self.doubts[part] = (
            replace(known, drilled=known.drilled | more)
            if is_drill
            else replace(known, moves=known.moves | more)
        )

    def findings(self) -> Iterator[Finding]:
        """Moves that the tools are not made for, and doubts by part of the program."""
        if self.misuse is not None:
            yield from self.misuse.findings()
        for part, doubt in self.doubts.items():
            for lines, what, where in (
                (doubt.moves, "move", f" within {self.clearance:g} mm of it"),
                (doubt.drilled, "drilling move", ""),
            ):
                if lines:
                    yield _finding(part, sorted(lines), what, where)


@dataclass(frozen=True, slots=True, kw_only=True)
class LargerMove:
    """Moves of one tool that are still to be cut into the larger stock."""

    segments: Segments
    shape: Shape
    is_clockwise: bool


class LargerStock:
    """Stock larger by the clearance, as the program leaves it. Running state.

    It is cut when it is first asked for, since many programs never ask.

    Parameters
    ----------
    fresh : callable
        Function that gives the uncut larger stock.
    """

    def __init__(self, fresh: Callable[[], StockMap]) -> None:
        self._fresh = fresh
        self._stock: StockMap | None = None
        self._waiting: list[LargerMove] = []
        self._count = 0
        """Number of segments that wait."""
        self._last: Floats | None = None
        """Sections that the last moves met; None: they are still to be cut."""

    def add(self, move: LargerMove) -> None:
        """Take the next moves of the program."""
        if self._count > MOST_WAITING:
            self._cut()
        self._waiting.append(move)
        self._count += len(move.segments)
        self._last = None

    def met(self, rows: Ints) -> Ints:
        """Rows of the last moves that meet the larger stock."""
        if self._last is None:
            self._cut()
        found: Ints = rows[:0] if self._last is None else rows[self._last[rows] > 0.0]
        return found

    def _cut(self) -> None:
        """Cut all moves that wait."""
        if self._stock is None:
            self._stock = self._fresh()
        for each in self._waiting:
            stations = self._stock.cut(
                each.segments, each.shape, is_clockwise=each.is_clockwise
            )
            self._last = _greatest(stations, len(each.segments))
        self._waiting.clear()
        self._count = 0


def _finding(part: str, lines: list[int], what: str, where: str) -> Finding:
    is_one = len(lines) == 1
    text = (
        f"{part}: {len(lines)} {what}{'' if is_one else 's'} at cutting feed "
        f"{'meets' if is_one else 'meet'} no stock{where}: {'its' if is_one else 'their'} feed "
        f"is kept; the stock may be wrong ({spans(np.array(lines))})"
    )
    return Finding(severity=Severity.WARNING, message=text, line=lines[0])


def _sections(stock: TrialStock, segments: Segments, shape: Shape) -> Floats:
    """Greatest section that each segment would cut, (N,), mm²."""
    stations, _ = stock.tried(segments, shape)
    return _greatest(stations, len(segments))


def _greatest(stations: Stations, count: int) -> Floats:
    """Greatest section at the stations of each segment, (N,), mm²."""
    found = np.zeros(count)
    np.maximum.at(found, stations.segment, stations.peak_section)
    return found


class _Origins(Mapping[int, float]):
    """Feeds of the lines from which written lines come."""

    def __init__(self, feeds: Mapping[int, float], lines: WrittenLines) -> None:
        self._feeds, self._lines = feeds, lines

    def __getitem__(self, line: int) -> float:
        return self._feeds[self._lines.origin(line).line]

    def __iter__(self) -> Iterator[int]:
        return iter(self._feeds)

    def __len__(self) -> int:
        return len(self._feeds)
