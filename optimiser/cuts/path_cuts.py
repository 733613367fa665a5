"""Cuts along real tool paths in the remaining stock, timed by the machine's axes.

Each workingstep's path cuts the stock of its setup, which goes on to the next workingstep. The
contacts along the path give the hardest places, for the limits, and the mean load, for the
energy; the motion of the axes gives the time. Motion whose time depends on the programmed feed
counts as length, in mm at that feed, with ratios of it and a spindle that follows the radius.
The rest counts as time: ramps, rapids, moves with a feed of their own, waits.

Paths with other depths of passes are tried too: those of the program as
:mod:`stepnc_model.editing.writeback` would write it, without writing it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from optimiser.cuts.bare_path import greatest_depth, is_path_only
from optimiser.cuts.cut import Cut, CutKind, RefusedPasses
from optimiser.cuts.feature_cuts import GUESSES, estimated_cut
from optimiser.cuts.fixtured_stock import (
    BodyMaps,
    ClampedStocks,
    StockMap,
    StockPlace,
    TrialContacts,
    met_by,
)
from optimiser.cuts.hardest_places import (
    PathContacts,
    bending,
    greatest_section,
    turned_of,
    weighted_volume,
    with_hardest,
)
from optimiser.cuts.path_trial import (
    SearchTrace,
    TriedPath,
    air_share,
    difference_left,
    with_depth,
)
from optimiser.cuts.plunge_engagement import (
    PlungeCuts,
    along_passes,
    down_ramps,
    is_fed,
    plunge_feed_of,
    plunge_of,
    way_in_of,
)
from optimiser.cuts.reached_loads import (
    MachineRun,
    plunge_reached,
    thickened,
    with_power,
    with_reached,
)
from optimiser.cuts.two_cores import Result, one_by_one, side_by_side
from optimiser.solver.problem import Setting
from simulator.motion.passing import motion_of
from simulator.motion.tool_path import (
    PathGeometry,
    SpeedRatios,
    ToolPathRun,
    paced,
    plunges,
    run_of,
    usual_motion,
)
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.trial import do_overlap, is_remembered_alike, renumbered
from simulator.spec import Machine, MachineKind, WorkMaterial
from stepnc_model.errors import Finding, PostError, SchemaError, Severity
from stepnc_model.post.blocks import MachineType as PostMachine
from stepnc_model.post.modal_state import ModalState, conditions
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import programmed
from stepnc_model.toolpath.generate import PathOf, require_ready, workingstep_path
from stepnc_model.toolpath.path import Feed, ToolPath


class MeasuredCuts:
    """Source of cuts along real paths (mutable state: the remaining stock of each setup).

    The stock passes to the next workingstep as the path that was requested last leaves it.

    Parameters
    ----------
    is_run : bool
        Whether a simulated run is compared with the plan; the cuts then include all loads that
        the axes actually reach, and not only those above what the feed says.
    body_map : BodyMaps, optional
        Maker of maps of raw parts that are bodies; without it, their box or bar counts.
    path_of : callable
        Maker of the paths of workingsteps as programmed.
    """

    def __init__(
        self,
        program: Program,
        machine: Machine,
        material: WorkMaterial,
        *,
        is_run: bool = False,
        body_map: BodyMaps | None = None,
        path_of: PathOf = workingstep_path,
    ) -> None:
        self.program = program
        self.path_of = path_of
        self.is_run = is_run
        self.machine = machine
        self.material = material
        self.kienzle = material.kienzle
        self.control, self.limits = usual_motion(machine)
        self.stocks = ClampedStocks(program, machine, body_map)
        self._left_out: dict[int, str] = {}
        """Ids of workingsteps without a path, by the instance number of their feature."""
        self._estimate: Cut | None = None
        self._found: StockMap | None = None
        """Stock map that the workingstep finds."""
        self._seen: dict[int, TriedPath] = {}
        """Tried paths of the workingstep, by the number of passes."""
        self._refused: dict[int, str] = {}
        """Why numbers of passes of the workingstep are no candidates."""
        self._paths: dict[int, ToolPath] = {}
        """Paths of the workingstep in other numbers of passes."""
        self._shapes: dict[int, PathGeometry] = {}
        """Geometries of the paths of the workingstep, by the identity of the path."""
        self._trace = SearchTrace()
        self._numbers: dict[StockPlace, dict[int, int]] = {}
        """New numbers of the first moves of repeated workingsteps, by their old numbers."""

    def cut(self, step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        """Return the cut of a workingstep as programmed, with findings on assumptions.

        Where the contacts of its path are not known, the estimate from the feature takes their
        place, and a finding says so.

        Raises
        ------
        SchemaError, PostError
            When the workingstep lacks what a cut needs, or no path can be made.
        """
        self._seen, self._refused, self._paths, self._shapes = {}, {}, {}, {}
        self._trace = SearchTrace(place=self.stocks.place(step))
        depth = self._depth_met(step) if is_path_only(self.program, step) else None
        cut, findings = estimated_cut(
            self.program, step, self.machine, self.material, depth=depth
        )
        self._estimate, self._found = cut, self.stocks.before(step)
        # Where no path can be made, no run could follow the advice.
        seen = self._see(step, self._path(step), cut, passes=cut.programmed.passes)
        assumed = self.stocks.assumed.get(self.stocks.place(step))
        if assumed is not None:
            at = step.ref if step.setup is None else step.setup
            findings.append(self.program.finding(Severity.WARNING, assumed, at))
        findings += [each for each in seen.path.findings if each.severity is not Severity.NOTE]
        if not seen.meeting.why:
            findings = [each for each in findings if each.message not in GUESSES]
        else:
            text = f"the engagement is estimated from the feature: {seen.meeting.why}"
            findings.append(self._warning(step, text))
        return self._timed(step, seen, seen.cut.programmed), findings

    def _depth_met(self, step: ResolvedWorkingstep) -> float | None:
        """Greatest depth that a given path meets, mm; None where none is known."""
        run = self._run(self._path(step), SpeedRatios(technology=step.technology_ref))
        met = met_by(self.program, step, run, self.stocks.before(step)).met
        return None if met is None else greatest_depth(run, met)

    def at(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut as the path of another setting makes it.

        It names the numbers of passes tried so far that leave other stock than the programmed
        number, or of which no path can be made.
        """
        given, estimate = cut.programmed, self._estimate
        if not self._seen or estimate is None:
            return cut
        if setting.passes not in self._seen:
            self._see_other(step, estimate, setting, self._seen[given.passes])
        seen = self._seen[setting.passes]
        self._leave(step, seen.meeting)
        timed = self._timed(step, seen, setting)
        passes, depth = estimate.programmed.passes, estimate.programmed.depth
        return replace(
            timed,
            programmed=replace(timed.programmed, passes=passes, depth=depth),
            refused_passes=tuple(RefusedPasses(*each) for each in self._refused.items()),
        )

    def timed(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut with length and time of another setting's path, not its contacts.

        Where that path cannot be made, all passes are assumed alike.
        """
        if not self._seen:
            return cut
        try:
            path = self._other_path(step, setting)
            run = self._run(path, SpeedRatios(technology=step.technology_ref))
        except (SchemaError, PostError):
            return cut
        seen = TriedPath(
            path=path,
            run=run,
            cut=cut,
            passes=setting.passes,
            weighted=0.0,
            air=0.0,
            meeting=TrialContacts(why="the path is not tried in the stock"),
            along=None,
            bent=None,
            slope=None,
        )
        return self._timed(step, seen, setting)

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        """Cut the stock with a workingstep that is not optimised but will run."""
        stock, self._shapes = self.stocks.before(step), {}
        self._trace = SearchTrace(place=self.stocks.place(step))
        try:
            run = self._run(self._path(step), SpeedRatios(technology=step.technology_ref))
        except (SchemaError, PostError):
            self._leave_out(step)
            return
        self._leave(step, met_by(self.program, step, run, stock))

    def map_workingsteps(
        self, steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
    ) -> Iterator[Result]:
        """Results of workingsteps in their order; on a mill two processes are used."""
        if self.machine.kind is MachineKind.LATHE:
            return one_by_one(steps, do)
        return side_by_side(steps, do, self)

    def split(self) -> None:
        """Prepare to repeat the changes that a copy of this state makes from now on."""
        self._numbers = {}

    def trace(self) -> SearchTrace:
        """Trace of the last workingstep: the stock that it read and changed."""
        return self._trace

    def is_apart(
        self, step: ResolvedWorkingstep, trace: SearchTrace, others: Sequence[SearchTrace]
    ) -> bool:
        """True if a workingstep would have met the same stock after the others."""
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

    def repeat(self, step: ResolvedWorkingstep, trace: SearchTrace) -> None:
        """Apply the stock change that a workingstep made in a copy of this state."""
        self._left_out |= trace.left_out
        stock, change = self.stocks.before(step), trace.change
        if trace.trial is not None and isinstance(stock, MillingStock):
            numbers = self._numbers.setdefault(self.stocks.place(step), {})
            numbers[trace.trial.before.next] = stock.next_move
            change = renumbered(trace.trial, stock.next_move, numbers)
        self.stocks.leave(step, change)

    def _leave(self, step: ResolvedWorkingstep, meeting: TrialContacts) -> None:
        """Record the stock change and the trials of a path."""
        self.stocks.leave(step, meeting.change)
        trials = self._trace.trials
        if meeting.trial is not None and meeting.trial not in trials:
            trials = (*trials, meeting.trial)
        self._trace = replace(
            self._trace, change=meeting.change, trial=meeting.trial, trials=trials
        )

    def _leave_out(self, step: ResolvedWorkingstep) -> None:
        """Mark the features of a workingstep without a path, for the cuts that follow."""
        without = {int(feature): step.id for feature in step.features}
        self._left_out |= without
        self._trace = replace(self._trace, left_out=without)

    def _path(self, step: ResolvedWorkingstep) -> ToolPath:
        """Tool path of a workingstep as programmed."""
        require_ready(self.program, step, self._left_out)
        return self.path_of(self.program, step)

    def _other_path(self, step: ResolvedWorkingstep, setting: Setting) -> ToolPath:
        """Tool path of a workingstep in another number of passes; each is made once."""
        if setting.passes not in self._paths:
            other = with_depth(self.program, step, setting.depth)
            self._paths[setting.passes] = workingstep_path(*other)
        return self._paths[setting.passes]

    def _run(self, path: ToolPath, pace: SpeedRatios) -> ToolPathRun:
        """Run of a tool path by the axes; each feed is looked up once."""
        is_lathe = path.is_turning or self.machine.kind is MachineKind.LATHE
        kind = PostMachine.LATHE if is_lathe else PostMachine.MILL
        known: dict[Feed, ModalState] = {}
        # A geometry keeps its path, so that no other path has its id.
        shape = self._shapes.get(id(path)) or PathGeometry(path)
        self._shapes[id(path)] = shape

        def look_up(feed: Feed) -> ModalState:
            with self.program.using(feed.technology):
                return conditions(self.program, feed, path.tool_ref, kind)

        at_pace = paced(look_up, pace)

        def known_at_pace(feed: Feed) -> ModalState:
            if feed not in known:
                known[feed] = at_pace(feed)
            return known[feed]

        with self.program.using(path.operation_ref):
            return run_of(shape, known_at_pace, self.machine.spindle)

    def _see(
        self, step: ResolvedWorkingstep, path: ToolPath, cut: Cut, *, passes: int
    ) -> TriedPath:
        """Try a path in the current stock and record its contacts."""
        run = self._run(path, SpeedRatios(technology=step.technology_ref))
        meeting = met_by(self.program, step, run, self._found)
        met = meeting.met
        weighted, air, along, bent, slope = 0.0, 0.0, None, None, None
        if met is not None:
            depth = cut.programmed.depth
            along, slope = along_passes(run, met), down_ramps(cut, run, met, self.kienzle)
            bent = bending(cut, along.stations, self.kienzle)
            cut = self._engaged(step, cut, met, run, slope=slope, depth=depth)
            cut = with_hardest(cut, along, self.kienzle, depth=depth, bent=bent)
            section, ratio = greatest_section(cut, depth=depth)
            weighted = weighted_volume(met, self.kienzle.m_c)
            weighted /= section * ratio**-self.kienzle.m_c
            air = air_share(run, met, is_fed(run, step.technology_ref, cut))
            if isinstance(self._found, TurningStock) and isinstance(meeting.change, BarRadii):
                turned = turned_of(cut, met, run, self._found, meeting.change)
                cut = replace(cut, turned=turned)
        self._seen[passes] = seen = TriedPath(
            path=path,
            run=run,
            cut=cut,
            passes=passes,
            weighted=weighted,
            air=air,
            meeting=meeting,
            along=along,
            bent=bent,
            slope=slope,
        )
        self._leave(step, meeting)
        return seen

    def _see_other(
        self, step: ResolvedWorkingstep, estimate: Cut, setting: Setting, usual: TriedPath
    ) -> None:
        """Try a path in another number of passes; refuse it if it leaves other stock."""
        passes, depth = setting.passes, setting.depth
        nominal = replace(estimate.programmed, depth=depth, passes=passes)
        try:
            path = self._other_path(step, setting)
            cut = replace(estimate, programmed=nominal)
            seen = self._see(step, path, cut, passes=passes)
        except (SchemaError, PostError) as error:
            self._seen[passes] = usual
            self._refused[passes] = f"no tool path can be made: {error}"
            return
        left = difference_left(self._found, seen.meeting, usual.meeting)
        if left is not None and left.is_seen:
            self._refused[passes] = f"{left.words} would be left than as programmed"

    def _engaged(
        self,
        step: ResolvedWorkingstep,
        cut: Cut,
        met: PathContacts,
        run: ToolPathRun,
        *,
        slope: PlungeCuts | None,
        depth: float,
    ) -> Cut:
        """Add volume, diameter and ways down to the cut of a path."""
        cut = replace(cut, volume=met.volume, resolution=met.cell)
        if cut.kind.is_turned and not cut.is_air:
            first = next(iter(self._seen.values()), None)
            widest = self._widest(met, run) if first is None else first.cut.diameter
            cut = self._at_widest(step, cut, widest)
        way_in = way_in_of(cut, met, run, slope=slope, kienzle=self.kienzle, depth=depth)
        if way_in is not None:
            given = replace(cut.programmed, plunge_feed=plunge_feed_of(run, cut))
            cut = replace(cut, way_in=way_in, programmed=given)
        return replace(cut, plunge=plunge_of(cut, met, is_fed(run, step.technology_ref, cut)))

    def _widest(self, met: PathContacts, run: ToolPathRun) -> float:
        """Greatest diameter of the bar where it is cut, mm, whatever the number of passes."""
        stations, stock = met.stations, self._found
        if not isinstance(stock, TurningStock):
            return float(stations.diameter.max())
        z = run.segments.position(stations.segment, stations.station)[:, 2]
        cut = z[stations.section > 0.0]
        inside = (stock.z >= cut.min() - stock.cell) & (stock.z <= cut.max() + stock.cell)
        if not inside.any():
            return float(stations.diameter.max())
        return 2.0 * float(stock.outer[inside].max())

    def _at_widest(self, step: ResolvedWorkingstep, cut: Cut, diameter: float) -> Cut:
        """Refer speeds and loads of a turning cut to its greatest diameter."""
        found = programmed(self.program, step.technology_ref)
        speed = found.spindle_speed(diameter)
        feed = found.feed_per_tooth(speed, cut.tool.teeth)
        given = replace(cut.programmed, speed=speed, feed=feed)
        return replace(cut, diameter=diameter, programmed=given)

    def _timed(self, step: ResolvedWorkingstep, seen: TriedPath, setting: Setting) -> Cut:
        """Cut of a path at the feed and speed of a setting, with its time."""
        given, plunge = seen.cut.programmed, setting.plunge_feed
        feed, speed = setting.feed / given.feed, setting.speed / given.speed
        if feed == speed == 1.0 and plunge == given.plunge_feed:
            plunge = None
        if (feed, speed, plunge) not in seen.times:
            per_turn = None if plunge is None else plunge * seen.cut.tool.teeth
            pace = SpeedRatios(
                technology=step.technology_ref, feed=feed, speed=speed, plunge=per_turn
            )
            seen.times[feed, speed, plunge] = self._run_through(step, seen, pace)
        return seen.times[feed, speed, plunge]

    def _run_through(
        self, step: ResolvedWorkingstep, seen: TriedPath, pace: SpeedRatios
    ) -> Cut:
        """Time the cut along its path with the motion of the axes."""
        cut, given = seen.cut, seen.cut.programmed
        run = seen.run
        if pace != SpeedRatios(technology=step.technology_ref):
            run = self._run(seen.path, pace)
        seconds = run.segments.length / run.segments.speed
        fed = float(seconds[is_fed(run, step.technology_ref, cut)].sum())
        motion = motion_of(run, self.control, self.limits)
        rest = max(0.0, motion.duration - fed)
        per_second = given.feed * pace.feed * cut.tool.teeth * given.speed * pace.speed
        length = fed * per_second
        known = not seen.meeting.why and length > 0.0
        if seen.along is not None and seen.bent is not None:
            ride = MachineRun(
                motion=motion,
                feed=per_second,
                spindle=given.speed * pace.speed,
            )
            along = seen.along.on(run, seen.run) if cut.kind.is_turned else seen.along
            # Only where another feed borders on a pass may a place be faster than its feed.
            is_mixed = cut.kind is CutKind.MILLING and bool(plunges(run).any())
            loads = with_reached if self.is_run or is_mixed else with_power
            cut = loads(cut, along, seen.bent, ride, exponent=self.kienzle.m_c)
            cut = thickened(cut) if is_mixed else cut
            cut = self._with_ways_reached(cut, seen, ride)
        return replace(
            cut,
            length=length / seen.passes,
            rest_time=rest / seen.passes,
            link_length=0.0,
            floor=None if cut.floor is None else replace(cut.floor, length=0.0),
            load_share=seen.weighted / length if known else 1.0,
            air_length=seen.air * length / seen.passes,
        )

    def _with_ways_reached(self, cut: Cut, seen: TriedPath, ride: MachineRun) -> Cut:
        """Add to the ways down of a mill the loads that the axes reach on them."""
        m_c, slope, met = self.kienzle.m_c, seen.slope, seen.meeting.met
        if cut.kind is not CutKind.MILLING or met is None:
            return cut
        if self.is_run:
            share = plunge_reached(cut, met, ride, exponent=m_c)
            cut = replace(cut, plunge_reached=share)
        ramp = None if cut.way_in is None else cut.way_in.ramp
        if slope is None or cut.way_in is None or ramp is None:
            return cut
        down = replace(ride, feed=float(ride.run.segments.speed[plunges(ride.run)][0]))
        ramp = thickened(with_reached(ramp, slope.met, slope.bent, down, exponent=m_c))
        return replace(cut, way_in=replace(cut.way_in, ramp=ramp))

    def _warning(self, step: ResolvedWorkingstep, text: str) -> Finding:
        return self.program.finding(Severity.WARNING, text, step.operation_ref)
