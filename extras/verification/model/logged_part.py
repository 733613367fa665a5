"""Part that logged positions leave: the sweep of the tools from sample to sample.

Samples are taken in pieces, so that logs of any length need the memory of one piece. For each
point on a wall and each cell it is kept which sample came nearest, and how far the tool moved
between samples there. Units mm and s.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import pi
from typing import Protocol

import numpy as np

from extras.verification.model.path import rows_between
from extras.verification.model.sample_ways import (
    STILL,
    STRAIGHT,
    greatest_around,
    longest_ways,
    to_ends,
    turns_of,
    with_missing,
)
from extras.verification.model.surface import PartSweep
from extras.verification.model.sweep import UNSEEN, WallTargets, approach, renewed
from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.cutter import Cutter
from simulator.removal.zmap import HeightGrid, ZMap
from stepnc_model.programs.program import Stock

GAP = 3.0
"""Multiple of the usual time between samples from which samples are missing."""

ELSEWHERE = 10.0
"""Multiple of the usual time between samples from which the tool may have been elsewhere than
on the line between them."""

FINEST = 6
"""Decimals of a millimetre up to which the rounding of positions is looked for."""

FLAT = 1e-3
"""Distance of the path from the line between two samples, mm, up to which it is this line."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoggedSamples:
    """N samples of a log, ascending in time, in the coordinates of the program."""

    time: Floats
    """Time, (N,), s."""
    position: Floats
    """Position of the tip of the tool, (N, 3), mm; no NaN."""
    tool: Ints
    """Number of the tool, (N,)."""
    workingstep: Ints
    """Index of the workingstep of the program, (N,); -1 where it is unknown."""
    is_measured: Bools | None = None
    """Whether no coordinate of a position is interpolated, so that the tool was there, (N,);
    None: of none."""

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, rows: slice) -> "LoggedSamples":
        return LoggedSamples(
            is_measured=None if self.is_measured is None else self.is_measured[rows],
            time=self.time[rows],
            position=self.position[rows],
            tool=self.tool[rows],
            workingstep=self.workingstep[rows],
        )

    @property
    def measured(self) -> Bools:
        """True if the tool was at each position, (N,)."""
        if self.is_measured is None:
            return np.ones(len(self), dtype=np.bool_)
        return self.is_measured


@dataclass(kw_only=True)
class LogFacts:
    """Resolution of a log. Running state."""

    samples: int = 0
    interval: float = 0.0
    """Usual time between samples, s."""
    rounding: float = 0.0
    """Step to which positions are rounded, mm; 0 if finer than a nanometre."""
    step: float = 0.0
    """Greatest usual distance between samples below the top of the stock, mm."""
    begin: float = 0.0
    """Time of the first sample, s."""
    end: float = 0.0
    gaps: int = 0
    """Number of gaps in which the tool moved."""
    longest_gap: float = 0.0
    """Longest time between samples in which the tool moved, s."""
    tools: set[int] = field(default_factory=set)
    """Numbers of the tools that the log shows."""
    low: Floats = field(default_factory=lambda: np.full(3, np.inf))
    """Least position, (3,), mm."""
    high: Floats = field(default_factory=lambda: np.full(3, -np.inf))
    """Greatest position, (3,), mm."""

    @property
    def span(self) -> Floats:
        """Extent of the positions, (3,), mm."""
        return self.high - self.low


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NearestSamples:
    """Nearest samples, and the travel of the tool around them; arrays of one shape."""

    time: Floats
    """Time, s; NaN where no tool came near."""
    step: Floats
    """Greatest distance between samples around it, mm."""
    bend: Floats
    """Greatest distance of the path from the lines between samples, mm, by how these turn."""
    rise: Floats
    """Greatest vertical way between samples around it, mm."""
    workingstep: Ints
    """Index of the workingstep of the log; -1 where it is unknown."""

    def followed_by(self, other: "NearestSamples") -> "NearestSamples":
        """These places and then others."""
        return NearestSamples(**{
            each.name: np.concatenate([getattr(self, each.name), getattr(other, each.name)])
            for each in fields(NearestSamples)
        })

    def meet(self, where: object, part: "SampledStretch", index: Ints) -> None:
        """Note that samples of a stretch came nearest to some places."""
        self.time[where] = part.samples.time[index]  # type: ignore[call-overload]
        self.step[where] = part.step[index]  # type: ignore[call-overload]
        self.bend[where] = part.bend[index]  # type: ignore[call-overload]
        self.rise[where] = part.rise[index]  # type: ignore[call-overload]
        self.workingstep[where] = part.samples.workingstep[index]  # type: ignore[call-overload]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledStretch:
    """Consecutive samples of one tool, with the way around each."""

    samples: LoggedSamples
    step: Floats
    """Greatest way between samples around each, (N,), mm."""
    bend: Floats
    """Greatest distance of the path from the lines around each, (N,), mm, by how they turn."""
    rise: Floats
    """Greatest vertical way between samples around each, (N,), mm."""
    unseen: Floats
    """Distance from the line to each sample, (N,), mm, to which the tool may have gone where
    samples are missing; 0 where none is."""
    is_gap: Bools
    """Whether so many are missing before a sample that the tool was elsewhere, (N,): what is
    on the line is not taken as cut."""
    way: Floats
    """Longest way that the tool may have gone to each sample, (N,), mm; infinite where it is
    not known. On straights it is the line."""

    @property
    def is_unseen(self) -> Bools:
        """True if the way to a sample is not wholly known, (N,)."""
        return np.asarray(self.is_gap | (self.unseen > 0.0))

    def blocks(self) -> Iterator[Ints]:
        """Samples at which the tool had moved, in blocks without a gap."""
        moves = np.linalg.norm(np.diff(self.samples.position, axis=0), axis=1) > STILL
        kept = np.flatnonzero(np.append(True, moves))
        for block in np.split(kept, np.flatnonzero(self.is_gap[kept])):
            if len(block) > 1:
                yield block


class ReferencePart(Protocol):
    """Part with which a log is compared."""

    @property
    def map(self) -> ZMap:
        """Its height map."""

    @property
    def targets(self) -> WallTargets:
        """Points on its walls."""


class SampleSteps:
    """Samples of a log piece by piece, with the way between them. Running state.

    Parameters
    ----------
    top : float, mm
        Height below which the tool may cut.
    """

    def __init__(self, top: float) -> None:
        self.facts = LogFacts()
        self._last: LoggedSamples | None = None
        self._top = top

    def pieces(self, samples: LoggedSamples) -> Iterator[SampledStretch]:
        """Yield samples of one tool each.

        The last sample before them is the first one of these.
        """
        if not len(samples):
            return
        if not self.facts.samples:
            self._begin(samples)
        self.facts.samples += len(samples)
        self.facts.end = float(samples.time[-1])
        self.facts.tools.update(np.unique(samples.tool).tolist())
        self.facts.low = np.minimum(self.facts.low, samples.position.min(axis=0))
        self.facts.high = np.maximum(self.facts.high, samples.position.max(axis=0))
        if self._last is not None:
            samples = joined((self._last, samples))
        self._last = samples[-1:]
        whole = self._stretch(samples)
        edges = np.flatnonzero(np.diff(samples.tool)) + 1
        for part in np.split(np.arange(len(samples)), edges):
            rows = slice(int(part[0]), int(part[-1]) + 1)
            yield SampledStretch(
                samples=samples[rows],
                step=whole.step[rows],
                bend=whole.bend[rows],
                rise=whole.rise[rows],
                unseen=whole.unseen[rows],
                # No line leads from the tool before.
                is_gap=np.where(part == part[0], False, whole.is_gap[rows]),
                way=whole.way[rows],
            )

    def _begin(self, samples: LoggedSamples) -> None:
        """Find interval and rounding of the log from its first piece."""
        self.facts.begin = float(samples.time[0])
        self.facts.interval = float(np.median(np.diff(samples.time))) if len(samples) > 1 else 0
        self.facts.rounding = rounding_of(samples.position)

    def _stretch(self, samples: LoggedSamples) -> SampledStretch:
        """Samples with the way between them, and how it turns."""
        lines = np.diff(samples.position, axis=0)
        way = np.linalg.norm(lines, axis=1)
        seconds = np.diff(samples.time)
        is_gap = (seconds > GAP * self.facts.interval) & (way > STILL)
        if is_gap.any():
            self.facts.gaps += int(is_gap.sum())
            longest = float(seconds[is_gap].max())
            self.facts.longest_gap = max(self.facts.longest_gap, longest)
        straight = way
        way = with_missing(way, seconds, self.facts.interval)
        is_usual = (samples.position[1:, 2] < self._top) & ~is_gap
        if is_usual.any():
            usual = float(np.quantile(way[is_usual], 0.99))
            self.facts.step = max(self.facts.step, usual)
        before, behind = turns_of(samples.position)
        turn = np.where(is_gap, pi, np.minimum(before + behind, pi))
        around = greatest_around(way)
        corner = 0.5 * around * np.sin(0.5 * turn)
        bend = greatest_around(corner)
        rise = greatest_around(np.where(is_gap, way, np.abs(lines[:, 2])))
        # Places to which the way from one end to the other is as long form an ellipse.
        unseen = 0.5 * np.sqrt(np.maximum(way * way - straight * straight, 0.0))
        unseen = np.where((way > straight) & (straight > STILL), unseen, 0.0)
        is_straight = ~is_gap & (np.minimum(before, behind) < STRAIGHT)
        furthest = longest_ways(np.where(is_straight, way, np.nan), seconds)
        furthest = np.where(corner < FLAT, straight, np.maximum(furthest, way))
        return SampledStretch(
            samples=samples,
            step=to_ends(around),
            bend=to_ends(bend),
            rise=to_ends(rise),
            unseen=np.concatenate(([0.0], unseen)),
            is_gap=np.append(False, is_gap & (seconds > ELSEWHERE * self.facts.interval)),
            way=np.append(0.0, np.where(is_gap, np.inf, furthest)),
        )


class LoggedPart:
    """Part that logged positions leave. Running state.

    Parameters
    ----------
    part : ReferencePart
        What it is compared with.
    cutters : mapping
        Shapes of tools by number; other tools remove nothing.
    raw : (T, 3, 3) array, mm
        Triangles of the raw part in the stock; without them it fills the stock.
    """

    def __init__(
        self,
        part: ReferencePart,
        stock: Stock,
        cutters: Mapping[int, Cutter | None],
        *,
        raw: Floats | None = None,
    ) -> None:
        self.targets = renewed(part.targets)
        self.possible = renewed(part.targets)
        """The same points, as the tool may have approached them where samples are missing."""
        self.possible_heights = np.full(part.map.grid.heights.shape, np.inf)
        """Heights to which it may have cut there."""
        self._left = PartSweep(stock, cell=part.map.cell, raw=raw)
        self.raw_volume = self._left.map.volume
        """Volume of the raw part, mm³."""
        self._cutters = cutters
        self._steps = SampleSteps(stock.high[2])
        self._walls = unmet(self.targets.away.shape)
        self._floors = unmet(part.map.grid.heights.shape)

    @property
    def facts(self) -> LogFacts:
        """Resolution of the log."""
        return self._steps.facts

    @property
    def map(self) -> ZMap:
        """Height map of what is left."""
        return self._left.map

    @property
    def walls(self) -> NearestSamples:
        """Samples nearest to the points on walls."""
        return self._walls

    @property
    def floors(self) -> NearestSamples:
        """Samples that cut the cells of the map last."""
        return self._floors

    def add(self, samples: LoggedSamples) -> None:
        """Remove the sweep of more samples, which are later than those before."""
        for part in self._steps.pieces(samples):
            cutter = self._cutters.get(int(part.samples.tool[0]))
            if cutter is not None:
                self._cut(part, cutter)

    def _cut(self, part: SampledStretch, cutter: Cutter) -> None:
        """Remove the sweep of consecutive samples with one tool."""
        self._consider(part, cutter)
        for block in part.blocks():
            points = part.samples.position[block]
            first = self._left.number
            self._left.cut(cutter, points)
            approach(self.targets, self._left.profile(cutter), rows_between(points), first)
            for row, nearest in (
                (self.targets.row, self._walls),
                (self._left.map.grid.owner, self._floors),
            ):
                where = np.nonzero(row >= first)
                nearest.meet(where, part, block[1:][row[where] - first])

    def _consider(self, part: SampledStretch, cutter: Cutter) -> None:
        """Note where the tool may have been while samples are missing."""
        ends = np.flatnonzero(part.is_unseen)
        if not len(ends):
            return
        points = np.stack((part.samples.position[ends - 1], part.samples.position[ends]))
        points[:, :, 2] -= part.unseen[ends]
        rows = np.concatenate([rows_between(points[:, each]) for each in range(len(ends))])
        rows[:, UNSEEN] = part.unseen[ends]
        approach(self.possible, self._left.profile(cutter), rows, 0)
        grid = self._left.map.grid
        is_wide = part.is_gap[ends] | (part.unseen[ends] > 0.5 * self._left.map.cell)
        for row in rows[is_wide]:
            lower_near(self.possible_heights, grid, row, 0.5 * cutter.diameter + row[UNSEEN])


def lower_near(heights: Floats, grid: HeightGrid, row: Floats, reach: float) -> None:
    """Lower heights within a distance of a line in plan to the lower end of the line, mm."""
    low, high = np.minimum(row[0:2], row[3:5]) - reach, np.maximum(row[0:2], row[3:5]) + reach
    size, corner = np.array([grid.dx, grid.dy]), np.array([grid.x, grid.y])
    first = np.maximum(np.floor((low - corner) / size), 0).astype(int)
    last = np.minimum(np.ceil((high - corner) / size), heights.shape).astype(int)
    if (last <= first).any():
        return
    columns, rows = (slice(a, b) for a, b in zip(first, last, strict=True))
    x = grid.x + (np.arange(first[0], last[0]) + 0.5)[:, None] * grid.dx - row[0]
    y = grid.y + (np.arange(first[1], last[1]) + 0.5)[None, :] * grid.dy - row[1]
    along = row[3:5] - row[0:2]
    square = max(float(along @ along), STILL * STILL)
    share = np.clip((x * along[0] + y * along[1]) / square, 0.0, 1.0)
    is_near = np.hypot(x - share * along[0], y - share * along[1]) <= reach
    part = heights[columns, rows]
    part[is_near] = np.minimum(part[is_near], min(row[2], row[5]))


def joined(parts: Sequence[LoggedSamples]) -> LoggedSamples:
    """Samples of several parts in one."""
    is_measured = None
    if any(part.is_measured is not None for part in parts):
        is_measured = np.concatenate([part.measured for part in parts])
    return LoggedSamples(
        is_measured=is_measured,
        time=np.concatenate([part.time for part in parts]),
        position=np.concatenate([part.position for part in parts]),
        tool=np.concatenate([part.tool for part in parts]),
        workingstep=np.concatenate([part.workingstep for part in parts]),
    )


def rounding_of(position: Floats) -> float:
    """Step to which positions are rounded, mm; 0 if it is finer than ``FINEST`` decimals."""
    for decimals in range(FINEST + 1):
        if np.abs(position - np.round(position, decimals)).max(initial=0.0) < 1e-9:
            return float(10.0**-decimals)
    return 0.0


def unmet(shape: tuple[int, ...]) -> NearestSamples:
    """Places to which no sample came near yet."""
    return NearestSamples(
        time=np.full(shape, np.nan),
        step=np.zeros(shape),
        bend=np.zeros(shape),
        rise=np.zeros(shape),
        workingstep=np.full(shape, -1, dtype=np.int64),
    )
