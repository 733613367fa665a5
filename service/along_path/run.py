"""Feeds along the paths of a program: the plan, and what the virtual machine makes of it.

The program runs on the virtual machine twice to learn what its tools meet, in its stock and in
one that is larger by a margin. Then the plan runs; where a block that was split meets a little
more than the whole block did, its feed is lowered, and the plan runs once more.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from optimiser.along_path.caps import CapName
from optimiser.along_path.deep_places import DeepPlaces
from optimiser.along_path.free_profile import FASTEST_ALONE, FreeProfile, FreeTask
from optimiser.along_path.pieces import PieceRules
from optimiser.along_path.plan import (
    PERMITTED,
    BlockFeeds,
    FeedPlan,
    FeedPlanner,
    FeedTask,
    PartPlan,
    block_feeds,
    lowered,
)
from optimiser.along_path.runs import MachineFeeds
from optimiser.along_path.slow_parts import slower_part
from optimiser.planning.reasons import broken_words
from service.along_path.course import PathSource, stretches_of
from service.along_path.plan_run import LimitStretch, PartTotals, PlanRun, run_plan
from service.along_path.trace import PathTrace
from service.progress import Tell, Ticker, silent
from service.simulation.line_spans import overload_bounds
from simulator.machine.totals import Total
from simulator.motion.segments import ControlModel, axis_limits
from simulator.spec import Machine
from stepnc_model.errors import Finding, Severity

MOST_ROUNDS = 6
"""Greatest number of runs of a plan."""

UNSPLIT_ROUNDS = 3
"""Number of the last runs after which parts are slower as a whole: the path, and with it what
the tools meet, is then the same in all of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongPathTask:
    """Settings for planning the feeds along the paths."""

    control: ControlModel
    levels: int | None = None
    """Largest number of feeds in each part of the program; None: any."""
    margin: float = 1.0
    """Distance from the stock within which nothing counts as air, mm."""
    tolerance: float = 0.05
    """Rounding of corners by the control that is always permitted, mm."""
    greatest: float | None = None
    """Greatest feed that the user permits, mm/s; None: that of the machine."""
    keeps_idle: bool = False
    """Whether parts of the program that meet no stock keep their feeds."""
    free: FreeTask = FASTEST_ALONE
    """Further free profiles that are computed."""
    keeps_traces: bool = False
    """Whether feed, force and power of both runs are kept for plots."""


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


BEYOND_LIMITS = {
    CapName.LEAST: "the limits demand less than the least feed (--least-feed), which is taken",
    CapName.SHOULDER: "the insert meets more than its greatest depth of cut, as at a shoulder; "
    "the programmed feed stays there",
}
"""What is warned of where a feed stands beyond what the limits tell."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedsAlongPath:
    """Feeds along the paths of a program."""

    feeds: BlockFeeds
    steps: tuple[AlongPathStep, ...]
    idle: tuple[str, ...] = ()
    """Parts of the program that kept their feeds because they meet no stock."""
    findings: tuple[Finding, ...] = ()
    """Findings of the run at the planned feeds."""
    before_trace: PathTrace | None = None
    """Signals of the run at the given feeds; None unless they were asked for."""
    after_trace: PathTrace | None = None
    """Signals of the run at the planned feeds."""
    limits: tuple[LimitStretch, ...] = ()
    """Active limits along the path."""
    deep: Mapping[str, DeepPlaces] = field(default_factory=dict)
    """Places where mills cut deeper than their tools allow, by part of the program."""

    @property
    def shown(self) -> tuple[AlongPathStep, ...]:
        """Parts of the program that take time."""
        return tuple(step for step in self.steps if step.before.duration > 0.0)

    @property
    def slower_than_programmed(self) -> tuple[str, ...]:
        """Sentences on the parts of NC code that take longer than programmed, and on why."""
        told = (
            slower_part(step.plan, step.before.duration, step.after.duration)
            for step in self.shown
            if step.plan is not None
        )
        return tuple(text for text in told if text)

    @property
    def too_deep(self) -> tuple[Finding, ...]:
        """Warnings of NC code whose mills cut deeper than their tools allow."""
        return tuple(
            Finding(
                severity=Severity.WARNING,
                message=f"{name}: as programmed {broken_words(deep.load)}, on "
                f"{deep.length:.4g} mm of its path: no feed makes it less deep; program more "
                "passes, or a narrower cut",
                line=deep.block,
            )
            for name, deep in self.deep.items()
        )

    @property
    def above_limits(self) -> tuple[Finding, ...]:
        """Warnings of parts with feeds above what the limits permit, or beyond their reach."""
        return tuple(
            Finding(
                severity=Severity.WARNING,
                message=f"{step.name}: on {step.plan.shares[name][0]:.4g} mm of its path "
                f"{text}",
            )
            for step in self.shown
            for name, text in BEYOND_LIMITS.items()
            if step.plan is not None and name in step.plan.shares
        )

    def faults(self, machine: Machine) -> tuple[Finding, ...]:
        """Rapids through material, and parts that overload the machine."""
        beyond = tuple(
            Finding(
                severity=Severity.ERROR,
                message=f"{step.name}: {step.after.overload_time:.3g} s above "
                f"{overload_bounds(machine)}",
            )
            for step in self.steps
            if step.after.overload_time > 0.0
        )
        met = (each for each in self.findings if each.severity is Severity.ERROR)
        return (*met, *beyond)

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
    def free(self) -> FreeProfile:
        """Free profile of all parts together."""
        whole = FreeProfile()
        for step in self.steps:
            whole = whole if step.plan is None else whole.plus(step.plan.free)
        return whole

    @property
    def parts(self) -> int:
        """Number of parts into which blocks were split beyond their number."""
        return sum(len(parts) - 1 for parts in self.feeds.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPlan:
    """Planned feeds of a program before the plan was run."""

    planner: FeedPlanner
    before: PartTotals
    """Run at the given feeds."""
    kept: frozenset[str]
    """Parts of the program that keep their feeds."""
    plan: FeedPlan
    feeds: BlockFeeds
    """Feeds of the blocks that change."""

    @property
    def excess(self) -> float:
        """Greatest given feed over the greatest that the process permits."""
        return max(self.planner.excess.values(), default=0.0)


def along_path(
    source: PathSource, task: AlongPathTask, *, tell: Tell = silent
) -> FeedsAlongPath:
    """Plan the feeds along the paths of a program, and run the plan.

    Parameters
    ----------
    tell : callable
        Receives progress.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    ticker = Ticker(tell)
    return run_of(planned(source, task, ticker=ticker), source, task, ticker=ticker)


def planned(
    source: PathSource, task: AlongPathTask, *, ticker: Ticker, what: str = "planning"
) -> PathPlan:
    """Plan the feeds along the paths of a program.

    Parameters
    ----------
    what : str
        Name of the run in messages.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    given = source.prepare(0.0)
    planner = FeedPlanner(feed_task(given.machine, task))
    before = PartTotals(
        ticker, what, share=lambda _: given.done(), keeps_trace=task.keeps_traces
    )
    for stretch in stretches_of(
        given,
        source.prepare(task.margin) if task.margin > 0.0 else None,
        control=task.control,
        bounds=source.bounds,
        log=source.numbered(given),
        watch=before.add,
        caution=source.caution,
    ):
        planner.add(stretch)
    return _path_plan(planner, before, _idle(before) if task.keeps_idle else frozenset())


def _path_plan(planner: FeedPlanner, before: PartTotals, kept: frozenset[str]) -> PathPlan:
    """Plan in which some parts keep their feeds."""
    plan = planner.plan(kept=kept)
    return PathPlan(
        planner=planner, before=before, kept=kept, plan=plan, feeds=dict(block_feeds(plan))
    )


def run_of(
    path_plan: PathPlan, source: PathSource, task: AlongPathTask, *, ticker: Ticker
) -> FeedsAlongPath:
    """Run a plan, with slower feeds where it is too fast.

    A part of the program that is permitted as given and hardly gains stays as it is.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    feeds, run = _permitted(path_plan, source, task, ticker)
    without_gain = _without_gain(path_plan, run)
    if without_gain:
        kept = path_plan.kept | without_gain
        path_plan = _path_plan(path_plan.planner, path_plan.before, kept)
        feeds, run = _permitted(path_plan, source, task, ticker)
    before, after = path_plan.before, run.totals
    parts = {part.name: part for part in path_plan.plan.parts}
    return FeedsAlongPath(
        feeds=feeds,
        steps=tuple(
            AlongPathStep(name=name, before=one, after=other, plan=parts.get(name))
            for (name, one), (_, other) in zip(before.rows(), after.rows(), strict=True)
        ),
        idle=tuple(sorted(_idle(before))) if task.keeps_idle else (),
        findings=tuple(after.findings),
        before_trace=before.trace(),
        after_trace=after.trace(),
        limits=run.limits,
        deep=dict(path_plan.planner.deep),
    )


def _permitted(
    path_plan: PathPlan, source: PathSource, task: AlongPathTask, ticker: Ticker
) -> tuple[BlockFeeds, PlanRun]:
    """Feeds of a plan, slower where its runs find them too fast, and their run."""
    feeds, left = path_plan.feeds, MOST_ROUNDS
    while True:
        left -= 1
        totals = PartTotals(
            ticker,
            "running the plan",
            share=path_plan.before.share_of_time,
            keeps_trace=task.keeps_traces,
        )
        run = run_plan(
            source,
            feeds,
            task=path_plan.planner.task,
            splits=left >= UNSPLIT_ROUNDS,
            totals=totals,
        )
        if not run.slower or not left:
            return feeds, run
        feeds = lowered(feeds, run.slower, blocks=run.blocks, levels=task.levels)


def _without_gain(path_plan: PathPlan, run: PlanRun) -> frozenset[str]:
    """Changed parts that are permitted as given, and whose run takes hardly less time."""
    planner, after = path_plan.planner, dict(run.totals.rows())
    plans = {part.name: part for part in path_plan.plan.parts}
    kept_loss = planner.task.rules.kept_loss
    found = set()
    for name, given in path_plan.before.rows():
        plan = plans.get(name)
        if plan is None or name in path_plan.kept or plan.time == plan.programmed_time:
            continue
        gain = given.duration - after[name].duration
        is_small = gain <= kept_loss * (plan.programmed_time - gain)
        if is_small and planner.excess[name] <= PERMITTED:
            found.add(name)
    return frozenset(found)


def _idle(totals: PartTotals) -> frozenset[str]:
    """Names of the parts of a program that remove nothing."""
    return frozenset(name for name, total in totals.rows() if total.volume <= 0.0)


def _rules(machine: Machine, block_time: float) -> PieceRules:
    """Rules for splitting blocks, from the machine's file."""
    usual = PieceRules()
    length, change = machine.least_block, machine.least_feed_change
    return PieceRules(
        least_length=usual.least_length if length is None else length,
        least_change=usual.least_change if change is None else change,
        block_time=block_time,
    )


def feed_task(machine: Machine, task: AlongPathTask) -> FeedTask:
    """Task of the optimiser for a machine, with its limits and its control."""
    limits = axis_limits(machine)
    return FeedTask(
        machine=MachineFeeds(
            control=task.control,
            limits=limits,
            greatest=min(
                (each for each in (machine.max_feed, task.greatest) if each is not None),
                default=None,
            ),
            tolerance=task.tolerance,
        ),
        rules=_rules(machine, limits.block_time),
        levels=task.levels,
        free=task.free,
    )
