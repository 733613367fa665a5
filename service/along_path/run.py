"""Feeds along the paths of a program: the plan, and what the virtual machine makes of it.

The program runs on the virtual machine twice to learn what its tools meet, in its stock and in
one that is larger by a margin. The plan runs again; where a block that was split meets a little
more than the whole block did, its feed is lowered, and it runs once more.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from optimiser.along_path.pieces import PieceRules
from optimiser.along_path.plan import (
    BlockFeeds,
    FeedPlanner,
    FeedTask,
    PartPlan,
    block_feeds,
    lowered,
)
from optimiser.along_path.runs import MachineFeeds
from optimiser.along_path.stretch import excess
from service.along_path.course import BlockLog, Choose, stretches_of
from service.progress import Ticker
from service.reading import Tell, silent
from service.simulation.setup import PreparedRun
from simulator.machine.samples import Episode
from simulator.machine.totals import Total, added
from simulator.machine.virtual import VirtualMachine
from simulator.motion.segments import ControlModel, axis_limits
from stepnc_model.errors import Finding
from stepnc_model.post.block_feeds import with_feeds
from stepnc_model.post.blocks import Block

EXCESS = 1.002
"""Feed over the permitted feed above which a part is lowered."""

MOST_ROUNDS = 4
"""Greatest number of runs of a plan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongPathTask:
    """How the feeds along the paths are to be planned."""

    control: ControlModel
    levels: int | None = None
    """Largest number of feeds in each part of the program; None: any."""
    margin: float = 1.0
    """Distance from the stock within which nothing counts as air, mm."""
    tolerance: float = 0.05
    """Rounding of corners by the control that is always permitted, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongPathStep:
    """One part of a program before and after, as the virtual machine runs it."""

    name: str
    before: Total
    """Run at the given feeds."""
    after: Total
    """Run at the planned feeds."""
    plan: PartPlan | None
    """Plan of its feeds; None if none was chosen."""

    @property
    def planned_time(self) -> float:
        """Time that the plan predicts under the control model, s."""
        if self.plan is None:
            return self.before.duration
        change = self.plan.time - self.plan.programmed_time + self.plan.window_change
        return self.before.duration + change


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongPath:
    """Feeds along the paths of a program."""

    feeds: BlockFeeds
    steps: tuple[AlongPathStep, ...]
    findings: tuple[Finding, ...] = ()
    """Findings of the run at the planned feeds."""
    rounds: int = 1
    """Number of runs of the plan."""

    @property
    def time_before(self) -> float:
        """Time of the run at the given feeds, s."""
        return sum(step.before.duration for step in self.steps)

    @property
    def time_after(self) -> float:
        """Time of the run at the planned feeds, s."""
        return sum(step.after.duration for step in self.steps)

    @property
    def planned_time(self) -> float:
        """Time that the plan predicts, s."""
        return sum(step.planned_time for step in self.steps)

    @property
    def parts(self) -> int:
        """Number of parts into which blocks were split beyond their number."""
        return sum(len(parts) - 1 for parts in self.feeds.values())


def along_path(
    prepare: Callable[[float], PreparedRun],
    bounds: Choose,
    task: AlongPathTask,
    *,
    tell: Tell = silent,
) -> AlongPath:
    """Plan the feeds along the paths of a program, and run the plan.

    Parameters
    ----------
    prepare : callable
        Prepares the program anew, in a stock that is larger by a distance in mm.
    bounds : callable
        Bounds of a part of the program; None if its feed may not be chosen.
    task : AlongPathTask
    tell : callable
        Receives progress.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    ticker = Ticker(tell)
    given = prepare(0.0)
    log = BlockLog(given.blocks)
    larger = prepare(task.margin) if task.margin > 0.0 else None
    machine = given.machine
    limits = axis_limits(machine)
    feeds_of_machine = MachineFeeds(
        control=task.control,
        limits=limits,
        greatest=machine.max_feed,
        tolerance=task.tolerance,
    )
    rules = PieceRules(block_time=limits.block_time)
    planner = FeedPlanner(FeedTask(machine=feeds_of_machine, rules=rules, levels=task.levels))
    before = _Totals(ticker, "planning")
    for stretch in stretches_of(
        given, larger, control=task.control, bounds=bounds, log=log, watch=before.add
    ):
        planner.add(stretch)
    plan = planner.plan()
    feeds: BlockFeeds = dict(block_feeds(plan))
    rounds = 0
    while True:
        rounds += 1
        after, ratios, findings = _run(prepare(0.0), feeds, bounds, task, ticker)
        if not ratios or rounds == MOST_ROUNDS:
            break
        feeds = lowered(feeds, ratios, keeps_levels=task.levels is not None)
    parts = {part.name: part for part in plan.parts}
    steps = tuple(
        AlongPathStep(name=name, before=one, after=other, plan=parts.get(name))
        for (name, one), (_, other) in zip(before.rows(), after.rows(), strict=True)
    )
    return AlongPath(feeds=feeds, steps=steps, findings=findings, rounds=rounds)


class _Totals:
    """Totals of a run by its parts. Running state."""

    def __init__(self, ticker: Ticker, what: str) -> None:
        self._totals: list[Total] = []
        self._names: list[str] = [""]
        self._ticker, self._what = ticker, what

    def add(self, episode: Episode, machine: VirtualMachine) -> None:
        """Add an episode."""
        at = episode.state.workingstep
        self._totals += [Total() for _ in range(len(self._totals), at + 1)]
        self._totals[at] = added(self._totals[at], episode, machine.machine)
        self._names = ["", *machine.workingsteps]
        self._ticker(lambda: f"{self._what}: {machine.now:.0f} s of machining")

    def rows(self) -> list[tuple[str, Total]]:
        """Names and totals of the parts, in the order of execution."""
        return list(zip(self._names, self._totals, strict=False))


class _Emitted:
    """Blocks at their new feeds, with the block and part that each comes from."""

    def __init__(self, prepared: PreparedRun, feeds: BlockFeeds) -> None:
        self._log = BlockLog(prepared.blocks)
        self._feeds = feeds
        self.origin: list[tuple[int, int]] = [(0, 0)]

    def __iter__(self) -> Iterator[tuple[int, Block]]:
        for number, block in with_feeds(self._log, self._feeds):
            last, part = self.origin[-1]
            self.origin.append((number, part + 1 if number == last else 0))
            yield self._log.lines[number], block


def _run(
    prepared: PreparedRun,
    feeds: BlockFeeds,
    bounds: Choose,
    task: AlongPathTask,
    ticker: Ticker,
) -> tuple[_Totals, dict[tuple[int, int], float], tuple[Finding, ...]]:
    """Run a plan; return totals, and the excess of parts over their permitted feeds."""
    emitted = _Emitted(prepared, feeds)
    log = BlockLog(emitted)
    totals = _Totals(ticker, "running the plan")
    ratios: dict[tuple[int, int], float] = {}
    machines: list[VirtualMachine] = []

    def watch(episode: Episode, machine: VirtualMachine) -> None:
        totals.add(episode, machine)
        machines[:] = [machine]

    changed = replace(prepared, blocks=iter(()))
    for stretch in stretches_of(
        changed, None, control=task.control, bounds=bounds, log=log, watch=watch
    ):
        found = excess(stretch)
        for row in np.flatnonzero(found > EXCESS).tolist():
            origin = emitted.origin[int(stretch.segments.block[row])]
            if origin[0] in feeds:
                ratios[origin] = max(float(found[row]), ratios.get(origin, 1.0))
    return totals, ratios, tuple(machines[0].findings) if machines else ()
