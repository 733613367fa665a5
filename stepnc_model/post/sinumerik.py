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
    """Writer for the Sinumerik 840D."""

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
        """TURN= counts the turns of an arc, unless it comes back to where it began.

        Whether a circle that ends at its start counts as one turn more, manuals do not say.
        """
        at: Point = (0.0, 0.0, 0.0)
        for block in blocks:
            if isinstance(block, Circular) and abs(block.turn) % FULL < NARROW:
                yield from turns(at, block)
            else:
                yield block
            at = end_of(block, at)

    def keeps(self, cycle: DrillingCycle) -> bool:
        """A retract of 0 would mean the control's own."""
        is_said = cycle.kind not in PECKING or cycle.retract_distance > 0.0
        return is_said and super().keeps(cycle)

    def start(self, name: str) -> Iterator[str]:
        """Name and modes."""
        yield self.text(name)
        is_lathe = self.machine is MachineType.LATHE
        self.plane_words(ArcPlane.ZX if is_lathe else ArcPlane.XY)
        self.modal.set("mode", "G94")
        yield from self.line("G18" if is_lathe else "G17", "G40 G54 G710 G90 G94")
        if is_lathe:
            yield from self.line("DIAMON")

    def end(self, _: ProgramEnd) -> Iterator[str]:
        """End and rewind."""
        return self.line("M30")

    def text(self, text: str) -> str:
        """The rest of a line."""
        return f"; {ascii_text(text)[:LONGEST]}"

    def message(self, block: Message) -> Iterator[str]:
        """Text on the screen."""
        quoted = ascii_text(block.text).replace('"', "'")
        return self.line(f'MSG("{quoted[:LONGEST]}")')

    def tool_change(self, block: ToolChange) -> Iterator[str]:
        """Tool, then its edge 1; a turret turns at T."""
        yield from self.line(
            f"T{block.number}", "M6" if self.machine is MachineType.MILL else ""
        )
        yield from self.line("D1")
        self.pend("")

    def mode_code(self, mode: RateMode) -> str:
        """G94 and G95 would end a constant surface speed."""
        if self.is_surface_speed:
            return "G961" if mode is RateMode.PER_MINUTE else "G96"
        return super().mode_code(mode)

    def spindle_on(self, block: SpindleOn) -> Iterator[str]:
        """Constant speed; G97 brings feed per revolution with it."""
        if self.is_surface_speed:
            self.modal.set("mode", "G95")
            self.modal.forget("F")
        return super().spindle_on(block)

    def surface_speed(self, speed: str, limit: str, sense: str) -> Iterator[str]:
        """LIMS= with the limit, then G96, which brings feed per revolution with it."""
        if limit:
            yield from self.line(f"LIMS={limit}")
        self.modal.set("mode", "G96")
        self.modal.forget("F")
        yield from self.line("G96", f"S{speed}", sense)

    def seconds(self, value: float) -> str:
        """F of a G4 is in s."""
        return f"F{self.number(value, 3)}"

    def thread_words(self, start: Point, block: ThreadingMove) -> list[str]:
        """G33 with the lead of the axis that moves most."""
        moves = [abs(e - s) for s, e in zip(start, block.end, strict=True)]
        letter = "IJK"[moves.index(max(moves))]
        return ["G33", f"{letter}{self.number(block.lead, 4)}"]

    def rigid_tap(self, block: RigidTap) -> Iterator[str]:
        """G331 down and G332 up; a negative lead cuts a left-hand thread."""
        sign = 1.0 if block.sense is SpindleDirection.CLOCKWISE else -1.0
        lead = f"K{self.number(sign * block.lead, 4)}"
        bottom = f"Z{self.number(block.bottom_z, self.places)}"
        top = f"Z{self.number(block.start[2], self.places)}"
        yield from self.line("SPOS=0")
        yield from self.line("G331", bottom, lead, self.speed(block.speed))
        yield from self.line("G332", top, lead)

    def orient(self, _: SpindleOrient) -> Iterator[str]:
        """Spindle at angle 0."""
        return self.line("SPOS=0")

    def turn_words(self, block: Circular) -> list[str]:
        """TURN=, full turns besides the arc itself."""
        full = int(abs(block.turn) / FULL - 1e-9)
        return [f"TURN={full}"] if full else []

    def drilling_cycle(self, block: DrillingCycle) -> Iterator[str]:
        """A call where the tool is; its feed is that in force."""
        yield from self.rapid(Rapid(end=(*block.at, block.retract_z)))
        plane, mode = self.plane_words(ArcPlane.XY), self.mode(block.rate.mode)
        yield from self.line(plane, mode, self.rate(block.rate))
        arguments = ",".join(self._arguments(block)).rstrip(",")
        self.modal.forget("motion")
        yield from self.line(f"{self.cycle_codes[block.kind]}({arguments})")

    def _arguments(self, block: DrillingCycle) -> list[str]:
        """RTP, RFP, SDIS, DP and what each cycle adds."""
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
"""arguments after RTP, RFP, SDIS and DP that are read"""

CALL = re.compile(r"(?:N\d+\s*)?CYCLE(8[1235])\(([^()]*)\)")
MESSAGE = re.compile(r'(?:N\d+\s*)?MSG\("([^"]*)"\)')
ASSIGNED = re.compile(rf"\b(LIMS|SPOS|TURN)\s*=\s*({NUMBER})")
DIAMETER = re.compile(r"\bDIAMON\b")
CODES: dict[str, GCode] = (
    COMMON
    | PER_TIME
    | {
        "G33": GCodeAction.THREAD,
        "G90": GCodeAction.NOTHING,
        "G331": GCodeAction.TAP,
        "G332": GCodeAction.TAP_OUT,
        "G710": GCodeAction.NOTHING,
        "G961": GCodeAction.SURFACE_SPEED,
    }
)


class SinumerikReader(IsoReader):
    """Reader of Sinumerik code."""

    codes: Mapping[MachineType, Mapping[str, GCode]] = dict.fromkeys(MachineType, CODES)

    def __init__(self, machine: MachineType) -> None:
        super().__init__(machine)
        self.returns_to_start = False
        self._assigned: dict[str, float] = {}
        self._tap: tuple[float, float] | None = None
        self._pause = 0.0

    def line(self, line: str) -> Iterator[Block]:
        """A comment, a call, or words."""
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
        """Words with more than one letter, then the others."""
        if DIAMETER.search(code):
            self.machine, self.is_diameter = MachineType.LATHE, True
            code = DIAMETER.sub(" ", code)
        self._assigned = {}
        for name, text in ASSIGNED.findall(code):
            if name in self._assigned:
                raise PostError(f"word {name}={text}: a second {name} in one block")
            self._assigned[name] = number_of(f"{name}=", text)
        words = LineWords(pairs(ASSIGNED.sub(" ", code)))
        if "LIMS" in self._assigned:
            self.limit = rev_s_from_rpm(whole(self._assigned.pop("LIMS"), "LIMS="))
        yield from self.block(words)
        if self._assigned:
            raise PostError(f"word {next(iter(self._assigned))}=: nothing here uses it")

    def settle(self, acts: list[GCode], words: LineWords) -> None:
        """G94 to G97 are one group; F of a G4 is no feed."""
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
        """F, in s."""
        return self._pause

    def tool(self, words: LineWords) -> Iterator[Block]:
        """T and M6, or T alone on a lathe; D is the edge."""
        words.take("D")
        if self.machine is MachineType.LATHE and "T" in words:
            words.functions.append("M6")
        return super().tool(words)

    def extra(self, words: LineWords) -> Iterator[Block]:
        """Spindle at an angle."""
        angle = self._assigned.pop("SPOS", None)
        if angle:
            raise PostError(f"word SPOS={angle:g}: an angle of 0 is read")
        if angle is not None:
            yield SpindleOrient()

    def turns(self, words: LineWords) -> int:
        """TURN=, full turns besides the arc itself."""
        given = self._assigned.pop("TURN", 0.0)
        return whole(given, "TURN=") if given else 0

    def lead(self, end: Point, words: LineWords) -> float:
        """I, J or K, of the axis that moves most."""
        moves = [abs(e - s) for s, e in zip(self.at, end, strict=True)]
        return words.need("IJK"[moves.index(max(moves))], "G33")

    def tap(self, words: LineWords, act: GCode) -> Iterator[Block]:
        """G331 down and G332 up make one tap."""
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
        """A drilling cycle where the tool is."""
        filled = [text.strip() for text in texts]
        if not all(re.fullmatch(NUMBER, text) for text in filled if text):
            raise PostError(f"CYCLE{number}: its arguments must be numbers")
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
        """Arguments that would change the cycle and are not read must not be there."""
        for index, value in enumerate(rest):
            if value and index not in READ[number]:
                raise PostError(f"CYCLE{number}: argument {index + 5}, {value:g}, is not read")
        if number == "83" and rest[6] not in {0.0, 1.0}:
            raise PostError(f"CYCLE83: a feed of {rest[6]:g} at the first peck is not read")
        if number == "85" and any(f not in {0.0, self.feed} for f in rest[2:4]):
            raise PostError("CYCLE85: feeds other than the one in force are not read")
