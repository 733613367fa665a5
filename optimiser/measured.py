"""Cuts as the real tool path makes them, in the stock that is left, timed by the machine.

Each workingstep's path cuts the stock of its setup, which goes on to the next workingstep. From
what the tool meets come the hardest places, for the limits, and the mean load, for the energy;
from the motion of the axes comes the time. What lasts as long as the feed says counts as
length, in mm at the programmed feed, with ratios of it and a spindle that follows the radius.
The rest counts as time: ramps, rapids, moves with a feed of their own, waits.
"""

from dataclasses import replace
from math import sqrt
from typing import Any

from optimiser.cut import Cut, CutKind
from optimiser.estimated import estimated_cut
from optimiser.hardest import Met, greatest_section, lengths, weighted_volume, with_hardest
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


class MeasuredCuts:
    """A source of cuts along real paths. Running state: what is left of each stock."""

    def __init__(self, program: Program, machine: Machine, kienzle: Kienzle) -> None:
        self.program = program
        self.machine = machine
        self.kienzle = kienzle
        self.control, self.limits = usual_motion(machine)
        self.stocks: dict[tuple[Ref[Setup] | None, bool], StockMap | None] = {}
        """by setup, and whether it turns"""
        self._left_out: dict[int, str] = {}
        """workingstep without a path, by the instance number of its feature"""
        self._paths: dict[tuple[int, float], ToolPath] = {}
        """by workingstep and depth of a pass"""

    def cut(self, step: Workingstep) -> tuple[Cut, list[Finding]]:
        """The cut of a workingstep as programmed, and what was assumed.

        Where no path can be made, or what it meets is not known, the estimate from the feature
        takes its place, and a finding says so.

        Raises
        ------
        SchemaError
            When the workingstep lacks what a cut needs.
        """
        cut, findings = estimated_cut(self.program, step)
        try:
            path, run = self._started(step)
        except (SchemaError, PostError) as error:
            self._leave(step)
            text = f"no tool path: length, time and engagement are estimated ({error})"
            return cut, [*findings, self._warning(step, text)]
        self._paths[int(step.ref), cut.programmed.depth] = path
        findings += [each for each in path.findings if each.severity is not Severity.NOTE]
        met, why = self._removed(step, run)
        if met is None:
            text = f"the engagement is estimated from the feature: {why}"
            findings.append(self._warning(step, text))
        else:
            cut = self._engaged(step, cut, met)
        cut = self._timed(step, cut, run, cut.programmed, passes=cut.programmed.passes)
        return cut if met is None else self._loaded(step, cut, run, met), findings

    def at(self, step: Workingstep, cut: Cut, setting: Setting) -> Cut:
        """The same cut with length and time as they are at another setting.

        Milling gets the path of the other depth; where the file gives the path, and in turning,
        passes are taken to be alike.
        """
        given = cut.programmed
        path = self._paths.get((int(step.ref), given.depth))
        if path is None:
            return cut
        passes = given.passes
        if setting.passes != given.passes and (deeper := self._deeper(step, setting.depth)):
            path, passes = deeper, setting.passes
        pace = Pace(
            technology=step.technology_ref,
            feed=setting.feed / given.feed,
            speed=setting.speed / given.speed,
        )
        return self._timed(step, cut, self._run(path, pace), setting, passes=passes)

    def leave_out(self, step: Workingstep) -> None:
        """Cut the stock as a workingstep does that is not advised but is run."""
        try:
            _, run = self._started(step)
        except (SchemaError, PostError):
            self._leave(step)
            return
        self._removed(step, run)

    def _started(self, step: Workingstep) -> tuple[ToolPath, Run]:
        """Path of a workingstep as programmed."""
        require_ready(self.program, step, self._left_out)
        path = workingstep_path(self.program, step)
        return path, self._run(path, Pace(technology=step.technology_ref))

    def _leave(self, step: Workingstep) -> None:
        """Without its path, what comes after it on its features would meet too much."""
        self._left_out |= {int(feature): step.id for feature in step.features}

    def _deeper(self, step: Workingstep, depth: float) -> ToolPath | None:
        """Path of a milling operation in passes of another depth, or None."""
        operation: Any = step.operation
        if operation.its_toolpath or not hasattr(operation, "axial_cutting_depth"):
            return None
        key = int(step.ref), depth
        if key not in self._paths:
            other = replace(operation, axial_cutting_depth=depth)
            try:
                path = workingstep_path(self.program, replace(step, operation=other))
            except SchemaError:
                return None
            self._paths[key] = path
        return self._paths[key]

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

    def _removed(self, step: Workingstep, run: Run) -> tuple[Met | None, str]:
        """What the tool meets; else why that is not known."""
        try:
            shape = shape_of(self.program, step.tool_ref)
            if shape is None:
                return None, "threads are not cut from the stock"
            is_turning = isinstance(shape, Insert) or self.machine.kind is MachineKind.LATHE
            stock = self._stock(step.setup, is_turning=is_turning)
            if stock is None:
                return None, "the file gives no stock"
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

    def _stock(self, setup: Ref[Setup] | None, *, is_turning: bool) -> StockMap | None:
        """What is left of the stock of a setup."""
        key = setup, is_turning
        if key not in self.stocks:
            raw = stock_of(self.program, setup)
            if raw is None:
                self.stocks[key] = None
            elif is_turning:
                self.stocks[key] = TurningStock(raw)
            else:
                self.stocks[key] = MillingStock(raw, cell=self._cell(raw))
        return self.stocks[key]

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

    def _engaged(self, step: Workingstep, cut: Cut, met: Met) -> Cut:
        """The cut as it was met; turning is told where the workpiece is widest."""
        cut = replace(cut, volume=met.volume)
        if cut.kind in {CutKind.TURNING, CutKind.GROOVING} and not cut.is_air:
            cut = self._at_widest(step, cut, float(met.stations.diameter.max()))
        return with_hardest(cut, met, self.kienzle)

    def _at_widest(self, step: Workingstep, cut: Cut, diameter: float) -> Cut:
        """Speeds and loads of turning are those at its greatest diameter: nothing is harder."""
        found = programmed(self.program, step.technology_ref)
        speed = found.spindle_speed(diameter)
        feed = found.feed_per_tooth(speed, cut.tool.teeth)
        given = replace(cut.programmed, speed=speed, feed=feed)
        return replace(cut, diameter=diameter, programmed=given)

    def _timed(
        self, step: Workingstep, cut: Cut, run: Run, setting: Setting, *, passes: int
    ) -> Cut:
        """The cut with its length and the rest of its time, of a path with so many passes."""
        segments, is_bound = run.segments, follows(run, step.technology_ref)
        feed = setting.feed * cut.tool.teeth * setting.speed
        fed = float((segments.length[is_bound] / segments.speed[is_bound]).sum())
        rest = max(0.0, duration(run, self.control, self.limits) - fed)
        floor = None if cut.floor is None else replace(cut.floor, length=0.0)
        return replace(
            cut,
            length=feed * fed / passes,
            rest_time=rest / passes,
            link_length=0.0,
            floor=floor,
        )

    def _loaded(self, step: Workingstep, cut: Cut, run: Run, met: Met) -> Cut:
        """The cut with its mean load, and how much of its length goes through air."""
        given = cut.programmed
        feed = given.feed * cut.tool.teeth * given.speed
        seconds = met.length / run.segments.speed[met.stations.segment]
        is_air = met.stations.kind == StationKind.AIR
        is_air &= follows(run, step.technology_ref)[met.stations.segment]
        share = 0.0
        if cut.length > 0.0:
            section, ratio = greatest_section(cut)
            hardest = section * ratio**-self.kienzle.m_c * cut.length * given.passes
            share = weighted_volume(met, self.kienzle.m_c) / hardest
        return replace(
            cut,
            load_share=share,
            air_length=feed * float(seconds[is_air].sum()) / given.passes,
        )

    def _warning(self, step: Workingstep, text: str) -> Finding:
        return self.program.finding(Severity.WARNING, text, step.operation_ref)
