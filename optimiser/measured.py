"""Cuts as the real tool path makes them, in the stock that is left, timed by the machine.

Each workingstep's path cuts the stock of its setup, which goes on to the next workingstep. From
what the tool meets come the hardest places, for the limits, and the mean load, for the energy;
from the motion of the axes comes the time. What lasts as long as the feed says counts as
length, in mm at the programmed feed, with ratios of it and a spindle that follows the radius.
The rest counts as time: ramps, rapids, moves with a feed of their own, waits.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from optimiser.clamped import Change, ClampedStocks, Meeting, Place, StockMap, met_by
from optimiser.cut import Cut, CutKind
from optimiser.estimated import GUESSES, estimated_cut
from optimiser.hardest import Met, greatest_section, weighted_volume, with_hardest
from optimiser.other_depth import with_depth
from optimiser.plunge import plunge_of
from optimiser.problem import Setting
from optimiser.side_by_side import Result, one_by_one, side_by_side
from simulator.motion.segments import Bools
from simulator.motion.tool_path import (
    Pace,
    Run,
    duration,
    follows,
    paced,
    run_of,
    usual_motion,
)
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.trial import Trial, do_overlap, is_remembered_alike, renumbered
from simulator.spec import Machine, MachineKind, Material
from stepnc_model.errors import Finding, PostError, SchemaError, Severity
from stepnc_model.post.blocks import Machine as PostMachine
from stepnc_model.post.conditions import Conditions, conditions
from stepnc_model.program import Program, Workingstep
from stepnc_model.technology import programmed
from stepnc_model.toolpath.generate import require_ready, workingstep_path
from stepnc_model.toolpath.path import Feed, ToolPath


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seen:
    """A path that was tried, and what it met."""

    path: ToolPath
    run: Run
    """as programmed"""
    cut: Cut
    """with the engagement as met"""
    passes: int
    weighted: float
    """weighted volume over that of the hardest place, mm"""
    air: float
    """share of the length that removes nothing"""
    meeting: Meeting
    times: dict[tuple[float, float], Cut] = field(default_factory=dict)
    """the cut as timed already, by the ratios of feed and speed; filled when asked for"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """What a workingstep looked at and changed."""

    place: Place | None = None
    """which stock"""
    change: Change | None = None
    trial: Trial | None = None
    """that of the change; None: not of a mill"""
    trials: tuple[Trial, ...] = ()
    """of all paths that were tried"""
    left_out: dict[int, str] = field(default_factory=dict)
    """features whose path could not be made, with the workingstep"""


class MeasuredCuts:
    """A source of cuts along real paths. Running state: what is left of each stock.

    The stock goes on to the next workingstep as the path that was asked for last leaves it.
    """

    def __init__(self, program: Program, machine: Machine, material: Material) -> None:
        self.program = program
        self.machine = machine
        self.material = material
        self.kienzle = material.kienzle
        self.control, self.limits = usual_motion(machine)
        self.stocks = ClampedStocks(program, machine)
        self._left_out: dict[int, str] = {}
        """workingstep without a path, by the instance number of its feature"""
        self._estimate: Cut | None = None
        self._found: StockMap | None = None
        """what the workingstep finds"""
        self._seen: dict[int, _Seen] = {}
        """paths of the workingstep, by the number of passes"""
        self._trace = Trace()
        self._numbers: dict[Place, dict[int, int]] = {}
        """new numbers of the first moves of workingsteps that are repeated, by the old ones"""

    def cut(self, step: Workingstep) -> tuple[Cut, list[Finding]]:
        """The cut of a workingstep as programmed, and what was assumed.

        Where no path can be made, or what it meets is not known, the estimate from the feature
        takes its place, and a finding says so.

        Raises
        ------
        SchemaError
            When the workingstep lacks what a cut needs.
        """
        self._seen = {}
        self._trace = Trace(place=self.stocks.place(step))
        cut, findings = estimated_cut(self.program, step, self.material)
        self._estimate, self._found = cut, self.stocks.before(step)
        try:
            seen = self._see(step, self._path(step), cut, passes=cut.programmed.passes)
        except (SchemaError, PostError) as error:
            self._leave_out(step)
            text = f"no tool path: length, time and engagement are estimated ({error})"
            return cut, [*findings, self._warning(step, text)]
        findings += [each for each in seen.path.findings if each.severity is not Severity.NOTE]
        if not seen.meeting.why:
            findings = [each for each in findings if each.message not in GUESSES]
        else:
            text = f"the engagement is estimated from the feature: {seen.meeting.why}"
            findings.append(self._warning(step, text))
        return self._timed(step, seen, feed=1.0, speed=1.0), findings

    def at(self, step: Workingstep, cut: Cut, setting: Setting) -> Cut:
        """The same cut as the path of another setting makes it.

        Where a path in other passes cannot be made, all passes are taken to be alike.
        """
        given, estimate = cut.programmed, self._estimate
        if not self._seen or estimate is None:
            return cut
        if setting.passes not in self._seen:
            other = replace(estimate.programmed, depth=setting.depth, passes=setting.passes)
            try:
                path = workingstep_path(*with_depth(self.program, step, setting.depth))
                nominal = replace(estimate, programmed=other)
                self._see(step, path, nominal, passes=setting.passes)
            except (SchemaError, PostError):
                self._seen[setting.passes] = self._seen[given.passes]
        seen = self._seen[setting.passes]
        self._leave(step, seen.meeting)
        feed, speed = setting.feed / given.feed, setting.speed / given.speed
        timed = self._timed(step, seen, feed=feed, speed=speed)
        passes, depth = estimate.programmed.passes, estimate.programmed.depth
        return replace(timed, programmed=replace(timed.programmed, passes=passes, depth=depth))

    def leave_out(self, step: Workingstep) -> None:
        """Cut the stock as a workingstep does that is not advised but is run."""
        stock = self.stocks.before(step)
        self._trace = Trace(place=self.stocks.place(step))
        try:
            run = self._run(self._path(step), Pace(technology=step.technology_ref))
        except (SchemaError, PostError):
            self._leave_out(step)
            return
        self._leave(step, met_by(self.program, step, run, stock))

    def each(
        self, steps: Sequence[Workingstep], do: Callable[[Workingstep], Result]
    ) -> Iterator[Result]:
        """Results of workingsteps in their order; of a mill on two cores."""
        if self.machine.kind is MachineKind.LATHE:
            return one_by_one(steps, do)
        return side_by_side(steps, do, self)

    def split(self) -> None:
        """Prepare to repeat what a copy does from now on."""
        self._numbers = {}

    def trace(self) -> Trace:
        """Where the last workingstep looked, and what it changed."""
        return self._trace

    def is_apart(self, step: Workingstep, trace: Trace, others: Sequence[Trace]) -> bool:
        """Whether a workingstep would have met the same after others."""
        features = {int(feature) for feature in step.features}
        if any(features & other.left_out.keys() for other in others):
            return False
        others = [other for other in others if other.place == trace.place]
        stock = self.stocks.before(step)
        if not isinstance(stock, MillingStock):
            return not others
        boxes = [trial.box for other in others for trial in other.trials]
        return all(
            is_remembered_alike(trial, stock.next_move - trial.before.next)
            and not any(do_overlap(trial.box, box) for box in boxes)
            for trial in trace.trials
        )

    def repeat(self, step: Workingstep, trace: Trace) -> None:
        """Change the stock as a workingstep has changed a copy of it."""
        self._left_out |= trace.left_out
        stock, change = self.stocks.before(step), trace.change
        if trace.trial is not None and isinstance(stock, MillingStock):
            numbers = self._numbers.setdefault(self.stocks.place(step), {})
            numbers[trace.trial.before.next] = stock.next_move
            change = renumbered(trace.trial, stock.next_move, numbers)
        self.stocks.leave(step, change)

    def _leave(self, step: Workingstep, meeting: Meeting) -> None:
        """What the next workingstep finds, and what is told of it."""
        self.stocks.leave(step, meeting.change)
        trials = self._trace.trials
        if meeting.trial is not None and meeting.trial not in trials:
            trials = (*trials, meeting.trial)
        self._trace = replace(
            self._trace, change=meeting.change, trial=meeting.trial, trials=trials
        )

    def _leave_out(self, step: Workingstep) -> None:
        """Without its path, what comes after it on its features would meet too much."""
        without = {int(feature): step.id for feature in step.features}
        self._left_out |= without
        self._trace = replace(self._trace, left_out=without)

    def _path(self, step: Workingstep) -> ToolPath:
        """Path of a workingstep as programmed."""
        require_ready(self.program, step, self._left_out)
        return workingstep_path(self.program, step)

    def _run(self, path: ToolPath, pace: Pace) -> Run:
        """What the axes run; each feed is looked up once."""
        is_lathe = path.is_turning or self.machine.kind is MachineKind.LATHE
        kind = PostMachine.LATHE if is_lathe else PostMachine.MILL
        known: dict[Feed, Conditions] = {}

        def look_up(feed: Feed) -> Conditions:
            with self.program.using(feed.technology):
                return conditions(self.program, feed, path.tool_ref, kind)

        at_pace = paced(look_up, pace)

        def known_at_pace(feed: Feed) -> Conditions:
            if feed not in known:
                known[feed] = at_pace(feed)
            return known[feed]

        with self.program.using(path.operation_ref):
            return run_of(path, known_at_pace, self.machine.spindle)

    def _see(self, step: Workingstep, path: ToolPath, cut: Cut, *, passes: int) -> _Seen:
        """Try a path in the stock that the workingstep finds."""
        run = self._run(path, Pace(technology=step.technology_ref))
        meeting = met_by(self.program, step, run, self._found)
        met = meeting.met
        weighted, air = 0.0, 0.0
        if met is not None:
            # Levels of a mill are equal, however deep they were asked to be.
            is_equal = cut.kind is CutKind.MILLING and cut.is_depth_free
            depth = cut.total_depth / passes if is_equal else cut.programmed.depth
            cut = self._engaged(step, cut, met, run, depth=depth)
            section, ratio = greatest_section(cut, depth=depth)
            weighted = weighted_volume(met, self.kienzle.m_c)
            weighted /= section * ratio**-self.kienzle.m_c
            air = _air_share(run, met, follows(run, step.technology_ref))
        self._seen[passes] = seen = _Seen(
            path=path,
            run=run,
            cut=cut,
            passes=passes,
            weighted=weighted,
            air=air,
            meeting=meeting,
        )
        self._leave(step, meeting)
        return seen

    def _engaged(self, step: Workingstep, cut: Cut, met: Met, run: Run, *, depth: float) -> Cut:
        """The cut as it was met; turning is told where the programmed path is widest."""
        cut = replace(cut, volume=met.volume)
        if cut.kind in {CutKind.TURNING, CutKind.GROOVING} and not cut.is_air:
            first = next(iter(self._seen.values()), None)
            widest = self._widest(met, run) if first is None else first.cut.diameter
            cut = self._at_widest(step, cut, widest)
        plunge = plunge_of(cut, met, follows(run, step.technology_ref))
        return with_hardest(replace(cut, plunge=plunge), met, self.kienzle, depth=depth)

    def _widest(self, met: Met, run: Run) -> float:
        """Diameter of the bar where it is cut, mm: the same in however many passes."""
        stations, stock = met.stations, self._found
        if not isinstance(stock, TurningStock):
            return float(stations.diameter.max())
        z = run.segments.position(stations.segment, stations.station)[:, 2]
        cut = z[stations.section > 0.0]
        inside = (stock.z >= cut.min() - stock.cell) & (stock.z <= cut.max() + stock.cell)
        if not inside.any():
            return float(stations.diameter.max())
        return 2.0 * float(stock.outer[inside].max())

    def _at_widest(self, step: Workingstep, cut: Cut, diameter: float) -> Cut:
        """Speeds and loads of turning are those at its greatest diameter: nothing is harder."""
        found = programmed(self.program, step.technology_ref)
        speed = found.spindle_speed(diameter)
        feed = found.feed_per_tooth(speed, cut.tool.teeth)
        given = replace(cut.programmed, speed=speed, feed=feed)
        return replace(cut, diameter=diameter, programmed=given)

    def _timed(self, step: Workingstep, seen: _Seen, *, feed: float, speed: float) -> Cut:
        """The cut of a path, run so much faster than programmed."""
        if (feed, speed) not in seen.times:
            seen.times[feed, speed] = self._run_through(step, seen, feed=feed, speed=speed)
        return seen.times[feed, speed]

    def _run_through(self, step: Workingstep, seen: _Seen, *, feed: float, speed: float) -> Cut:
        """The same, with the motion of the axes."""
        cut, given = seen.cut, seen.cut.programmed
        run = seen.run
        if (feed, speed) != (1.0, 1.0):
            pace = Pace(technology=step.technology_ref, feed=feed, speed=speed)
            run = self._run(seen.path, pace)
        seconds = run.segments.length / run.segments.speed
        fed = float(seconds[follows(run, step.technology_ref)].sum())
        rest = max(0.0, duration(run, self.control, self.limits) - fed)
        length = fed * given.feed * feed * cut.tool.teeth * given.speed * speed
        known = not seen.meeting.why and length > 0.0
        return replace(
            cut,
            length=length / seen.passes,
            rest_time=rest / seen.passes,
            link_length=0.0,
            floor=None if cut.floor is None else replace(cut.floor, length=0.0),
            load_share=seen.weighted / length if known else 1.0,
            air_length=seen.air * length / seen.passes,
        )

    def _warning(self, step: Workingstep, text: str) -> Finding:
        return self.program.finding(Severity.WARNING, text, step.operation_ref)


def _air_share(run: Run, met: Met, is_bound: Bools) -> float:
    """Share of the time at the programmed feed in which nothing is removed."""
    row = met.stations.segment
    seconds = met.length / run.segments.speed[row]
    bound = is_bound[row]
    whole = float(seconds[bound].sum())
    is_air = bound & (met.stations.kind == StationKind.AIR)
    return float(seconds[is_air].sum()) / whole if whole > 0.0 else 0.0
