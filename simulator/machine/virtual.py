"""Virtual machine: takes actions of a program and produces episodes; holds mutable state.

Rapid moves may begin while the spindle speeds up; a feed move waits until it has its speed. A
stretch begins and ends at rest. The run depends only on path and time: the same program and
machine give the same run.

Feeds per revolution are kept even where the spindle cannot follow the radius fast enough: a
lathe synchronises the feed with the encoder of its spindle, so that while the spindle ramps the
axes follow its actual speed, and the chip stays as programmed.

Units mm, s, rev/s.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import copysign, inf
from typing import Any, Protocol

import numpy as np

from simulator.errors import ProgramFault, UnknownTool
from simulator.machine.acts import (
    CoolantTo,
    EndOfProgram,
    MoveStretch,
    PathControlTo,
    ProgramAct,
    SpindleReached,
    SpindleTo,
    Stop,
    ToolTo,
    Wait,
    WorkingstepTo,
)
from simulator.machine.contacts import ContactRecorder, contacts
from simulator.machine.cutting import STOPPED, CuttingEdge
from simulator.machine.deviation import (
    GivenDeviation,
    SeededDeviation,
    movement_factors,
    movement_kinds,
    movement_of,
)
from simulator.machine.samples import Episode, EpisodeCourse, EpisodeState, Execution
from simulator.machine.spindle_course import SpindleCourse, following, ramped, standing
from simulator.machine.tooth_loads import ToothOptions
from simulator.machine.travel import Zero, require_axes, require_travel
from simulator.machine.wear import Wear, wearing_along
from simulator.motion.linuxcnc_planner import LinuxCncPlanner
from simulator.motion.segments import ControlModel, Floats, Motion, Segments, axis_limits
from simulator.physics.tool_life import LIFE_CRITERION
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.stations import Stations, air
from simulator.spec import Machine, MachineKind, Taylor
from stepnc_model.errors import Finding, Severity
from stepnc_model.units import rpm_from_rev_s

AGREED = 1e-3
"""Tolerated relative difference between a segment's feed and that from the spindle speed."""

MOST_PLANS = 20
"""Largest number of plans for one stretch; a tenth is usual."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PacedStretch:
    """Stretch with the feeds, motion and spindle speed at which it runs."""

    segments: Segments
    """Segments with the feeds from which the motion was planned."""
    motion: Motion
    spindle: SpindleCourse


def paced(
    stretch: MoveStretch,
    plan: Callable[[Segments], Motion],
    spindle: SpindleCourse,
    *,
    begin: float,
    acceleration: float,
) -> PacedStretch:
    """Compute motion and spindle speed that agree with each other.

    The motion determines when each radius is reached, and so the spindle speed; the mean
    spindle speed in each segment determines the feed, and so the motion. Each plan has a closed
    form; plans are repeated until feeds and spindle agree within ``AGREED``. The iteration
    converges because later events do not affect earlier ones, as in a Volterra integral
    equation.

    Parameters
    ----------
    plan : callable
        Function that plans the motion of segments, from rest to rest.
    spindle : SpindleCourse
        Course until the stretch begins.
    begin : float, s
    acceleration : float, rev/s²
        Acceleration of the spindle; infinite for immediate changes.
    """
    segments, before = stretch.segments, spindle
    for _ in range(MOST_PLANS):
        motion = plan(segments)
        spindle = _followed(stretch, before, begin, motion.ends, acceleration=acceleration)
        speed = _locked(stretch, spindle, begin, motion.ends)
        is_own = np.isnan(speed)
        if is_own.all() or (np.abs(speed / segments.speed - 1.0)[~is_own] <= AGREED).all():
            break
        segments = replace(segments, speed=np.where(is_own, segments.speed, speed))
    return PacedStretch(segments=segments, motion=motion, spindle=spindle)


def _followed(
    stretch: MoveStretch,
    spindle: SpindleCourse,
    begin: float,
    ends: Floats,
    *,
    acceleration: float,
) -> SpindleCourse:
    """Spindle course that follows the radius where a constant surface speed is programmed."""
    wanted = stretch.spindle_speed
    if np.isnan(wanted).all():
        return spindle
    return following(spindle, begin, begin + ends, wanted=wanted, acceleration=acceleration)


def _locked(stretch: MoveStretch, spindle: SpindleCourse, begin: float, ends: Floats) -> Floats:
    """Feeds that match the spindle's mean speed by segment, (N,), mm/s; NaN: not locked."""
    turned = np.diff(spindle.revolutions(begin + np.concatenate(([0.0], ends))))
    seconds = np.diff(ends, prepend=0.0)
    mean = np.divide(np.abs(turned), seconds, out=np.zeros(len(ends)), where=seconds > 0.0)
    return np.where(mean > 0.0, stretch.per_revolution * mean, np.nan)


Shape = Cutter | Insert


class StockMap(ContactRecorder, Protocol):
    """Map of the remaining stock."""

    def cut(self, segments: Segments, shape: Any, /, *, is_clockwise: bool) -> Stations:
        """Remove the swept material; return the engagement. A mill's map takes cutters only."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedTool:
    """Tool in the magazine of the machine."""

    number: int
    id: str
    shape: Shape | None
    """Shape of the tool; None for threading tools, whose cut is not modelled."""
    edge: CuttingEdge
    flank_wear: float = 0.0
    """Flank wear when the program starts, mm."""
    taylor: Taylor | None = None
    """Taylor constants for the growth of wear; None: the wear stays constant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSetup:
    """Machine as prepared for a program: tools, stock and zero."""

    machine: Machine
    control: ControlModel
    tools: Mapping[int, LoadedTool] | None = None
    """Tools by number; None: no tools are known, and nothing is cut."""
    stock: Callable[[str], StockMap | None] = lambda _: None
    """Function from a workingstep to its clamped stock; None if the stock is unknown."""
    teeth: ToothOptions | None = None
    """Options for forces of single teeth; None for mean forces over a revolution."""
    zero: Zero | None = None
    """Position of the program zero; None: travel is not checked."""
    deviation: SeededDeviation | GivenDeviation | None = None
    """Random deviation of motor powers; None: powers are those of the model."""


class VirtualMachine:
    """Virtual machine that runs one program; a mutable object."""

    def __init__(self, setup: MachineSetup) -> None:
        self.setup = setup
        self.machine = setup.machine
        self.limits = axis_limits(setup.machine)
        self.control = setup.control
        self.now = 0.0
        self.position: Floats | None = None
        self.spindle = standing(0.0)
        self.state = EpisodeState(execution=Execution.ACTIVE, line=0)
        self.workingsteps: list[str] = []
        """Ids of workingsteps in the order in which they begin; episodes number them from 1."""
        self.tool: LoadedTool | None = None
        self.findings: list[Finding] = []
        self.reach: tuple[Floats, Floats] | None = None
        """Lowest and highest position of feed moves, (3,) each, mm; None before the first."""
        self._stock: StockMap | None = None
        self._stocks: list[StockMap] = []
        self._clamp("")
        self._has_fed = False
        """Whether a feed move has occurred in this workingstep."""
        self._flank: dict[int, float] = {}
        """Flank wear by tool number, mm."""
        self._movements = 0
        """Number of movements that have been drawn."""
        self._said: set[str] = set()

    @property
    def stocks(self) -> tuple[StockMap, ...]:
        """Stocks that were clamped, in order, as the program left them so far."""
        return tuple(self._stocks)

    def cut(self, stock: StockMap | None, segments: Segments) -> Stations:
        """Cut a stock with the loaded tool along segments; return what it meets."""
        if stock is None or self.tool is None or self.tool.shape is None:
            return air(np.arange(len(segments)), segments.length)
        is_clockwise = self.state.spindle_programmed >= 0.0
        return stock.cut(segments, self.tool.shape, is_clockwise=is_clockwise)

    def run(self, steps: Iterable[ProgramAct]) -> Iterator[Episode]:
        """Run a program and yield its episodes, one after another without gaps.

        The machine starts at the beginning of the first move, wherever that is. The last
        episode has no duration and marks the end of the program.

        Raises
        ------
        ProgramFault, UnknownTool, OutOfTravel
            If this machine cannot run the program; with the line.
        """
        waiting: list[ProgramAct] = []
        for step in steps:
            waiting.append(step)
            if self.position is None:
                if not isinstance(step.act, MoveStretch):
                    continue
                self.position = step.act.segments.start[0]
            for held in waiting:
                yield from self._act(held)
            waiting.clear()
        for held in waiting:
            yield from self._act(held)
        for stock in self._stocks:
            self.findings += contacts(stock)
        yield self._still(0.0, Execution.PROGRAM_COMPLETED)

    def _act(self, step: ProgramAct) -> Iterator[Episode]:
        self.state = replace(self.state, line=step.line)
        match step.act:
            case MoveStretch() as stretch:
                yield self._move(stretch)
            case PathControlTo(control=wanted):
                if isinstance(self.control, LinuxCncPlanner):
                    self.control = replace(self.control, mode=wanted)
            case SpindleTo(speed=speed):
                self._turn(speed)
            case SpindleReached():
                yield from self._wait(self.spindle.reached - self.now)
            case Wait(seconds=seconds):
                yield from self._wait(seconds)
            case ToolTo(number=number):
                yield from self._change(number)
            case CoolantTo(coolant=coolant):
                self.state = replace(self.state, coolant_on=bool(coolant.kinds))
            case WorkingstepTo(id=name):
                self.workingsteps.append(name)
                self.state = replace(self.state, workingstep=len(self.workingsteps))
                self._has_fed = False
                self._clamp(name)
            case Stop():
                left = max(self.spindle.reached - self.now, 0.0)
                yield self._still(left, Execution.PROGRAM_STOPPED)
            case EndOfProgram():
                self._turn(0.0)
                self.state = replace(self.state, coolant_on=False)
                # Stopping the spindle counts as time after the path, like its start before it.
                self._has_fed = False
                yield from self._wait(self.spindle.reached - self.now)

    def _clamp(self, workingstep: str) -> None:
        """Select the stock of a workingstep."""
        self._stock = self.setup.stock(workingstep)
        if self._stock is not None and all(self._stock is not known for known in self._stocks):
            self._stocks.append(self._stock)

    def _wait(self, seconds: float) -> Iterator[Episode]:
        if seconds > 0.0:
            yield self._still(seconds, Execution.WAIT)

    def _still(self, seconds: float, execution: Execution) -> Episode:
        begin, self.now = self.now, self.now + seconds
        return Episode(
            begin=begin,
            end=self.now,
            state=replace(self.state, execution=execution, is_way=not self._has_fed),
            spindle=self.spindle,
            position=np.zeros(3) if self.position is None else self.position,
        )

    def _turn(self, speed: float) -> None:
        most = self.machine.spindle.max_speed or inf
        if abs(speed) > most:
            wanted, taken = rpm_from_rev_s(abs(speed)), rpm_from_rev_s(most)
            self._say(f"spindle speed {wanted:g} rpm exceeds {taken:g} rpm: {taken:g} rpm used")
            speed = copysign(most, speed)
        acceleration = self.machine.spindle.acceleration
        self.spindle = ramped(self.spindle, self.now, speed, acceleration=acceleration)
        self.state = replace(self.state, spindle_programmed=speed)

    def _change(self, number: int) -> Iterator[Episode]:
        """Change the tool, or remove it (T0); takes no time if the tool is already loaded."""
        if number == self.state.tool:
            return
        tools = self.setup.tools
        if tools is not None and number not in {0, *tools}:
            known = ", ".join(f"T{each}" for each in sorted(tools))
            raise UnknownTool(number, known, self.state.line)
        yield from self._wait(self.spindle.reached - self.now)
        yield from self._wait(self.machine.tool_change)
        self.tool = None if tools is None else tools.get(number)
        self.state = replace(self.state, tool=number)

    def _move(self, stretch: MoveStretch) -> Episode:
        require_axes(self.machine, stretch.segments)
        if self.setup.zero is not None:
            require_travel(self.machine, stretch.segments, self.setup.zero)
        begin, control = self.now, self.control
        if isinstance(control, LinuxCncPlanner):
            control = replace(
                control,
                is_drained=stretch.is_drained,
                is_synchronised=not np.isnan(stretch.per_revolution).all(),
            )
        run = paced(
            stretch,
            lambda segments: control.plan(segments, self.limits),
            self.spindle,
            begin=begin,
            acceleration=self.machine.spindle.acceleration or inf,
        )
        self._follow(stretch, run.spindle)
        segments, motion = run.segments, run.motion
        self.now += motion.duration
        stations = self._cut(segments)
        course = EpisodeCourse(
            segments=segments,
            motion=motion,
            spindle_programmed=stretch.spindle_speed,
            stations=stations,
            edge=None if self.tool is None else self.tool.edge,
            wear=self._wear(stretch, segments, stations),
            teeth=self.setup.teeth,
            way=stretch.way,
            back=stretch.back,
            power_factor=self._drawn(segments),
        )
        self._feed_through(segments)
        self._worn(course)
        episode = Episode(
            begin=begin,
            end=self.now,
            state=self.state,
            spindle=self.spindle,
            position=segments.start[0],
            course=course,
        )
        self.position = segments.end[-1]
        return episode

    def _feed_through(self, segments: Segments) -> None:
        """Remember that feed moves have occurred, and where."""
        is_feed = ~segments.is_rapid
        if not is_feed.any():
            return
        self._has_fed = True
        ends = np.concatenate((segments.start[is_feed], segments.end[is_feed]))
        low, high = ends.min(axis=0), ends.max(axis=0)
        if self.reach is not None:
            low, high = np.minimum(low, self.reach[0]), np.maximum(high, self.reach[1])
        self.reach = low, high

    def _follow(self, stretch: MoveStretch, spindle: SpindleCourse) -> None:
        """Store the spindle's course and its last programmed speed."""
        self.spindle, told = spindle, stretch.spindle_speed
        if not np.isnan(told).all():
            last = float(told[~np.isnan(told)][-1])
            self.state = replace(self.state, spindle_programmed=last)

    def _cut(self, segments: Segments) -> Stations:
        first = int(segments.block[0])
        has_feed = not segments.is_rapid.all()
        if self.tool is None and self.setup.tools is not None and has_feed:
            self._say("feed move without a tool: no material is removed", first)
        if self.tool is not None and self.tool.shape is None:
            text = f"{self.tool.id}: threading is not modelled: no material is removed"
            self._say(text, first)
        if self._stock is None or self.tool is None or self.tool.shape is None:
            return air(np.arange(len(segments)), segments.length)
        if isinstance(self.tool.shape, Insert) and self.machine.kind is MachineKind.MILL:
            text = (
                f"T{self.tool.number} {self.tool.id} is a turning tool, "
                "but the machine is a mill"
            )
            raise ProgramFault(text, first)
        stations = self.cut(self._stock, segments)
        cuts = np.flatnonzero(stations.section > 0.0)
        if len(cuts) and self.spindle.target == 0.0:
            line = int(segments.block[stations.segment[cuts[0]]])
            self._say(STOPPED, line)
        return stations

    def _drawn(self, segments: Segments) -> Floats | None:
        """Factors on the motor powers of the segments of a stretch, (N,)."""
        if self.setup.deviation is None:
            return None
        movement = movement_of(segments)
        factors = movement_factors(
            self.setup.deviation, movement_kinds(segments), first=self._movements
        )
        self._movements += len(factors)
        return factors[movement]

    def _wear(self, stretch: MoveStretch, segments: Segments, stations: Stations) -> Wear:
        """Wear of the edge at the beginning of a stretch, with its rate there."""
        if self.tool is None:
            return Wear()
        flank = self._flank.get(self.tool.number, self.tool.flank_wear)
        if self.tool.taylor is None:
            return Wear(flank=flank)
        wanted = stretch.spindle_speed
        speed = np.abs(np.where(np.isnan(wanted), self.spindle.target, wanted))
        return wearing_along(flank, self.tool.taylor, segments, stations, spindle_speed=speed)

    def _worn(self, course: EpisodeCourse) -> None:
        """Store the wear of the edge after a stretch."""
        if self.tool is None or not course.wear.grows:
            return
        flank = course.wear.after(course.cutting_seconds).flank
        self._flank[self.tool.number] = flank
        if flank > LIFE_CRITERION:
            text = (
                f"T{self.tool.number} {self.tool.id}: flank wear exceeds {LIFE_CRITERION:g} mm"
            )
            self._say(text, int(course.segments.block[-1]))

    def _say(self, text: str, line: int = 0) -> None:
        """Record a warning, unless it has been recorded before."""
        if text not in self._said:
            self._said.add(text)
            finding = Finding(
                severity=Severity.WARNING, message=text, line=line or self.state.line
            )
            self.findings.append(finding)
