"""Run of planned feeds on the virtual machine, and what it shows of the plan."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from optimiser.along_path.filter_transfer import slower_pieces
from optimiser.along_path.plan import (
    PERMITTED,
    BlockFeeds,
    FeedTask,
    RunBlock,
    SlowerPart,
    slower_parts,
)
from optimiser.along_path.stretch import PathStretch
from service.along_path.course import NumberedBlocks, PathSource, stretches_of
from service.along_path.trace import PathTrace, PathTraceKeeper
from service.progress import Ticker, bar
from service.simulation.detour import BRIDGE
from simulator.machine.samples import Episode
from simulator.machine.totals import Total, added
from simulator.machine.virtual import VirtualMachine
from simulator.motion.segments import Bools, Ints
from stepnc_model.errors import Finding
from stepnc_model.post.block_feeds import with_feeds
from stepnc_model.post.blocks import Block

LEAST_GAP = 1e-6
"""Length below which two parts of the path follow each other, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitStretch:
    """Part of the path at one active limit."""

    begin: float
    """Length of the path before the part, mm."""
    end: float
    """Length of the path up to its end, mm."""
    words: str
    """Name of the limit."""


class PartTotals:
    """Totals of a run by parts of the program, with its signals if asked. Running state.

    Parameters
    ----------
    what : str
        Name of the run in messages.
    share : callable
        Share of the run that is done, 0 to 1, at a time of the machine in s.
    keeps_trace : bool
        Whether the signals are kept.
    """

    def __init__(
        self,
        ticker: Ticker,
        what: str,
        *,
        share: Callable[[float], float],
        keeps_trace: bool,
    ) -> None:
        self._totals: list[Total] = []
        self._names: list[str] = [""]
        self._ticker, self._what, self._share = ticker, what, share
        self._keeper = PathTraceKeeper() if keeps_trace else None
        self.findings: list[Finding] = []
        """Findings of the machine, which grow during the run."""

    def add(self, episode: Episode, machine: VirtualMachine) -> None:
        """Add an episode."""
        at = episode.state.workingstep
        self._totals += [Total() for _ in range(len(self._totals), at + 1)]
        self._totals[at] = added(self._totals[at], episode, machine.machine)
        self._names = ["", *machine.workingsteps]
        self.findings = machine.findings
        if self._keeper is not None:
            self._keeper.add(episode, machine.machine)
        now = machine.now
        self._ticker(lambda: f"{bar(self._share(now))}  {self._what}: {now:.0f} s of machining")

    def trace(self) -> PathTrace | None:
        """Signals of the run; None unless they were kept."""
        return None if self._keeper is None else self._keeper.trace()

    @property
    def duration(self) -> float:
        """Time of the run so far, s."""
        return sum(total.duration for total in self._totals)

    def share_of_time(self, now: float) -> float:
        """Share of this run that a time of the machine in s is, 0 to 1."""
        return min(now / max(self.duration, 1.0), 1.0)

    def rows(self) -> list[tuple[str, Total]]:
        """Names and totals of the parts, in the order of execution."""
        return list(zip(self._names, self._totals, strict=False))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanRun:
    """Run of a plan on the virtual machine."""

    totals: PartTotals
    slower: dict[tuple[int, int], SlowerPart]
    """Slower feeds of parts that are too fast, by block and row."""
    blocks: dict[int, RunBlock]
    """Blocks whose feeds may change, if the number of feeds is bound."""
    limits: tuple[LimitStretch, ...]
    """Active limits along the path; empty unless signals were kept."""


def run_plan(
    source: PathSource,
    feeds: BlockFeeds,
    *,
    task: FeedTask,
    splits: bool,
    totals: PartTotals,
) -> PlanRun:
    """Run a plan and compare its feeds with those that each place permits.

    Parameters
    ----------
    splits : bool
        Whether parts that are too fast may be divided.
    totals : PartTotals
        Receives the run.

    Raises
    ------
    SimulationError
        When the machine cannot run the program.
    """
    prepared = source.prepare(0.0)
    emitted = _EmittedBlocks(source.numbered(prepared), feeds)
    strip = _LimitStrip(emitted, feeds)
    slower: dict[tuple[int, int], SlowerPart] = {}
    blocks: dict[int, RunBlock] = {}
    for stretch in stretches_of(
        prepared,
        None,
        control=task.machine.control,
        bounds=source.bounds,
        log=emitted,
        watch=totals.add,
    ):
        strip.add(stretch)
        if task.levels is not None:
            for number, block in _run_blocks(stretch):
                source_number = emitted.origin[number][0]
                blocks[source_number] = block.plus(blocks.get(source_number))
        judged = replace(stretch, can_split=stretch.can_split & splits)
        if source.caution is not None:
            lines = emitted.origins(stretch.segments.block)
            judged = source.caution.as_programmed(judged, lines)
        pieces = slower_pieces(judged, task.machine, task.rules)
        if pieces is None:
            continue
        for number, part in slower_parts(pieces):
            origin = emitted.origin[number]
            # A feed that the plan kept as programmed is permitted a little more.
            if origin[0] in feeds or part.excess > PERMITTED:
                slower[origin] = part.or_slower(slower.get(origin))
    totals.findings = [
        replace(finding, line=line)
        for finding in totals.findings
        for line in (emitted.line(finding.line),)
        if line != BRIDGE or finding.line == 0
    ]
    return PlanRun(totals=totals, slower=slower, blocks=blocks, limits=tuple(strip.rows))


def _run_blocks(stretch: PathStretch) -> Iterator[tuple[int, RunBlock]]:
    """Yield the blocks of a stretch whose feeds may change."""
    segments = stretch.segments
    rows = np.flatnonzero(stretch.is_free & (segments.length > 0.0))
    is_own = ~np.isnan(stretch.per_revolution[rows])
    weight = segments.length[rows] / np.where(is_own, stretch.spindle[rows], 1.0)
    rate = np.where(is_own, stretch.per_revolution[rows], segments.speed[rows])
    numbers, first, which = np.unique(
        segments.block[rows], return_index=True, return_inverse=True
    )
    whole = np.bincount(which, weights=weight)
    for number, row, total in zip(
        numbers.tolist(), first.tolist(), whole.tolist(), strict=True
    ):
        yield (
            number,
            RunBlock(
                name=stretch.workingstep,
                weight=total,
                rate=float(rate[row]),
                is_per_revolution=bool(is_own[row]),
            ),
        )


class _EmittedBlocks:
    """Blocks at their new feeds, numbered by the block and part that they come from.

    Running state: it grows as the program is read. The moves of a cycle share a number, as they
    do before their feeds change, so that both runs stop at the same places.
    """

    def __init__(self, blocks: NumberedBlocks, feeds: BlockFeeds) -> None:
        self._blocks = blocks
        self._feeds = feeds
        self.origin: list[tuple[int, int]] = [(0, 0)]

    def __iter__(self) -> Iterator[tuple[int, Block]]:
        """Yield the blocks with their numbers."""
        for fed in with_feeds(self._blocks, self._feeds):
            if (fed.number, fed.part) != self.origin[-1]:
                self.origin.append((fed.number, fed.part))
            yield len(self.origin) - 1, fed.block

    def can_change(self, numbers: Ints) -> Bools:
        """True if the blocks that some come from may have another feed."""
        return self._blocks.can_change(self.origins(numbers))

    def can_split(self, numbers: Ints) -> Bools:
        """True if the blocks that some come from may be split."""
        return self._blocks.can_split(self.origins(numbers))

    def line(self, number: int) -> int:
        """Line of the program; 0 without one."""
        origin = self.origin[number][0]
        return self._blocks.line(origin) if origin else 0

    def origins(self, numbers: Ints) -> Ints:
        """Blocks of the program that some blocks come from."""
        known, row = np.unique(numbers, return_inverse=True)
        return np.array([self.origin[number][0] for number in known.tolist()])[row]


class _LimitStrip:
    """Active limits along the path of a plan. Running state."""

    def __init__(self, emitted: _EmittedBlocks, feeds: BlockFeeds) -> None:
        self.rows: list[LimitStretch] = []
        self._emitted, self._feeds = emitted, feeds
        self._length = 0.0

    def add(self, stretch: PathStretch) -> None:
        """Add the segments of a stretch whose feed the plan chose."""
        segments = stretch.segments
        ends = self._length + np.cumsum(segments.length)
        begins = ends - segments.length
        for row in np.flatnonzero(~segments.is_rapid).tolist():
            block, part = self._emitted.origin[int(segments.block[row])]
            if block in self._feeds:
                words = self._feeds[block][part].reason
                self._put(float(begins[row]), float(ends[row]), words)
        self._length = float(ends[-1])

    def _put(self, begin: float, end: float, words: str) -> None:
        """Add a part, or lengthen the last one at the same limit."""
        last = self.rows[-1] if self.rows else None
        if last is not None and last.words == words and begin - last.end < LEAST_GAP:
            self.rows[-1] = replace(last, end=end)
        else:
            self.rows.append(LimitStretch(begin=begin, end=end, words=words))
