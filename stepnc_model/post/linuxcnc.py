"""NC code for LinuxCNC, mill and lathe.

After LinuxCNC 2.9, "G-Code reference": G7 (lathe diameter), G33 and G33.1 (K is the distance
along the path for each revolution), G96 D S, P for the turns of an arc, G73 and G81 to G86
with a fixed retract of 0.254 mm.
"""

from collections.abc import Iterable, Iterator, Mapping
from math import isfinite
from typing import ClassVar

from stepnc_model.post.blocks import (
    Block,
    Circular,
    MachineType,
    Message,
    PathControl,
    ProgramEnd,
    ProgramStart,
    RigidTap,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.canonical import synchronised
from stepnc_model.post.iso_code import SENSE_CODES, IsoCode
from stepnc_model.post.words import (
    ascii_text,
    bracketed,
)
from stepnc_model.toolpath.arc import begun_turns
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point

LONGEST = 200
"""Greatest length of a comment in characters; a line may have 255."""

ACTIVE = (
    "MSG,",
    "DEBUG,",
    "PRINT,",
    "LOG,",
    "LOGOPEN,",
    "LOGAPPEND,",
    "LOGCLOSE",
    "PROBE",
    "PY,",
    "ABORT,",
    "AXIS,",
)
"""Beginnings that turn a comment into a command."""


class LinuxCnc(IsoCode):
    """Writer of NC code for LinuxCNC."""

    places: ClassVar[int] = 4
    speed_places: ClassVar[int] = 3
    dwelling: ClassVar[frozenset[CycleKind]] = frozenset({
        CycleKind.DWELL,
        CycleKind.BORE_STOP,
    })
    wide_codes: ClassVar[Mapping[MachineType, str]] = {
        MachineType.MILL: "G17 G21 G40 G49 G54 G80 G90 G91.1 G94 G97",
        MachineType.LATHE: "G18 G21 G40 G49 G54 G7 G80 G90 G91.1 G94 G97",
    }

    def __init__(self) -> None:
        super().__init__()
        self._has_adaptive_feed = False

    def shaped(self, blocks: Iterable[Block]) -> Iterator[Block]:
        """Keep arcs unchanged: P counts their turns."""
        return iter(blocks)

    def start(self, name: str) -> Iterator[str]:
        """Write the percent sign, the name and the initial modes."""
        yield "%"
        yield self.text(name)
        is_lathe = self.machine is MachineType.LATHE
        self.plane_words(ArcPlane.ZX if is_lathe else ArcPlane.XY)
        self.modal.set("mode", "G94")
        yield from self.line(self.wide_codes[self.machine])

    def _start(self, block: ProgramStart) -> Iterator[str]:
        yield from super()._start(block)
        if block.has_adaptive_feed:
            # Without it the control ignores the pin motion.adaptive-feed; M2 keeps it, so that
            # the end of the program switches it off.
            yield from self.line("M52", "P1")
            self._has_adaptive_feed = True

    def end(self, _: ProgramEnd) -> Iterator[str]:
        """Write the program end and the percent sign."""
        if self._has_adaptive_feed:
            yield from self.line("M52", "P0")
        yield from self.line("M2")
        yield "%"

    def text(self, text: str) -> str:
        """Comment that LinuxCNC does not interpret as a command."""
        plain = ascii_text(text).strip()
        is_active = plain.upper().replace(" ", "").startswith(ACTIVE)
        return bracketed(f"- {plain}" if is_active else plain, LONGEST)

    def path_mode(self, block: PathControl) -> Iterator[str]:
        """Write the path mode.

        Without one the program would run in the mode of the program before it: M2 keeps it, and
        after a plain G64 a corner is cut by millimetres.
        """
        if block.tolerance == 0.0:
            code = "G61.1" if block.is_exact_stop else "G61"
        else:
            code = "G64"
            for letter, value in (("P", block.tolerance), ("Q", block.joining)):
                if value is not None and isfinite(value):
                    code += f" {letter}{self.number(value, self.places)}"
        yield from self.line(self.modal.word("path", code))

    def message(self, block: Message) -> Iterator[str]:
        """Write a message to the operator's screen."""
        yield bracketed(f"MSG,{block.text}", LONGEST)

    def tool_change(self, block: ToolChange) -> Iterator[str]:
        """Write the tool change and the length offset."""
        yield from self.line(f"T{block.number}", "M6")
        yield from self.line(f"G43 H{block.number}")
        self.pend("")

    def surface_speed(self, speed: str, limit: str, sense: str) -> Iterator[str]:
        """Write G96 with its speed limit."""
        return self.line("G96", f"D{limit}" if limit else "", f"S{speed}", sense)

    def thread_words(self, start: Point, block: ThreadingMove) -> list[str]:
        """G33 with the lead along the path."""
        lead = synchronised(start, block.end, block.lead)
        return ["G33", f"K{self.number(lead, 4)}"]

    def rigid_tap(self, block: RigidTap) -> Iterator[str]:
        """Write G33.1, which taps and retracts."""
        yield from self.line(self.speed(block.speed), SENSE_CODES[block.sense])
        z = f"Z{self.number(block.bottom_z, self.places)}"
        yield from self.line("G33.1", z, f"K{self.number(block.lead, 4)}")

    def turn_words(self, block: Circular) -> list[str]:
        """P word with the number of turns, begun turns included."""
        turns = begun_turns(block.arc.turn)
        return [f"P{turns}"] if turns > 1 else []
