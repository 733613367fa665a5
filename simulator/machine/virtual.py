"""The virtual machine: acts in, episodes out. Its state lives here.

Rapid moves may begin while the spindle speeds up; a feed waits until it has its speed. A
stretch begins and ends at rest. Everything is decided by path and time alone: same program,
same machine, same run. Units mm, s, rev/s.

Findings on collisions with the stock.

Feeds per revolution, kept by a spindle that cannot always follow the radius.

A lathe locks such a feed to the encoder of its spindle: while the spindle ramps, the axes go
as fast as it really turns, and the chip stays as programmed. Units mm, s, rev/s.
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
    ProgramAct,
    SpindleReached,
    SpindleTo,
    Stop,
    ToolTo,
    Wait,
    WorkingstepTo,
)
from simulator.machine.cutting import CuttingEdge
from simulator.machine.samples import Episode, EpisodeCourse, EpisodeState, Execution
from simulator.machine.spindle_course import SpindleCourse, following, ramped, standing
from simulator.machine.tooth_loads import ToothOptions
from simulator.machine.travel import Zero, require_axes, require_travel
from simulator.machine.wear import Wear, wearing_along
from simulator.motion.segments import ControlModel, Floats, Motion, Segments, axis_limits
from simulator.physics.tool_life import LIFE_CRITERION
from simulator.removal.collision import Collision
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.stations import Stations, air
from simulator.spec import Machine, MachineKind, Taylor
from stepnc_model.errors import Finding, Severity
from stepnc_model.units import rpm_from_rev_s

MOST = 20
"""findings of one kind; the rest is counted"""

LEAST_VOLUME = 1e-3
"""mm³ by which a rapid may graze what is just cut: rounding of the map"""


class ContactRecorder(Protocol):
    """A stock that knows what met it."""

    collisions: list[Collision]
    """rapids through material"""
    holder_collisions: list[Collision]
    shank_collisions: list[Collision]


def contacts(stock: ContactRecorder) -> list[Finding]:
    """Findings for rapids through material, holders and shanks that met it."""
    met = [hit for hit in stock.collisions if hit.volume > LEAST_VOLUME]
    told = [
        (hit, f"a rapid cuts {hit.volume:.3g} mm³ of material, up to {_place(hit)}")
        for hit in met
    ]
    findings = _first(told, "rapids through material")
    told = [
        (hit, f"the holder is {hit.depth:.3g} mm deep in the material at {_place(hit)}")
        for hit in stock.holder_collisions
    ]
    findings += _first(told, "moves with the holder in the material")
    told = [
        (
            hit,
            f"{hit.depth:.3g} mm of material above the cutting edge meet the shank at "
            f"{_place(hit)}",
        )
        for hit in stock.shank_collisions
    ]
    return findings + _first(told, "moves with material at the shank")


def _place(hit: Collision) -> str:
    x, y, z = hit.position
    return f"({x:.2f}, {y:.2f}, {z:.2f}) mm"


def _first(told: list[tuple[Collision, str]], kind: str) -> list[Finding]:
    findings = [
        Finding(severity=Severity.WARNING, message=text, line=hit.block)
        for hit, text in told[:MOST]
    ]
    if len(told) > MOST:
        more = f"{len(told) - MOST} more {kind}"
        findings.append(Finding(severity=Severity.WARNING, message=more))
    return findings


AGREED = 1e-3
"""relative difference between the feed of a segment and what its mean spindle speed asks for"""

MOST_PLANS = 20
"""of one stretch; a tenth of them is usual"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PacedStretch:
    """A stretch as it is run."""

    segments: Segments
    """with the feeds at which they are planned"""
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
    """Motion and spindle that agree.

    The motion says when each radius is reached, hence how far the spindle has come; its mean
    speed in each segment says the feed, hence the motion. Each plan is closed form; they are
    repeated until feeds and spindle agree within ``AGREED``. What happens later changes nothing
    before it, so that the repetition ends as that of an integral equation does.

    Parameters
    ----------
    stretch : MoveStretch
    plan : callable
        Motion of segments, from rest to rest.
    spindle : SpindleCourse
        Until the stretch begins.
    begin : float, s
    acceleration : float, rev/s²
        Of the spindle; infinite: without delay.
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
    """The spindle, which follows the radius where it keeps a surface speed."""
    wanted = stretch.spindle_speed
    if np.isnan(wanted).all():
        return spindle
    return following(spindle, begin, begin + ends, wanted=wanted, acceleration=acceleration)


def _locked(stretch: MoveStretch, spindle: SpindleCourse, begin: float, ends: Floats) -> Floats:
    """(N,) mm/s that the spindle's mean speed in each segment asks for; NaN: not locked."""
    turned = np.diff(spindle.revolutions(begin + np.concatenate(([0.0], ends))))
    seconds = np.diff(ends, prepend=0.0)
    mean = np.divide(np.abs(turned), seconds, out=np.zeros(len(ends)), where=seconds > 0.0)
    return np.where(mean > 0.0, stretch.per_revolution * mean, np.nan)


Shape = Cutter | Insert


class StockMap(ContactRecorder, Protocol):
    """Map of the remaining stock."""

    def cut(self, segments: Segments, shape: Any, /, *, is_clockwise: bool) -> Stations:
        """Take away what the tool sweeps; what it met. A mill's map knows cutters only."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedTool:
    """A tool in the magazine."""

    number: int
    id: str
    shape: Shape | None
    """None: threads; what they take is not modelled"""
    edge: CuttingEdge
    flank_wear: float = 0.0
    """Flank wear, mm, when the program starts"""
    taylor: Taylor | None = None
    """how fast it wears; None: it stays as it is"""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSetup:
    """Machine as prepared for a program: tools, stock, zero."""

    machine: Machine
    control: ControlModel
    tools: Mapping[int, LoadedTool] | None = None
    """by number; None: no tool is known, and nothing is cut"""
    stock: Callable[[str], StockMap | None] = lambda _: None
    """what is clamped when a workingstep begins; None: nothing is known of it"""
    teeth: ToothOptions | None = None
    """None: forces are means over a revolution"""
    zero: Zero | None = None
    """None: travel is not looked at"""


class VirtualMachine:
    """A machine that runs one program. Running state."""

    def __init__(self, setup: MachineSetup) -> None:
        self.setup = setup
        self.machine = setup.machine
        self.limits = axis_limits(setup.machine)
        self.now = 0.0
        self.position: Floats | None = None
        self.spindle = standing(0.0)
        self.state = EpisodeState(execution=Execution.ACTIVE, line=0)
        self.workingsteps: list[str] = []
        """ids in the order of their beginning; numbered from 1 in the episodes"""
        self.tool: LoadedTool | None = None
        self.findings: list[Finding] = []
        self._stock: StockMap | None = None
        self._stocks: list[StockMap] = []
        self._clamp("")
        self._has_fed = False
        """in this workingstep"""
        self._flank: dict[int, float] = {}
        """mm of flank wear by the tool's number"""
        self._said: set[str] = set()

    def run(self, steps: Iterable[ProgramAct]) -> Iterator[Episode]:
        """Episodes of a program, one after another without a gap.

        The machine stands where the first move begins, wherever that is. The last episode
        takes no time: the program has ended.

        Raises
        ------
        ProgramFault, UnknownTool, OutOfTravel
            What this machine cannot run, with the line.
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
                # The spindle stops after the path, as it starts before it.
                self._has_fed = False
                yield from self._wait(self.spindle.reached - self.now)

    def _clamp(self, workingstep: str) -> None:
        """The stock of a workingstep."""
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
            self._say(f"spindle {wanted:g} rpm exceeds {taken:g} rpm: {taken:g} rpm taken")
            speed = copysign(most, speed)
        acceleration = self.machine.spindle.acceleration
        self.spindle = ramped(self.spindle, self.now, speed, acceleration=acceleration)
        self.state = replace(self.state, spindle_programmed=speed)

    def _change(self, number: int) -> Iterator[Episode]:
        """Another tool, or none (T0); the one that is there takes no time."""
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
        begin = self.now
        run = paced(
            stretch,
            lambda segments: self.setup.control.plan(segments, self.limits),
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
        )
        self._has_fed = self._has_fed or not bool(segments.is_rapid.all())
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

    def _follow(self, stretch: MoveStretch, spindle: SpindleCourse) -> None:
        """The spindle as it goes on, and what it was told last."""
        self.spindle, told = spindle, stretch.spindle_speed
        if not np.isnan(told).all():
            last = float(told[~np.isnan(told)][-1])
            self.state = replace(self.state, spindle_programmed=last)

    def _cut(self, segments: Segments) -> Stations:
        first = int(segments.block[0])
        has_feed = not segments.is_rapid.all()
        if self.tool is None and self.setup.tools is not None and has_feed:
            self._say("a feed without a tool: nothing is cut", first)
        if self.tool is not None and self.tool.shape is None:
            text = f"{self.tool.id}: the force of a thread is not modelled, nothing is cut"
            self._say(text, first)
        if self._stock is None or self.tool is None or self.tool.shape is None:
            return air(np.arange(len(segments)), segments.length)
        if isinstance(self.tool.shape, Insert) and self.machine.kind is MachineKind.MILL:
            text = f"T{self.tool.number} {self.tool.id} turns, and the machine is a mill"
            raise ProgramFault(text, first)
        is_clockwise = self.state.spindle_programmed >= 0.0
        stations = self._stock.cut(segments, self.tool.shape, is_clockwise=is_clockwise)
        cuts = np.flatnonzero(stations.section > 0.0)
        if len(cuts) and self.spindle.target == 0.0:
            line = int(segments.block[stations.segment[cuts[0]]])
            self._say("cuts while the spindle stands: its force is not known", line)
        return stations

    def _wear(self, stretch: MoveStretch, segments: Segments, stations: Stations) -> Wear:
        """Wear of the edge that begins a stretch, and how fast it grows there."""
        if self.tool is None:
            return Wear()
        flank = self._flank.get(self.tool.number, self.tool.flank_wear)
        if self.tool.taylor is None:
            return Wear(flank=flank)
        wanted = stretch.spindle_speed
        speed = np.abs(np.where(np.isnan(wanted), self.spindle.target, wanted))
        return wearing_along(flank, self.tool.taylor, segments, stations, spindle_speed=speed)

    def _worn(self, course: EpisodeCourse) -> None:
        """Wear of the edge after a stretch."""
        if self.tool is None or not course.wear.grows:
            return
        flank = course.wear.after(course.cutting_seconds).flank
        self._flank[self.tool.number] = flank
        if flank > LIFE_CRITERION:
            text = f"T{self.tool.number} {self.tool.id} is worn beyond {LIFE_CRITERION:g} mm"
            self._say(text, int(course.segments.block[-1]))

    def _say(self, text: str, line: int = 0) -> None:
        """A warning, once."""
        if text not in self._said:
            self._said.add(text)
            finding = Finding(
                severity=Severity.WARNING, message=text, line=line or self.state.line
            )
            self.findings.append(finding)
