"""Rewritten NC code that a second run leaves as it is.

The ends of split blocks are rounded to what the program can say, and the engagement is known
for stretches that depend on how the path is cut into blocks: the blocks of the written code may
be too fast, or be permitted more. So what is written is planned again, and what this changes is
written into the program, until nothing changes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from optimiser.along_path.caps import CapName
from optimiser.along_path.plan import PERMITTED, BlockFeeds, lowered
from optimiser.safety import USUAL_RISE
from service.along_path.caution import mark_of
from service.along_path.course import PathSource
from service.along_path.plan_run import PartTotals, run_plan
from service.along_path.run import (
    AlongPathStep,
    AlongPathTask,
    FeedsAlongPath,
    PathPlan,
    planned,
    run_of,
)
from service.progress import Tell, Ticker, silent
from service.simulation.code_paths import CodePaths
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.advice import BlockAdvice, RewrittenCode
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.nc.written_lines import WrittenLines
from stepnc_model.post.block_feeds import BlockPart

MOST_PLANS = 8
"""Greatest number of plans of the written code."""

MOST_NOTES = 16
"""Number of blocks that are tried for the comment on the rise."""

NO_NOTES: Mapping[int, str] = MappingProxyType({})

CHECK = "planning the written program again"

NOT_SETTLED = Finding(
    severity=Severity.WARNING,
    message=f"after {MOST_PLANS} plans the feeds still change: a second run will change some",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeSource:
    """NC program whose feeds are planned and written."""

    program: NcProgram
    paths_of: Callable[[NcProgram], CodePaths]
    """Function that prepares a program for runs."""
    source_of: Callable[[CodePaths], PathSource]
    """Function that gives paths the bounds of their tools."""
    mark: bool = False
    """Whether changed blocks get a comment with the reason."""
    rise: float = USUAL_RISE
    """Greatest feed over the programmed one, of which a comment tells where it holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenCode:
    """Feeds along the paths of an NC program, and the program with them."""

    along: FeedsAlongPath
    rewritten: RewrittenCode
    findings: tuple[Finding, ...] = ()
    """Findings on what was written."""
    doubts: tuple[Finding, ...] = ()
    """Moves of the program that cast doubt on its stock."""
    faults: tuple[Finding, ...] = ()
    """Feeds above what the process permits that could not be lowered."""


def written_code(
    source: CodeSource, task: AlongPathTask, *, tell: Tell = silent
) -> WrittenCode:
    """Plan the feeds along the paths of an NC program, and write them.

    Parameters
    ----------
    tell : callable
        Receives progress.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    code = source.paths_of(source.program)
    paths = source.source_of(code)
    ticker = Ticker(tell)
    plans = [planned(paths, task, ticker=ticker)]
    along = run_of(plans[0], paths, task, ticker=ticker)
    doubts = () if paths.caution is None else tuple(paths.caution.findings())
    rewritten = _rewritten(source, code, along.feeds)
    if rewritten.data == source.program.text.data:
        return WrittenCode(
            along=_left_alone(along),
            rewritten=rewritten,
            doubts=doubts,
            faults=_broken(plans[0]),
        )
    feeds, plans, is_settled = along.feeds, list[PathPlan](), False
    while not is_settled and len(plans) < MOST_PLANS:
        written = source.source_of(_paths_of_written(source, rewritten))
        if paths.caution is not None:
            written = replace(written, caution=paths.caution.of_written(rewritten.lines))
        plans.append(
            planned(written, replace(task, keeps_traces=False), ticker=ticker, what=CHECK)
        )
        is_settled = not plans[-1].feeds
        if not is_settled:
            more = _changes(plans[-1], written, task, ticker)
            feeds = composed(feeds, more, rewritten.lines)
            new = _rewritten(source, code, feeds)
            is_settled = new.data == rewritten.data
            rewritten = new
    if len(plans) > 1:
        along = _refined(replace(along, feeds=feeds), plans, paths, task, ticker)
    return WrittenCode(
        along=_as_written(along, plans[-1]),
        rewritten=rewritten,
        findings=() if is_settled else (NOT_SETTLED,),
        doubts=doubts,
        faults=_broken(plans[-1], rewritten.lines),
    )


def _broken(plan: PathPlan, lines: WrittenLines | None = None) -> tuple[Finding, ...]:
    """Faults of the parts of a program whose feeds are above what the process permits."""
    found = []
    for name, worst in plan.planner.broken.items():
        text = f"{name}: {worst.words}, and could not be lowered"
        line = worst.block if lines is None else lines.origin(worst.block).line
        found.append(Finding(severity=Severity.ERROR, message=text, line=line))
    return tuple(found)


def composed(feeds: BlockFeeds, more: BlockFeeds, lines: WrittenLines) -> BlockFeeds:
    """Feeds of a program with those that were found for its rewritten code.

    Parameters
    ----------
    feeds : mapping
        Parts by the line of the program.
    more : mapping
        Parts by the line of the rewritten code.
    """
    changes: dict[int, list[tuple[float, float, tuple[BlockPart, ...]]]] = {}
    for line, parts in more.items():
        origin = lines.origin(line)
        changes.setdefault(origin.line, []).append((origin.begin, origin.end, parts))
    found = dict(feeds)
    for line, changed in changes.items():
        joined = [
            replace(part, end=end if part is parts[-1] else begin + part.end * (end - begin))
            for begin, end, parts in changed
            for part in parts
        ]
        begin = 0.0
        for part in feeds.get(line, ()):
            middle = 0.5 * (begin + part.end)
            if not any(low < middle < high for low, high, _ in changed):
                joined.append(part)
            begin = part.end
        found[line] = tuple(sorted(joined, key=lambda part: part.end))
    return found


def block_advice(
    code: CodePaths, block: int, parts: tuple[BlockPart, ...], *, note: str = ""
) -> BlockAdvice:
    """Advice for a block of the file; feeds per revolution at its greatest speed."""
    fastest = code.fastest(block) if parts[0].is_per_revolution else 1.0
    reasons = dict.fromkeys(part.reason for part in parts)
    return BlockAdvice(
        block=block,
        ends=tuple(part.end for part in parts),
        feeds=tuple(part.rate * fastest for part in parts),
        reason=", ".join(reasons),
        note=note,
    )


def _rewritten(source: CodeSource, code: CodePaths, feeds: BlockFeeds) -> RewrittenCode:
    """Program with some feeds; a comment tells how far they rose, if that bounds any.

    Without it a second run would take the risen feeds for programmed ones.
    """
    bounded = [
        line
        for line, parts in feeds.items()
        if any(part.reason == CapName.RISE.words for part in parts)
    ]
    mark = mark_of(source.rise)
    for line in bounded[:MOST_NOTES]:
        found = _fed(source, code, feeds, notes={line: mark})
        if mark.encode() in found.data:
            return found
    return _fed(source, code, feeds)


def _fed(
    source: CodeSource, code: CodePaths, feeds: BlockFeeds, notes: Mapping[int, str] = NO_NOTES
) -> RewrittenCode:
    """Program with some feeds, and with comments on some lines."""
    blocks = code.blocks_at(list(feeds)).tolist()
    advice = (
        block_advice(code, block, parts, note=notes.get(line, ""))
        for block, (line, parts) in zip(blocks, feeds.items(), strict=True)
    )
    return rewrite(source.program, advice, mark=source.mark)


def _paths_of_written(source: CodeSource, rewritten: RewrittenCode) -> CodePaths:
    """Paths of the rewritten code."""
    program = source.program
    return source.paths_of(
        read_program(
            rewritten.data,
            dialect=program.dialect,
            machine=program.machine,
            most_repeats=program.most_repeats,
            keeps_state=program.keeps_state,
        )
    )


def _changes(
    plan: PathPlan, source: PathSource, task: AlongPathTask, ticker: Ticker
) -> BlockFeeds:
    """Feeds of the rewritten code that change: slower ones where it is too fast, else a plan.

    A block that is too fast stays in one piece, and with it the path and what the tools meet.
    """
    if plan.excess > PERMITTED:
        totals = PartTotals(
            ticker, "running the plan", share=plan.before.share_of_time, keeps_trace=False
        )
        run = run_plan(source, {}, task=plan.planner.task, splits=False, totals=totals)
        if run.slower:
            return lowered({}, run.slower, blocks=run.blocks, levels=task.levels)
    return run_of(plan, source, task, ticker=ticker).feeds


def _refined(
    along: FeedsAlongPath,
    plans: Sequence[PathPlan],
    source: PathSource,
    task: AlongPathTask,
    ticker: Ticker,
) -> FeedsAlongPath:
    """Plan whose feeds were refined by plans of the written code, with its own run."""
    totals = PartTotals(
        ticker,
        "running the plan",
        share=plans[-1].before.share_of_time,
        keeps_trace=task.keeps_traces,
    )
    run = run_plan(
        source, along.feeds, task=plans[-1].planner.task, splits=False, totals=totals
    )
    return replace(
        along,
        steps=tuple(_refined_step(step, plans) for step in along.steps),
        findings=tuple(totals.findings),
        after_trace=totals.trace(),
        limits=run.limits,
    )


def _refined_step(step: AlongPathStep, plans: Sequence[PathPlan]) -> AlongPathStep:
    """Part of a program with the last of its plans."""
    found = [part for each in plans for part in each.plan.parts if part.name == step.name]
    if step.plan is None or not found:
        return step
    plan = replace(
        found[-1],
        programmed_time=step.plan.programmed_time,
        lost=step.plan.lost,
        broken=step.plan.broken,
        window_change=sum(part.window_change for part in (step.plan, *found)),
    )
    return replace(step, plan=plan)


def _as_written(along: FeedsAlongPath, last: PathPlan) -> FeedsAlongPath:
    """Plan with the run of the code as it was written."""
    runs = dict(last.before.rows())
    return replace(
        along,
        steps=tuple(
            replace(step, after=runs.get(step.name, step.after)) for step in along.steps
        ),
    )


def _left_alone(along: FeedsAlongPath) -> FeedsAlongPath:
    """Plan of which nothing was written: the program runs as before."""
    return replace(along, steps=tuple(replace(step, after=step.before) for step in along.steps))
