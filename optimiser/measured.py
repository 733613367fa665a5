"""Cuts as the real tool path makes them, in the stock that is left, timed by the machine.

Each workingstep's path cuts the stock of its setup, which goes on to the next workingstep. From
what the tool meets come the hardest places, for the limits, and the mean load, for the energy;
from the motion of the axes comes the time. What lasts as long as the feed says counts as
length, in mm at the programmed feed, with ratios of it and a spindle that follows the radius.
The rest counts as time: ramps, rapids, moves with a feed of their own, waits.
"""

from copy import deepcopy
from dataclasses import dataclass, replace
from math import sqrt

from optimiser.cut import Cut, CutKind
from optimiser.estimated import estimated_cut
from optimiser.hardest import Met, greatest_section, lengths, weighted_volume, with_hardest
from optimiser.other_depth import with_depth
from optimiser.problem import Setting
from optimiser.shape import shape_of
from simulator.errors import SimulationError
from simulator.motion.tool_path import (
    Pace,
    Run,
    duration,
    follows,
    paced,
    run_of,
    usual_motion,
)
from simulator.removal.cutter import Insert
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.zmap import MOST_CELLS
from simulator.spec import Kienzle, Machine, MachineKind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.setup import Setup
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, PostError, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import Machine as PostMachine
from stepnc_model.post.conditions import Conditions, conditions
from stepnc_model.program import Program, Workingstep
from stepnc_model.technology import programmed
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.generate import require_ready, workingstep_path
from stepnc_model.toolpath.job import Stock, stock_of
from stepnc_model.toolpath.path import Feed, ToolPath

USUAL_CELLS = 200_000
"""of a map: fewer than the virtual machine's, for most sections do not come from it"""

CELLS_PER_TOOL = 16.0
"""least number of cells over the diameter of the smallest tool"""

StockMap = MillingStock | TurningStock

Clamped = tuple[Ref[Setup] | None, bool]
"""a setup, and whether the workpiece turns"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seen:
    """A path that was tried, and what it met."""

    path: ToolPath
    depth: float
    """mm, of each pass as the path makes them"""
    passes: int
    met: Met | None
    why: str
    """why nothing is known of what it meets"""
    stock: StockMap | None
    """afterwards"""


class MeasuredCuts:
    """A source of cuts along real paths. Running state: what is left of each stock.

    The stock goes on to the next workingstep as the path that was asked for last leaves it.
    """

    def __init__(self, program: Program, machine: Machine, kienzle: Kienzle) -> None:
        self.program = program
        self.machine = machine
        self.kienzle = kienzle
        self.control, self.limits = usual_motion(machine)
        self.stocks: dict[Clamped, StockMap | None] = {}
        """as they are before the workingstep that was asked for last"""
        self._left_out: dict[int, str] = {}
        """workingstep without a path, by the instance number of its feature"""
        self._estimate: Cut | None = None
        self._seen: dict[int, _Seen] = {}
        """paths of the workingstep, by the number of passes"""
        self._last: tuple[Clamped, StockMap | None] | None = None
        """the stock that goes on"""

    def cut(self, step: Workingstep) -> tuple[Cut, list[Finding]]:
        """The cut of a workingstep as programmed, and what was assumed.

        Where no path can be made, or what it meets is not known, the estimate from the feature
        takes its place, and a finding says so.

        Raises
        ------
        SchemaError
            When the workingstep lacks what a cut needs.
        """
        self._go_on()
        cut, findings = estimated_cut(self.program, step)
        self._estimate = cut
        try:
            seen = self._see(step, cut, passes=cut.programmed.passes)
        except (SchemaError, PostError) as error:
            self._leave(step)
            text = f"no tool path: length, time and engagement are estimated ({error})"
            return cut, [*findings, self._warning(step, text)]
        findings += [each for each in seen.path.findings if each.severity is not Severity.NOTE]
        if seen.met is None:
            text = f"the engagement is estimated from the feature: {seen.why}"
            findings.append(self._warning(step, text))
        return self._measured(step, cut, seen, feed=1.0, speed=1.0), findings

    def at(self, step: Workingstep, cut: Cut, setting: Setting) -> Cut:
        """The same cut as the path of another setting makes it.

        Where a path in other passes cannot be made, all passes are taken to be alike.
        """
        given, estimate = cut.programmed, self._estimate
        if not self._seen or estimate is None:
            return cut
        if setting.passes not in self._seen:
            try:
                self._see(step, estimate, passes=setting.passes, depth=setting.depth)
            except (SchemaError, PostError):
                self._seen[setting.passes] = self._seen[given.passes]
        seen = self._seen[setting.passes]
        self._last = self._clamped(step), seen.stock
        feed, speed = setting.feed / given.feed, setting.speed / given.speed
        return self._measured(step, estimate, seen, feed=feed, speed=speed)

    def leave_out(self, step: Workingstep) -> None:
        """Cut the stock as a workingstep does that is not advised but is run."""
        self._go_on()
        try:
            path = self._path(step)
            run = self._run(path, Pace(technology=step.technology_ref))
        except (SchemaError, PostError):
            self._leave(step)
            return
        stock = self._stock(step)
        self._removed(step, run, stock)
        self._last = self._clamped(step), stock

    def _go_on(self) -> None:
        """The next workingstep finds what the last one left."""
        if self._last is not None:
            clamped, stock = self._last
            self.stocks[clamped] = stock
        self._last, self._estimate = None, None
        self._seen = {}

    def _leave(self, step: Workingstep) -> None:
        """Without its path, what comes after it on its features would meet too much."""
        self._left_out |= {int(feature): step.id for feature in step.features}

    def _path(self, step: Workingstep) -> ToolPath:
        """Path of a workingstep as programmed."""
        require_ready(self.program, step, self._left_out)
        return workingstep_path(self.program, step)

    def _see(
        self, step: Workingstep, cut: Cut, *, passes: int, depth: float | None = None
    ) -> _Seen:
        """Try a path, as programmed unless a depth of its passes is given."""
        if depth is None:
            path = self._path(step)
        else:
            path = workingstep_path(*with_depth(self.program, step, depth))
        depth = depth or cut.programmed.depth
        if cut.kind is CutKind.MILLING and cut.is_depth_free:
            # Levels are equal, however deep they were asked to be.
            depth = cut.total_depth / passes
        run = self._run(path, Pace(technology=step.technology_ref))
        stock = deepcopy(self._stock(step))
        met, why = self._removed(step, run, stock)
        seen = _Seen(path=path, depth=depth, passes=passes, met=met, why=why, stock=stock)
        self._seen[passes] = seen
        self._last = self._clamped(step), stock
        return seen

    def _measured(
        self, step: Workingstep, cut: Cut, seen: _Seen, *, feed: float, speed: float
    ) -> Cut:
        """A cut along a path that was tried, so much faster than programmed."""
        met = seen.met
        if met is not None:
            cut = self._engaged(step, cut, met, depth=seen.depth)
        run = self._run(seen.path, Pace(technology=step.technology_ref, feed=feed, speed=speed))
        pace = cut.programmed.feed * feed * cut.tool.teeth * cut.programmed.speed * speed
        cut = self._timed(step, cut, run, pace=pace, passes=seen.passes)
        if met is None:
            return cut
        return self._loaded(step, cut, run, seen=seen, pace=pace)

    def _run(self, path: ToolPath, pace: Pace) -> Run:
        """What the axes run; feeds are looked up once a path."""
        is_lathe = path.is_turning or self.machine.kind is MachineKind.LATHE
        kind = PostMachine.LATHE if is_lathe else PostMachine.MILL
        known: dict[Feed, Conditions] = {}

        def look_up(feed: Feed) -> Conditions:
            if feed not in known:
                with self.program.using(feed.technology):
                    known[feed] = conditions(self.program, feed, path.tool_ref, kind)
            return known[feed]

        with self.program.using(path.operation_ref):
            return run_of(path, paced(look_up, pace), self.machine.spindle)

    def _clamped(self, step: Workingstep) -> Clamped:
        """Where a workingstep finds its stock."""
        is_lathe = self.machine.kind is MachineKind.LATHE
        is_turning = isinstance(step.operation, TurningMachiningOperation)
        return step.setup, is_turning or is_lathe

    def _stock(self, step: Workingstep) -> StockMap | None:
        """What is left of its stock; None where it is not known."""
        clamped = self._clamped(step)
        if clamped not in self.stocks:
            self.stocks[clamped] = self._raw(step, is_turning=clamped[1])
        return self.stocks[clamped]

    def _raw(self, step: Workingstep, *, is_turning: bool) -> StockMap | None:
        try:
            raw = stock_of(self.program, step.setup)
            if raw is None:
                return None
            return TurningStock(raw) if is_turning else MillingStock(raw, cell=self._cell(raw))
        except (SchemaError, ValueError):
            return None

    def _removed(
        self, step: Workingstep, run: Run, stock: StockMap | None
    ) -> tuple[Met | None, str]:
        """What the tool meets; else why that is not known."""
        if stock is None:
            return None, "no stock is known"
        try:
            shape = shape_of(self.program, step.tool_ref)
            if shape is None:
                return None, "threads are not cut from the stock"
            if isinstance(stock, TurningStock):
                stations, cell = stock.cut(run.segments, shape), stock.cell
            elif isinstance(shape, Insert):
                return None, "an insert does not mill"
            else:
                stations = stock.cut(run.segments, shape, is_clockwise=run.is_clockwise)
                cell = stock.map.cell
        except (SimulationError, SchemaError, ValueError) as error:
            return None, str(error)
        return Met(stations=stations, length=lengths(stations), cell=cell), ""

    def _cell(self, raw: Stock) -> float:
        """Cell of a map that tells engagements, mm."""
        tools = {step.tool_ref for step in self.program.workingsteps}
        smallest = min(self._diameters(tools), default=raw.high[0] - raw.low[0])
        area = (raw.high[0] - raw.low[0]) * (raw.high[1] - raw.low[1])
        wanted = min(sqrt(area / USUAL_CELLS), smallest / CELLS_PER_TOOL)
        return max(wanted, sqrt(area / MOST_CELLS))

    def _diameters(self, tools: set[Ref[Entity]]) -> list[float]:
        """Of the tools that rotate and can be used."""
        found = []
        for tool in tools:
            try:
                found.append(tool_of(self.program, tool).diameter)
            except SchemaError:
                continue
        return [diameter for diameter in found if diameter > 0.0]

    def _engaged(self, step: Workingstep, cut: Cut, met: Met, *, depth: float) -> Cut:
        """The cut as it was met; turning is told where the workpiece is widest."""
        cut = replace(cut, volume=met.volume)
        if cut.kind in {CutKind.TURNING, CutKind.GROOVING} and not cut.is_air:
            cut = self._at_widest(step, cut, float(met.stations.diameter.max()))
        return with_hardest(cut, met, self.kienzle, depth=depth)

    def _at_widest(self, step: Workingstep, cut: Cut, diameter: float) -> Cut:
        """Speeds and loads of turning are those at its greatest diameter: nothing is harder."""
        found = programmed(self.program, step.technology_ref)
        speed = found.spindle_speed(diameter)
        feed = found.feed_per_tooth(speed, cut.tool.teeth)
        given = replace(cut.programmed, speed=speed, feed=feed)
        return replace(cut, diameter=diameter, programmed=given)

    def _timed(self, step: Workingstep, cut: Cut, run: Run, *, pace: float, passes: int) -> Cut:
        """The cut with its length and the rest of its time; pace is the feed in mm/s."""
        segments, is_bound = run.segments, follows(run, step.technology_ref)
        fed = float((segments.length[is_bound] / segments.speed[is_bound]).sum())
        rest = max(0.0, duration(run, self.control, self.limits) - fed)
        return replace(
            cut,
            length=pace * fed / passes,
            rest_time=rest / passes,
            link_length=0.0,
            floor=None if cut.floor is None else replace(cut.floor, length=0.0),
        )

    def _loaded(
        self, step: Workingstep, cut: Cut, run: Run, *, seen: _Seen, pace: float
    ) -> Cut:
        """The cut with its mean load, and how much of its length goes through air."""
        met = seen.met
        if met is None or cut.length <= 0.0:
            return cut
        row = met.stations.segment
        seconds = met.length / run.segments.speed[row]
        is_air = met.stations.kind == StationKind.AIR
        is_air &= follows(run, step.technology_ref)[row]
        section, ratio = greatest_section(cut, depth=seen.depth)
        hardest = section * ratio**-self.kienzle.m_c * cut.length * seen.passes
        return replace(
            cut,
            load_share=weighted_volume(met, self.kienzle.m_c) / hardest,
            air_length=pace * float(seconds[is_air].sum()) / seen.passes,
        )

    def _warning(self, step: Workingstep, text: str) -> Finding:
        return self.program.finding(Severity.WARNING, text, step.operation_ref)
