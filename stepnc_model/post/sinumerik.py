"""NC code for the Siemens Sinumerik 840D, mill and lathe.

After Siemens, "SINUMERIK 840D sl / 828D Programming Manual, Fundamentals" (6FC5398-1BP40:
G331, G332, G33, TURN=, and G96, G961, G97 of one group with G94 and G95) and "SINUMERIK
840D/840Di/810D Programming Guide, Cycles" (6FC5298-6AB40: CYCLE81, 82, 83, 85). X of a lathe
is a diameter (DIAMON), its I stays a radius. Cycles are called where the tool is, not modally.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar

from stepnc_model.post.blocks import (
    Block,
    Circular,
    DrillingCycle,
    MachineType,
    Message,
    ProgramEnd,
    Rapid,
    RateMode,
    RigidTap,
    SpindleDirection,
    SpindleOn,
    SpindleOrient,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.grid import NARROW, end_of, turns
from stepnc_model.post.iso_code import IsoCode
from stepnc_model.post.words import (
    ascii_text,
)
from stepnc_model.toolpath.arc import FULL, begun_turns
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point

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
            if isinstance(block, Circular) and abs(block.arc.turn) % FULL < NARROW:
                yield from turns(at, block)
            else:
                yield block
            at = end_of(block, at)

    def keeps(self, cycle: DrillingCycle) -> bool:
        """True if a cycle is kept; a retract distance of 0 would select the default."""
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
        full = begun_turns(block.arc.turn) - 1
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
