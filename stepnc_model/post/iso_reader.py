"""Reader of G-code: a modal machine for all ISO 6983 dialects that yields neutral blocks.

The reader is strict: unknown or unused codes and words are errors, and so are arcs whose radii
differ. A dialect derives from :class:`IsoReader` and overrides what differs. Coordinates are
absolute and metric; arc centres are relative to the start.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    DrillingCycle,
    Linear,
    MachineType,
    OptionalStopBlock,
    Pause,
    ProgramEnd,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
    expanded,
)
from stepnc_model.post.grid import FULL, turn_between
from stepnc_model.post.words import (
    MOTIONS,
    SENSES,
    TAPS,
    GCode,
    GCodeAction,
    LineWords,
    pairs,
    whole,
)
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import rev_s_from_rpm, speed_from_m_min, speed_from_mm_min

ROUND = 0.01
"""Greatest difference of the radii to both ends of an arc, mm (MD21000 of the 840D)."""

PECK_CLEARANCE = 0.254
"""Height above the last depth after a retract, mm: fixed in LinuxCNC, a parameter elsewhere."""

COMMENT = re.compile(r"\(([^()]*)\)")


class IsoReader(ABC):
    """Reader of one G-code program; tracks the modal state and the position of the tool."""

    codes: Mapping[MachineType, Mapping[str, GCode]] = {}
    coolants: Mapping[str, frozenset[CoolantKind]] = {
        "M7": frozenset({CoolantKind.MIST}),
        "M8": frozenset({CoolantKind.FLOOD}),
    }
    coolant_ends: frozenset[str] = frozenset({"M9"})
    quiet: ClassVar[frozenset[str]] = frozenset()
    """M words that the reader accepts and ignores."""
    head: ClassVar[re.Pattern[str]] = re.compile("%")
    """Pattern of lines without NC words, such as the percent sign."""

    path_letters: ClassVar[str] = ""
    """Letters of the words that belong to a path mode."""

    def __init__(self, machine: MachineType) -> None:
        self.machine = machine
        self.at: Point = (0.0, 0.0, 0.0)
        self.plane = ArcPlane.XY if machine is MachineType.MILL else ArcPlane.ZX
        self.mode = RateMode.PER_MINUTE
        self.motion: GCode | None = None
        self.limit: float | None = None
        self.is_surface_speed = False
        self.speed: float | None = None
        self.sense: SpindleDirection | None = None
        self.is_diameter = machine is MachineType.LATHE
        self.returns_to_start = True
        self.feed: float | None = None
        self._tool: int | None = None
        self._coolant: frozenset[CoolantKind] = frozenset()
        self._cycle: DrillingCycle | None = None

    def blocks(self, lines: Iterable[str]) -> Iterator[Block]:
        """Read the program as neutral blocks.

        Raises
        ------
        PostError
            With the line number and the problem.
        """
        for number, line in enumerate(lines, 1):
            try:
                yield from self.line(line.rstrip("\r\n"))
            except PostError as error:
                raise PostError(str(error), line=number) from None

    # Methods that dialects override.

    def line(self, line: str) -> Iterator[Block]:
        """Blocks of one line: its comments, then its words."""
        for found in COMMENT.finditer(line):
            yield self.comment(found[1])
        text = COMMENT.sub(" ", line).strip()
        if text and not self.head.fullmatch(text):
            yield from self.block(LineWords(pairs(text)))

    def comment(self, text: str) -> Block:
        """Comment block from the text of a comment."""
        return Comment(text=text)

    def seconds(self, words: LineWords) -> float:
        """Dwell time of a G4 block, s."""
        return words.need("P", "G4")

    @abstractmethod
    def lead(self, end: Point, words: LineWords) -> float:
        """Lead of a thread along the axis that moves most, mm."""

    @abstractmethod
    def tap(self, words: LineWords, act: GCode) -> Iterator[Block]:
        """Neutral blocks of a rigid tap."""

    def surface_limit(self, words: LineWords) -> float | None:
        """Greatest spindle speed at constant surface speed, rev/s."""
        return self.limit

    def tool(self, words: LineWords) -> Iterator[Block]:
        """Tool change: T selects the tool, M6 changes it."""
        number = words.take("T")
        if number is not None:
            self._tool = whole(number, "T")
        if "M6" in words.functions:
            words.functions.remove("M6")
            if self._tool is None:
                raise PostError("M6 without a tool number: T is missing")
            self.sense = None
            yield ToolChange(number=self._tool)

    def extra(self, words: LineWords) -> Iterator[Block]:
        """Further blocks that only some dialects have."""
        yield from ()

    # Methods that all dialects share.

    def block(self, words: LineWords) -> Iterator[Block]:
        """Blocks of the words of one line."""
        words.take("N")
        acts = [self._act(code) for code in words.codes]
        self.settle(acts, words)
        for letter in self.path_letters if GCodeAction.PATH_MODE in acts else "":
            words.take(letter)
        yield from self.tool(words)
        yield from self._spindle(words, changed=GCodeAction.SURFACE_SPEED in acts)
        yield from self._switches(words)
        yield from self.extra(words)
        if GCodeAction.DWELL in acts:
            yield Pause(seconds=self.seconds(words))
        yield from self._motion(acts, words)
        yield from self._stops(words)
        words.finish()
        if words.functions:
            raise PostError(f"word {words.functions[0]}: unknown M code")

    def rate(self) -> Rate:
        """Feed that is currently in force."""
        if not self.feed:
            raise PostError("a feed move without F")
        if self.mode is RateMode.PER_MINUTE:
            return Rate(value=speed_from_mm_min(self.feed))
        return Rate(value=self.feed, mode=RateMode.PER_REVOLUTION)

    def end(self, words: LineWords) -> Point:
        """End point of a move, given by its axis words."""
        x, y, z = self.at
        given = words.take("X")
        if given is not None:
            x = 0.5 * given if self.is_diameter else given
        if self.machine is MachineType.MILL:
            given = words.take("Y")
            y = y if given is None else given
        given = words.take("Z")
        return x, y, z if given is None else given

    def _act(self, code: str) -> GCode:
        act = self.codes[self.machine].get(code)
        if act is None:
            raise PostError(f"word {code}: unknown G code on this {self.machine}")
        return act

    def settle(self, acts: list[GCode], words: LineWords) -> None:
        """Update the modal state from the G codes of a line."""
        if any(sum(isinstance(act, kind) for act in acts) > 1 for kind in (ArcPlane, RateMode)):
            raise PostError("two G codes of one group in one block")
        for act in acts:
            if isinstance(act, ArcPlane):
                self.plane = act
            elif isinstance(act, RateMode) and act is not self.mode:
                self.mode, self.feed = act, None
            elif act in {GCodeAction.TO_RETRACT, GCodeAction.TO_START}:
                self.returns_to_start = act is GCodeAction.TO_START
            elif act is GCodeAction.SPEED_LIMIT:
                self.limit = rev_s_from_rpm(words.need("S", "G50"))
            elif act is GCodeAction.SURFACE_SPEED:
                self.is_surface_speed = True
                self.limit = self.surface_limit(words)
            elif act is GCodeAction.SPINDLE_SPEED:
                self.is_surface_speed = False
            elif act is GCodeAction.DIAMETER:
                self.machine, self.is_diameter = MachineType.LATHE, True
            elif act is GCodeAction.LENGTH:
                words.need("H", "G43")
        self.feed = words.take("F") if "F" in words else self.feed

    def _spindle(self, words: LineWords, *, changed: bool) -> Iterator[Block]:
        if sum(code == "M5" or code in SENSES for code in words.functions) > 1:
            raise PostError("two spindle commands in one block")
        speed = words.take("S")
        if speed is not None:
            self.speed, changed = speed, True
        for code, sense in SENSES.items():
            if code in words.functions:
                words.functions.remove(code)
                self.sense, changed = sense, True
        if "M5" in words.functions:
            words.functions.remove("M5")
            self.sense = None
            yield SpindleOff()
        turning = self.turning()
        if changed and turning is not None:
            yield turning

    def turning(self) -> SpindleOn | SurfaceSpeed | None:
        """State of the spindle, or None while it is stopped."""
        if self.sense is None:
            return None
        if self.speed is None:
            raise PostError("spindle on without a speed S")
        if self.is_surface_speed:
            speed = speed_from_m_min(self.speed)
            return SurfaceSpeed(speed=speed, limit=self.limit, sense=self.sense)
        return SpindleOn(speed=rev_s_from_rpm(self.speed), sense=self.sense)

    def _switches(self, words: LineWords) -> Iterator[Block]:
        """Coolant, spindle orientation, and M words without effect."""
        for code in list(words.functions):
            if code in self.coolant_ends:
                self._coolant = frozenset()
            elif code in self.coolants:
                self._coolant |= self.coolants[code]
            elif code == "M19":
                yield SpindleOrient()
            elif code not in self.quiet:
                continue
            words.functions.remove(code)
            if code in self.coolant_ends or code in self.coolants:
                yield Coolant(kinds=self._coolant)

    def _motion(self, acts: list[GCode], words: LineWords) -> Iterator[Block]:
        """Execute the motion of the block, or the modal motion if axes move."""
        named = [act for act in acts if act in MOTIONS]
        if len(named) > 1:
            raise PostError("two motions in one block")
        if GCodeAction.CANCEL in acts:
            self.motion, self._cycle = None, None
        if named:
            if not isinstance(named[0], CycleKind):
                self._cycle = None
            self.motion = named[0]
        elif not any(letter in words for letter in "XYZ"):
            return
        yield from self._moved(words)

    def _moved(self, words: LineWords) -> Iterator[Block]:
        motion = self.motion
        if motion is None:
            raise PostError("axes move, but no motion command (G0 to G3) is active")
        if isinstance(motion, CycleKind):
            yield from self._drilled(words, motion)
        elif motion in TAPS:
            self.motion = None
            yield from self.tap(words, motion)
        elif motion is GCodeAction.RAPID:
            yield self._rapid(words)
        elif motion is GCodeAction.THREAD:
            yield self._thread(words)
        elif motion is GCodeAction.LINEAR:
            self.at = self.end(words)
            yield Linear(end=self.at, rate=self.rate())
        else:
            yield self._arc(words, 1.0 if motion is GCodeAction.COUNTERCLOCKWISE else -1.0)

    def _rapid(self, words: LineWords) -> Block:
        is_retract = "X" not in words and "Y" not in words
        self.at = self.end(words)
        return Retract(z=self.at[2]) if is_retract else Rapid(end=self.at)

    def _thread(self, words: LineWords) -> Block:
        end = self.end(words)
        if end == self.at:
            raise PostError("a threading move has no length")
        lead = self.lead(end, words)
        if lead <= 0.0:
            raise PostError(f"a thread with a lead of {lead:g} mm: the lead must be positive")
        self.at = end
        return ThreadingMove(end=end, lead=lead)

    def turns(self, words: LineWords) -> int:
        """Number of full turns of an arc, besides the turn given by its end points."""
        given = words.take("P")
        return 0 if given is None else whole(given, "P") - 1

    def _arc(self, words: LineWords, sense: float) -> Block:
        start, end = self.at, self.end(words)
        first, second, _ = self.plane.axes
        centre = list(start)
        for axis in (first, second):
            centre[axis] += words.take("IJK"[axis]) or 0.0
        middle = (centre[0], centre[1], centre[2])
        turn = turn_between(start, end, middle, self.plane, sense=sense, slack=ROUND)
        turn += sense * self.turns(words) * FULL
        self.at = end
        return Circular(end=end, centre=middle, turn=turn, plane=self.plane, rate=self.rate())

    def _drilled(self, words: LineWords, kind: CycleKind) -> Iterator[Block]:
        """Read a canned cycle at its position, with modal values of the previous one."""
        x, y, bottom = self.end(words) if "Z" in words else (*self.end(words)[:2], None)
        last = self._cycle if self._cycle is not None and self._cycle.kind is kind else None
        retract, step, dwell = words.take("R"), words.take("Q"), self.cycle_dwell(words)
        if last is None and (bottom is None or retract is None):
            raise PostError("a drilling cycle without Z or R")
        if kind in {CycleKind.PECK, CycleKind.CHIP_BREAK} and not (step or last):
            raise PostError("a peck drilling cycle without Q")
        cycle = DrillingCycle(
            kind=kind,
            at=(x, y),
            retract_z=last.retract_z if last and retract is None else retract or 0.0,
            bottom_z=last.bottom_z if last and bottom is None else bottom or 0.0,
            rate=self.rate(),
            step_depth=last.step_depth if last and step is None else step or 0.0,
            retract_distance=PECK_CLEARANCE,
            dwell=last.dwell if last and dwell is None else dwell or 0.0,
        )
        yield from self.drilled(cycle)

    def drilled(self, cycle: DrillingCycle) -> Iterator[Block]:
        """Move to a cycle, execute it, and retract."""
        start_z = self.at[2]
        x, y = cycle.at
        if self.plane is not ArcPlane.XY:
            raise PostError(f"a drilling cycle in the plane {self.plane}: only XY is supported")
        if cycle.bottom_z >= cycle.retract_z:
            raise PostError("the bottom of a drilling cycle must lie below its retract plane")
        if start_z < cycle.retract_z:
            yield Retract(z=cycle.retract_z)
        yield Rapid(end=(x, y, max(start_z, cycle.retract_z)))
        yield Rapid(end=(x, y, cycle.retract_z))
        self._cycle = expanded(cycle, self.turning())
        yield self._cycle
        back = max(start_z, cycle.retract_z) if self.returns_to_start else cycle.retract_z
        self.at = (x, y, back)
        if back != cycle.retract_z:
            yield Retract(z=back)

    def cycle_dwell(self, words: LineWords) -> float | None:
        """Dwell of a cycle, s, or None."""
        return self.seconds(words) if "P" in words else None

    def tapped(self, bottom: float, lead: float, sense: SpindleDirection) -> Block:
        """Rigid tap at the position of the tool."""
        if not self.speed or lead <= 0.0:
            raise PostError("a rigid tap without S, or without a lead")
        speed = rev_s_from_rpm(self.speed)
        return RigidTap(start=self.at, bottom_z=bottom, lead=lead, speed=speed, sense=sense)

    def _stops(self, words: LineWords) -> Iterator[Block]:
        stops: dict[str, type[ProgramStopBlock | OptionalStopBlock | ProgramEnd]] = {
            "M0": ProgramStopBlock,
            "M1": OptionalStopBlock,
            "M2": ProgramEnd,
            "M30": ProgramEnd,
        }
        for code in list(words.functions):
            if code in stops:
                words.functions.remove(code)
                yield stops[code]()
