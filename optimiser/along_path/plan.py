"""Plan of the feeds along the paths of a program, with what proves it.

The stretches of a program come one after another; each gives the pieces of its blocks. When all
are known, the feeds of each part of the program (a workingstep, or a tool of an NC program) may
be reduced to a few, and are rounded down to what a program can say.

Every plan carries a lower bound of its time: no motion within the same caps takes less than
``Σ L/cap`` over the places of the path, whatever the control.

Units: mm, mm/s, s.
"""

from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass, field, replace

import numpy as np

from optimiser.along_path.caps import NAMES, NUMBER, CapName
from optimiser.along_path.deep_places import DeepPlaces, with_deep_places
from optimiser.along_path.filter_transfer import BrokenBound, excess, most_broken
from optimiser.along_path.free_profile import FASTEST_ALONE, FreeProfile, FreeTask, free_profile
from optimiser.along_path.pieces import (
    Executions,
    FeedPieces,
    PieceRules,
    pieces_of,
    without_small_changes,
)
from optimiser.along_path.place_loads import broken_bounds, lost_times, worst_bounds
from optimiser.along_path.runs import MachineFeeds, commands_of, own_caps, written_caps
from optimiser.along_path.stretch import PathStretch, PlaceCaps, place_caps
from optimiser.feed_profile.levels import best_levels
from simulator.motion.segments import Bools, Floats, Ints
from simulator.motion.smoothing import smoothing_of
from stepnc_model.post.block_feeds import BlockPart
from stepnc_model.units import speed_from_mm_min

BlockFeeds = Mapping[int, tuple[BlockPart, ...]]
"""Parts of the blocks that change, by the number of the block."""

PERMITTED = 1.01
"""Programmed feed over the permitted one up to which a part may stay as it is."""

PER_MINUTE_STEP = speed_from_mm_min(1.0)
"""Step of a written feed per time, mm/s: 1 mm/min."""

PER_REVOLUTION_STEP = 0.001
"""Step of a written feed per revolution, mm."""

COARSEST = 0.01
"""Greatest loss of feed by rounding; finer steps are written where it would be more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedTask:
    """Settings for planning the feeds of a program."""

    machine: MachineFeeds
    rules: PieceRules
    levels: int | None = None
    """Largest number of feeds in each part of the program; None: any."""
    free: FreeTask = FASTEST_ALONE
    """Further free profiles that are computed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartPlan:
    """Planned feeds of one part of a program."""

    name: str
    length: float
    """Length of the moves whose feed was chosen, mm."""
    programmed_time: float
    """Their time at the programmed feeds, s."""
    time: float
    """Their time at the planned feeds, s."""
    unlimited_time: float
    """Their time at the planned feeds before they were reduced to a few, s."""
    bound: float
    """Lower bound of their time within the same caps, s."""
    window_change: float
    """Change of the time in which the control's filter settles, s."""
    free: FreeProfile
    """Profile without a control: what blocks and filter cost."""
    feeds: int
    """Number of different feeds."""
    shares: Mapping[CapName, tuple[float, float]]
    """Length in mm and time in s at each active limit."""
    rise_cost: float = 0.0
    """Time that the greatest rise over the programmed feeds costs, s."""
    lost: Mapping[CapName, float] = field(default_factory=dict)
    """Time that each bound of the process costs where the program breaks it, s."""
    broken: Mapping[CapName, BrokenBound] = field(default_factory=dict)
    """Bounds that the programmed feeds break, each where it is broken most."""

    @property
    def levels_gap(self) -> float:
        """Share of the time that the reduction to a few feeds adds."""
        return self.time / self.unlimited_time - 1.0 if self.unlimited_time > 0.0 else 0.0

    @property
    def gap(self) -> float:
        """Share of the time above its lower bound."""
        return self.time / self.bound - 1.0 if self.bound > 0.0 else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FeedPlan:
    """Planned feeds of a program: parts of blocks, in the order of the path."""

    pieces: FeedPieces
    part: Ints
    """Row in :attr:`parts` of each piece, (P,)."""
    parts: tuple[PartPlan, ...]


class FeedPlanner:
    """Planner that takes the stretches of a program one after another. Running state."""

    def __init__(self, task: FeedTask) -> None:
        self.task = task
        self._pieces: dict[str, list[FeedPieces]] = {}
        self._bounds: dict[str, float] = {}
        self._free: dict[str, FreeProfile] = {}
        self._given_windows: dict[str, float] = {}
        self._excess: dict[str, float] = {}
        """Greatest programmed feed over what the process permits, by part."""
        self._locked: list[float] = []
        """Greatest feed of each run that may not be chosen, mm/s."""
        self._rise_cost: dict[str, float] = {}
        self._broken: dict[str, BrokenBound] = {}
        self._by_name: dict[str, dict[CapName, BrokenBound]] = {}
        """Bounds that each part breaks, each where it is broken most."""
        self.deep: Mapping[str, DeepPlaces] = {}
        """Places where mills cut deeper than their tools allow, by part of the program."""
        self._kept: set[int] = set()
        """Blocks that keep their feeds."""

    @property
    def excess(self) -> Mapping[str, float]:
        """Greatest programmed feed over what the process permits, by part of the program."""
        return self._excess

    @property
    def broken(self) -> Mapping[str, BrokenBound]:
        """Programmed feeds farthest above what the process permits, by part of the program."""
        return {name: worst for name, worst in self._broken.items() if worst.ratio > PERMITTED}

    def add(self, stretch: PathStretch) -> None:
        """Plan the feeds of a stretch.

        Raises
        ------
        ValueError
            When an engagement is not a number.
        """
        machine, places = self.task.machine, place_caps(stretch)
        commands = commands_of(stretch, places, machine)
        name = stretch.workingstep
        pieces = pieces_of(stretch, commands, self.task.rules)
        earlier = len(self._locked)
        pieces = replace(pieces, run=pieces.run + earlier, last_run=pieces.last_run + earlier)
        self._pieces.setdefault(name, []).append(pieces)
        self._locked += commands.greatest_locked.tolist()
        self._bounds[name] = self._bounds.get(name, 0.0) + self._least_time(stretch, places)
        free = free_profile(stretch, places, machine, self.task.free)
        self._free[name] = self._free.get(name, FreeProfile()).plus(free)
        most = float(excess(stretch, machine).max(initial=0.0))
        if machine.greatest is not None:
            # A run shows no such excess: the machine goes no faster.
            most = max(most, float(pieces.programmed.max(initial=0.0)) / machine.greatest)
        self._excess[name] = max(most, self._excess.get(name, 0.0))
        given = self._given_windows.get(name, 0.0)
        self._given_windows[name] = given + commands.programmed_window
        worst, known = most_broken(stretch, machine), self._broken.get(name)
        if worst is not None and (known is None or worst.ratio > known.ratio):
            self._broken[name] = worst
        broken = broken_bounds(stretch, pieces)
        self._by_name[name] = worst_bounds(self._by_name.get(name, {}), broken)
        self.deep = with_deep_places(self.deep, stretch)
        cost = self._cost_of_rise(stretch, places, pieces)
        self._rise_cost[name] = self._rise_cost.get(name, 0.0) + cost
        if stretch.is_kept is not None:
            self._kept |= set(stretch.segments.block[stretch.is_kept].tolist())

    def _cost_of_rise(
        self, stretch: PathStretch, places: PlaceCaps, pieces: FeedPieces
    ) -> float:
        """Time that the greatest rise costs on a stretch, s."""
        if not len(pieces) or not (pieces.name == NUMBER[CapName.RISE]).any():
            return 0.0
        any_rise = replace(stretch, rise=None)
        commands = commands_of(any_rise, places, self.task.machine)
        free = pieces_of(any_rise, commands, self.task.rules)
        return max(
            float((pieces.weight / pieces.rate).sum() - (free.weight / free.rate).sum()), 0.0
        )

    def _least_time(self, stretch: PathStretch, places: PlaceCaps) -> float:
        """Lower bound of the time of the moves whose feed may be chosen, s."""
        lengths = np.diff(places.ends, prepend=0.0)
        caps = places.caps.least(
            own_caps(stretch, self.task.machine).least(written_caps(stretch)).at(places.segment)
        )
        rows = stretch.is_free[places.segment] & (lengths > 0.0)
        return float((lengths[rows] / caps.feed[rows]).sum())

    def plan(self, *, kept: Set[str] = frozenset()) -> FeedPlan:
        """Plan of all stretches that were added.

        Parameters
        ----------
        kept : set of str
            Parts of the program that keep their feeds.
        """
        free = {name: joined(found) for name, found in self._pieces.items()}
        free = {name: pieces for name, pieces in free.items() if len(pieces)}
        if not free:
            return FeedPlan(pieces=joined([]), part=np.zeros(0, dtype=np.int64), parts=())
        free = in_every_run(free)
        chosen: dict[str, FeedPieces] = {}
        for name, pieces in free.items():
            planned = replace(pieces, rate=_levelled(pieces, self.task.levels))
            change = self.task.rules.least_change
            planned = replace(planned, rate=without_small_changes(planned, change))
            is_kept = name in kept or self._is_as_good(name, planned)
            of_blocks = np.isin(planned.block, list(self._kept)) | is_kept
            rate = np.where(of_blocks, planned.programmed, planned.rate)
            chosen[name] = replace(planned, rate=rate)
        chosen = in_every_run(chosen)
        parts = tuple(self._part(name, free[name], chosen[name]) for name in chosen)
        numbers = np.repeat(np.arange(len(parts)), [len(each) for each in chosen.values()])
        return FeedPlan(pieces=joined(chosen.values()), part=numbers, parts=parts)

    def _is_as_good(self, name: str, pieces: FeedPieces) -> bool:
        """True if a part is permitted as programmed and takes hardly more time.

        The engagement is known for stretches that depend on how the path is cut into blocks. A
        plan that changes little would change it again when its result is planned.
        """
        if self._excess[name] > PERMITTED:
            return False
        given = float((pieces.weight / pieces.programmed).sum()) + self._given_windows[name]
        planned = float((pieces.weight / pieces.rate).sum()) + self._window(pieces)
        return given <= (1.0 + self.task.rules.kept_loss) * planned

    def _window(self, pieces: FeedPieces) -> float:
        """Time in which the control's filter settles after the runs of some pieces, s."""
        number = pieces.last_run - pieces.run + 1
        piece = np.repeat(np.arange(len(pieces)), number)
        run = pieces.run[piece] + np.arange(len(piece)) - (np.cumsum(number) - number)[piece]
        runs, row = np.unique(run, return_inverse=True)
        greatest = np.array(self._locked)[runs]
        np.maximum.at(greatest, row, (pieces.rate * pieces.length / pieces.weight)[piece])
        machine = self.task.machine
        return sum(
            smoothing_of(machine.control, machine.limits, feed).window
            for feed in greatest.tolist()
        )

    def _part(self, name: str, free: FeedPieces, chosen: FeedPieces) -> PartPlan:
        seconds = chosen.weight / chosen.rate
        shares = {
            NAMES[number]: (
                float(chosen.length[chosen.name == number].sum()),
                float(seconds[chosen.name == number].sum()),
            )
            for number in np.unique(chosen.name)
        }
        return PartPlan(
            name=name,
            length=float(chosen.length.sum()),
            programmed_time=float((chosen.weight / chosen.programmed).sum()),
            time=float(seconds.sum()),
            unlimited_time=float((free.weight / free.rate).sum()),
            bound=self._bounds[name],
            window_change=self._window(chosen) - self._given_windows[name],
            free=self._free[name],
            feeds=len(np.unique(chosen.rate)),
            shares=shares,
            rise_cost=self._rise_cost[name],
            lost=lost_times(chosen),
            broken=self._by_name[name],
        )


def joined(parts: Iterable[FeedPieces]) -> FeedPieces:
    """Pieces of several stretches, one after another."""
    found = [part for part in parts if len(part)]
    if not found:
        nothing, none = np.zeros(0), np.zeros(0, dtype=np.int64)
        return FeedPieces(
            block=none,
            begin=nothing,
            length=nothing,
            weight=nothing,
            rate=nothing,
            name=none,
            programmed=nothing,
            is_per_revolution=np.zeros(0, dtype=np.bool_),
            run=none,
            last_run=none,
        )
    return FeedPieces(**{
        name: np.concatenate([getattr(part, name) for part in found])
        for name in FeedPieces.__slots__
    })


def in_every_run(parts: Mapping[str, FeedPieces]) -> dict[str, FeedPieces]:
    """Pieces at feeds that every execution of their blocks permits.

    A block that runs more than once, also in several parts of a program as a subprogram may,
    has the least feed that any execution needs.
    """
    whole = joined(parts.values())
    block, row = np.unique(whole.block, return_inverse=True)
    runs = np.bincount(row, weights=whole.begin == 0.0)
    least = np.full(len(block), np.inf)
    np.minimum.at(least, row, whole.rate)
    rate = np.where(runs[row] > 1, least[row], whole.rate)
    ends = np.cumsum([len(each) for each in parts.values()])[:-1]
    return {
        name: replace(pieces, rate=own)
        for (name, pieces), own in zip(parts.items(), np.split(rate, ends), strict=True)
    }


def _levelled(pieces: FeedPieces, levels: int | None) -> Floats:
    """Feeds of the pieces, rounded down, and at most a number of them per unit."""
    rate = rounded_down(pieces.rate, pieces.programmed, pieces.is_per_revolution)
    if levels is None:
        return rate
    for unit in (False, True):
        rows = np.flatnonzero(pieces.is_per_revolution == unit)
        if len(rows):
            rate[rows] = best_levels(pieces.weight[rows], rate[rows], count=levels).feeds
    return rate


def rounded_down(rate: Floats, programmed: Floats, is_per_revolution: Bools) -> Floats:
    """Feeds rounded down to numbers that a program can say; programmed feeds stay."""
    step = np.where(is_per_revolution, PER_REVOLUTION_STEP, PER_MINUTE_STEP)
    for _ in range(4):
        step = np.where(step > COARSEST * rate, 0.1 * step, step)
    rounded: Floats = np.floor(rate / step * (1.0 + 1e-12)) * step
    return np.where(rate == programmed, rate, np.maximum(rounded, 0.1 * step))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlowerPart:
    """Part of a planned block that is too fast, with the feeds that it may have."""

    parts: tuple[BlockPart, ...]
    """Slower feeds over the length of the part, 0 to 1."""
    excess: float
    """Its feed over the least of them."""

    def or_slower(self, other: "SlowerPart | None") -> "SlowerPart":
        """Feeds that two executions of the part permit; it is not divided then."""
        if other is None:
            return self
        slowest = min(self.parts + other.parts, key=lambda part: part.rate)
        most = max(self.excess, other.excess)
        return SlowerPart(parts=(replace(slowest, end=1.0),), excess=most)


def slower_parts(pieces: FeedPieces) -> Iterator[tuple[int, SlowerPart]]:
    """Yield slower feeds by block number, once for each execution of a block."""
    if not len(pieces):
        return
    rates = rounded_down(pieces.rate, pieces.programmed, pieces.is_per_revolution)
    runs = Executions(pieces, rates)
    excess = np.maximum.reduceat(pieces.programmed / pieces.rate, runs.starts)
    for row, (block, most) in enumerate(
        zip(pieces.block[runs.starts].tolist(), excess.tolist(), strict=True)
    ):
        yield block, SlowerPart(parts=runs.parts(row), excess=most)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunBlock:
    """Block as it was run, all of its executions together."""

    name: str
    """Part of the program."""
    weight: float
    """Time at a feed of 1 in its unit."""
    rate: float
    """Feed in its unit; of one of its parts where it has several."""
    is_per_revolution: bool = False

    def plus(self, other: "RunBlock | None") -> "RunBlock":
        """The block with another execution."""
        return self if other is None else replace(self, weight=self.weight + other.weight)


def lowered(
    feeds: BlockFeeds,
    slower: Mapping[tuple[int, int], SlowerPart],
    *,
    blocks: Mapping[int, RunBlock],
    levels: int | None,
) -> BlockFeeds:
    """Feeds in which each part that is too fast is slower.

    Parameters
    ----------
    feeds : mapping
        Parts of the changed blocks by block number.
    slower : mapping
        Slower feeds by block and row of the part; a block without an entry in ``feeds`` has one
        part.
    blocks : mapping
        All blocks whose feeds may change, as they were run; needed with ``levels``.
    levels : int or None
        Largest number of feeds in each part of the program; None: any.
    """
    found = dict(feeds)
    for block in dict.fromkeys(block for block, _ in slower):
        whole = feeds.get(block) or (replace(slower[block, 0].parts[0], end=1.0),)
        found[block] = tuple(_divided(block, whole, slower))
    return found if levels is None else _in_levels(found, blocks, levels)


def _in_levels(feeds: BlockFeeds, blocks: Mapping[int, RunBlock], levels: int) -> BlockFeeds:
    """Feeds of all blocks, at most some number of them in each part of the program."""
    rows: dict[tuple[str, bool], list[tuple[int, BlockPart, float]]] = {}
    for block, run in blocks.items():
        whole = BlockPart(end=1.0, rate=run.rate, is_per_revolution=run.is_per_revolution)
        begin = 0.0
        for part in feeds.get(block, (whole,)):
            group = rows.setdefault((run.name, part.is_per_revolution), [])
            group.append((block, part, run.weight * (part.end - begin)))
            begin = part.end
    found: dict[int, list[BlockPart]] = {}
    for group in rows.values():
        weight, rate = np.array([(weight, part.rate) for _, part, weight in group]).T
        chosen = best_levels(weight, rate, count=levels).feeds.tolist()
        for (block, part, _), feed in zip(group, chosen, strict=True):
            if block in feeds or feed != part.rate:
                found.setdefault(block, []).append(replace(part, rate=feed))
    return {block: _joined(parts) for block, parts in found.items()}


def _divided(
    block: int,
    whole: tuple[BlockPart, ...],
    slower: Mapping[tuple[int, int], SlowerPart],
) -> Iterator[BlockPart]:
    """Parts of a block, those that are too fast divided into slower ones."""
    begin = 0.0
    for row, part in enumerate(whole):
        given = slower.get((block, row))
        for each in (part,) if given is None else given.parts:
            end = part.end
            if given is not None and each is not given.parts[-1]:
                end = begin + each.end * (part.end - begin)
            yield replace(each, end=end)
        begin = part.end


def _joined(parts: Iterable[BlockPart]) -> tuple[BlockPart, ...]:
    """Parts of a block; neighbours of equal feed are one."""
    found: list[BlockPart] = []
    for part in parts:
        if found and found[-1].rate == part.rate:
            found.pop()
        found.append(part)
    return tuple(found)


def block_feeds(plan: FeedPlan) -> Iterator[tuple[int, tuple[BlockPart, ...]]]:
    """Yield the feeds of each block that changes; parts of equal feed are one."""
    pieces = plan.pieces
    if not len(pieces):
        return
    runs = Executions(pieces, pieces.rate)
    is_changed = np.logical_or.reduceat(pieces.rate != pieces.programmed, runs.starts)
    # A block that is executed again has the feeds of the first time.
    firsts = np.unique(pieces.block[runs.starts], return_index=True)[1]
    for row in firsts[is_changed[firsts]].tolist():
        yield int(pieces.block[runs.starts[row]]), runs.parts(row)
