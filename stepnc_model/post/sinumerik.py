"""NC code for the Siemens Sinumerik 840D, mill and lathe.

After Siemens, "SINUMERIK 840D sl / 828D Programming Manual, Fundamentals" (6FC5398-1BP40:
G331, G332, G33, TURN=, and G96, G961, G97 of one group with G94 and G95) and "SINUMERIK
840D/840Di/810D Programming Guide, Cycles" (6FC5298-6AB40: CYCLE81, 82, 83, 85). X of a lathe
is a diameter (DIAMON), its I stays a radius. Cycles are called where the tool is, not modally.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    DrillingCycle,
    MachineType,
    Message,
    ProgramEnd,
    Rapid,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOn,
    SpindleOrient,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.grid import FULL, NARROW, end_of, turns
from stepnc_model.post.iso_code import IsoCode
from stepnc_model.post.iso_reader import ROUND, IsoReader
from stepnc_model.post.words import (
    COMMON,
    NUMBER,
    PER_TIME,
    GCode,
    GCodeAction,
    LineWords,
    ascii_text,
    number_of,
    pairs,
    whole,
)
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import rev_s_from_rpm

LONGEST = 150
PECKING = frozenset({CycleKind.PECK, CycleKind.CHIP_BREAK})


class Sinumerik(IsoCode):
    """Writer of NC code for the Sinumerik 840D."""

    exact_codes: ClassVar[tuple[str, ...]] = ("G60", "G64")
    speed_places: ClassVar[int] = 3
    last_number: ClassVar[int] = 99_999_999
    cycle_codes: ClassVar[Mapping[CycleKind, str]] = {
        CycleKind.DRILL: "CYCLE81",
        CycleKind.DWELL: "CYCLE82",
        CycleKind.PECK: "CYCLE83",
        CycleKind.CHIP_BREAK: "CYCLE83",
        CycleKind.BORE: "CYCLE85",
    }

    def shaped(self, blocks: Iterable[Block]) -> Iterator[Block]:
        """Split arcs that return to their start; other arcs count their turns with TURN=.

        Manuals do not say whether a circle that ends at its start counts as one turn more.
        """
        at: Point = (0.0, 0.0, 0.0)
        for block in blocks:
            if isinstance(block, Circular) and abs(block.turn) % FULL < NARROW:
                yield from turns(at, block)
            else:
                yield block
            at = end_of(block, at)

    def keeps(self, cycle: DrillingCycle) -> bool:
        """Whether a cycle is kept; a retract distance of 0 would select the default."""
        is_said = cycle.kind not in PECKING or cycle.retract_distance > 0.0
        return is_said and super().keeps(cycle)

    def start(self, name: str) -> Iterator[str]:
        """Write the program name and the initial modes."""
        yield self.text(name)
        is_lathe = self.machine is MachineType.LATHE
        self.plane_words(ArcPlane.ZX if is_lathe else ArcPlane.XY)
        self.modal.set("mode", "G94")
        yield from self.line("G18" if is_lathe else "G17", "G40 G54 G710 G90 G94")
        if is_lathe:
            yield from self.line("DIAMON")

    def end(self, _: ProgramEnd) -> Iterator[str]:
        """Write the program end."""
        yield from self.inexact()
        yield from self.line("M30")

    def text(self, text: str) -> str:
        """Comment to the end of the line."""
        return f"; {ascii_text(text)[:LONGEST]}"

    def message(self, block: Message) -> Iterator[str]:
        """Write a message to the operator's screen."""
        quoted = ascii_text(block.text).replace('"', "'")
        return self.line(f'MSG("{quoted[:LONGEST]}")')

    def tool_change(self, block: ToolChange) -> Iterator[str]:
        """Write the tool call and cutting edge D1; on a lathe T alone turns the turret."""
        yield from self.line(
            f"T{block.number}", "M6" if self.machine is MachineType.MILL else ""
        )
        yield from self.line("D1")
        self.pend("")

    def mode_code(self, mode: RateMode) -> str:
        """G code of a feed mode; G94 and G95 would end a constant surface speed."""
        if self.is_surface_speed:
            return "G961" if mode is RateMode.PER_MINUTE else "G96"
        return super().mode_code(mode)

    def spindle_on(self, block: SpindleOn) -> Iterator[str]:
        """Switch the spindle on at constant speed; G97 implies feed per revolution."""
        if self.is_surface_speed:
            self.modal.set("mode", "G95")
            self.modal.forget("F")
        return super().spindle_on(block)

    def surface_speed(self, speed: str, limit: str, sense: str) -> Iterator[str]:
        """Write LIMS= with the limit, then G96, which implies feed per revolution."""
        if limit:
            yield from self.line(f"LIMS={limit}")
        self.modal.set("mode", "G96")
        self.modal.forget("F")
        yield from self.line("G96", f"S{speed}", sense)

    def seconds(self, value: float) -> str:
        """Dwell time as the F word of G4, in seconds."""
        return f"F{self.number(value, 3)}"

    def thread_words(self, start: Point, block: ThreadingMove) -> list[str]:
        """G33 with the lead along the axis that moves most."""
        moves = [abs(e - s) for s, e in zip(start, block.end, strict=True)]
        letter = "IJK"[moves.index(max(moves))]
        return ["G33", f"{letter}{self.number(block.lead, 4)}"]

    def rigid_tap(self, block: RigidTap) -> Iterator[str]:
        """Write G331 down and G332 up; a negative lead cuts a left-hand thread."""
        sign = 1.0 if block.sense is SpindleDirection.CLOCKWISE else -1.0
        lead = f"K{self.number(sign * block.lead, 4)}"
        bottom = f"Z{self.number(block.bottom_z, self.places)}"
        top = f"Z{self.number(block.start[2], self.places)}"
        yield from self.line("SPOS=0")
        yield from self.line("G331", bottom, lead, self.speed(block.speed))
        yield from self.line("G332", top, lead)

    def orient(self, _: SpindleOrient) -> Iterator[str]:
        """Orient the spindle at angle 0."""
        return self.line("SPOS=0")

    def turn_words(self, block: Circular) -> list[str]:
        """TURN= with the number of full turns besides the arc itself."""
        full = int(abs(block.turn) / FULL - 1e-9)
        return [f"TURN={full}"] if full else []

    def drilling_cycle(self, block: DrillingCycle) -> Iterator[str]:
        """Write a cycle call at the current position, with the feed in force."""
        yield from self.rapid(Rapid(end=(*block.at, block.retract_z)))
        plane, mode = self.plane_words(ArcPlane.XY), self.mode(block.rate.mode)
        yield from self.line(plane, mode, self.rate(block.rate))
        arguments = ",".join(self._arguments(block)).rstrip(",")
        self.modal.forget("motion")
        yield from self.line(f"{self.cycle_codes[block.kind]}({arguments})")

    def _arguments(self, block: DrillingCycle) -> list[str]:
        """Arguments RTP, RFP, SDIS and DP, and those of the individual cycle."""
        top = self.number(block.retract_z, self.places)
        head = [top, top, "0", self.number(block.bottom_z, self.places)]
        dwell = self.number(block.dwell, 3)
        if block.kind is CycleKind.DWELL:
            return [*head, "", dwell]
        if block.kind is CycleKind.BORE:
            feed = self.rate_text(block.rate)
            return [*head, "", dwell, feed, feed]
        if block.kind not in PECKING:
            return head
        step = self.number(block.step_depth, self.places)
        short = self.number(block.retract_distance, self.places)
        is_peck = block.kind is CycleKind.PECK
        # DPR, FDEP, FDPR, DAM, DTB, DTS, FRF, VARI, _AXN, _MDEP, _VRT, _DTD, _DIS1
        own = ["", "", step, "0", "0", "0", "1", "1" if is_peck else "0", "", ""]
        return [*head, *own, *(["", "", short] if is_peck else [short])]


CYCLES = {"81": CycleKind.DRILL, "82": CycleKind.DWELL, "85": CycleKind.BORE}
READ = {"81": (), "82": (1,), "83": (2, 4, 6, 7, 10, 12), "85": (1, 2, 3)}
"""Indices of the arguments after RTP, RFP, SDIS and DP that are read, by cycle."""

CALL = re.compile(r"(?:N\d+\s*)?CYCLE(8[1235])\(([^()]*)\)")
MESSAGE = re.compile(r'(?:N\d+\s*)?MSG\("([^"]*)"\)')
ASSIGNED = re.compile(rf"\b(LIMS|SPOS|TURN)\s*=\s*({NUMBER})")
DIAMETER = re.compile(r"\bDIAMON\b")
CODES: dict[str, GCode] = (
    COMMON
    | PER_TIME
    | {
        "G33": GCodeAction.THREAD,
        "G60": GCodeAction.PATH_MODE,
        "G64": GCodeAction.PATH_MODE,
        "G90": GCodeAction.NOTHING,
        "G331": GCodeAction.TAP,
        "G332": GCodeAction.TAP_OUT,
        "G710": GCodeAction.NOTHING,
        "G961": GCodeAction.SURFACE_SPEED,
    }
)


class SinumerikReader(IsoReader):
    """Reader of Sinumerik NC code."""

    codes: Mapping[MachineType, Mapping[str, GCode]] = dict.fromkeys(MachineType, CODES)

    def __init__(self, machine: MachineType) -> None:
        super().__init__(machine)
        self.returns_to_start = False
        self._assigned: dict[str, float] = {}
        self._tap: tuple[float, float] | None = None
        self._pause = 0.0

    def line(self, line: str) -> Iterator[Block]:
        """Blocks of one line: a message, a cycle call, or words, and a comment."""
        message = MESSAGE.fullmatch(line.strip())
        code, mark, text = ("", "", "") if message else line.partition(";")
        call = CALL.fullmatch(code.strip())
        if message:
            yield Message(text=message[1])
        elif call:
            yield from self._called(call[1], call[2].split(","))
        elif code.strip():
            yield from self._assignments(code)
        if mark:
            yield Comment(text=text.strip())

    def _assignments(self, code: str) -> Iterator[Block]:
        """Read words with several letters, then the others."""
        if DIAMETER.search(code):
            self.machine, self.is_diameter = MachineType.LATHE, True
            code = DIAMETER.sub(" ", code)
        self._assigned = {}
        for name, text in ASSIGNED.findall(code):
            if name in self._assigned:
                raise PostError(f"word {name}={text}: {name} appears twice in one block")
            self._assigned[name] = number_of(f"{name}=", text)
        words = LineWords(pairs(ASSIGNED.sub(" ", code)))
        if "LIMS" in self._assigned:
            self.limit = rev_s_from_rpm(whole(self._assigned.pop("LIMS"), "LIMS="))
        yield from self.block(words)
        if self._assigned:
            raise PostError(f"word {next(iter(self._assigned))}=: not used by this block")

    def settle(self, acts: list[GCode], words: LineWords) -> None:
        """Update the modal state; G94 to G97 are one group, and the F of G4 is no feed."""
        if GCodeAction.DWELL in acts:
            self._pause = words.need("F", "G4")
        if RateMode.PER_MINUTE in acts or RateMode.PER_REVOLUTION in acts:
            self.is_surface_speed = False
        if "G961" in words.codes:
            acts.append(RateMode.PER_MINUTE)
        elif GCodeAction.SURFACE_SPEED in acts or GCodeAction.SPINDLE_SPEED in acts:
            acts.append(RateMode.PER_REVOLUTION)
        super().settle(acts, words)

    def seconds(self, words: LineWords) -> float:
        """Dwell time from F, s."""
        return self._pause

    def tool(self, words: LineWords) -> Iterator[Block]:
        """Tool change by T and M6, or by T alone on a lathe; D selects the edge."""
        words.take("D")
        if self.machine is MachineType.LATHE and "T" in words:
            words.functions.append("M6")
        return super().tool(words)

    def extra(self, words: LineWords) -> Iterator[Block]:
        """Spindle orientation by SPOS=."""
        angle = self._assigned.pop("SPOS", None)
        if angle:
            raise PostError(f"word SPOS={angle:g}: only angle 0 is supported")
        if angle is not None:
            yield SpindleOrient()

    def turns(self, words: LineWords) -> int:
        """Number of full turns from TURN=, besides the arc itself."""
        given = self._assigned.pop("TURN", 0.0)
        return whole(given, "TURN=") if given else 0

    def lead(self, end: Point, words: LineWords) -> float:
        """Lead from I, J or K of the axis that moves most, mm."""
        moves = [abs(e - s) for s, e in zip(self.at, end, strict=True)]
        return words.need("IJK"[moves.index(max(moves))], "G33")

    def tap(self, words: LineWords, act: GCode) -> Iterator[Block]:
        """Combine G331 down and G332 up into one rigid tap."""
        z, lead = words.need("Z", "a tap"), words.need("K", "a tap")
        if act is GCodeAction.TAP:
            self._tap = (z, lead)
            return
        if self._tap is None or abs(z - self.at[2]) > ROUND or lead != self._tap[1]:
            raise PostError("G332 must lead back to where G331 began, with the same lead")
        bottom, self._tap = self._tap[0], None
        self.sense = (
            SpindleDirection.CLOCKWISE if lead > 0.0 else SpindleDirection.COUNTERCLOCKWISE
        )
        yield self.tapped(bottom, abs(lead), self.sense)

    def _called(self, number: str, texts: list[str]) -> Iterator[Block]:
        """Read a drilling cycle at the current position."""
        filled = [text.strip() for text in texts]
        if not all(re.fullmatch(NUMBER, text) for text in filled if text):
            raise PostError(f"CYCLE{number}: the arguments must be numbers")
        arguments = [number_of(f"CYCLE{number} ", text or "0") for text in filled]
        if len(arguments) < 4:
            raise PostError(f"CYCLE{number}: needs at least RTP, RFP, SDIS and DP")
        top, reference, distance, bottom, *rest = arguments
        rest += [0.0] * (13 - len(rest))
        self._refuse_more(number, rest)
        kind = CYCLES.get(number)
        if kind is None:
            kind = CycleKind.PECK if rest[7] == 1.0 else CycleKind.CHIP_BREAK
        is_deep = number == "83"
        cycle = DrillingCycle(
            kind=kind,
            at=self.at[:2],
            retract_z=reference + distance,
            bottom_z=bottom,
            rate=self.rate(),
            step_depth=rest[2] if is_deep else 0.0,
            retract_distance=rest[12 if kind is CycleKind.PECK else 10] if is_deep else 0.0,
            dwell=rest[4] if is_deep else rest[1],
        )
        yield from self.drilled(cycle)
        if top != self.at[2]:
            self.at = (*cycle.at, top)
            yield Retract(z=top)

    def _refuse_more(self, number: str, rest: list[float]) -> None:
        """Raise an error on arguments that would change the cycle but are not supported."""
        for index, value in enumerate(rest):
            if value and index not in READ[number]:
                raise PostError(
                    f"CYCLE{number}: argument {index + 5}, {value:g}, is not supported"
                )
        if number == "83" and rest[6] not in {0.0, 1.0}:
            raise PostError(
                f"CYCLE83: a feed of {rest[6]:g} at the first peck is not supported"
            )
        if number == "85" and any(f not in {0.0, self.feed} for f in rest[2:4]):
            raise PostError("CYCLE85: feeds other than the current one are not supported")
