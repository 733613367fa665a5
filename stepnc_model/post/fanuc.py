"""NC code for Fanuc controls, mill (M) and lathe (T, G-code system A), and for Haas.

After Fanuc, "Series 0i-MODEL F Operator's Manual" (B-64604EN, B-64604EN-1 for lathes,
B-64604EN-2 for machining centres) and, for rigid tapping by lead,
"Series 0i Connection Manual (Function)" (B-63833EN-1). Dwells are in ms, X of a lathe is a
diameter, and its G98 and G99 are the feed modes. Parameter 5115 sets how far above the last
depth a peck begins, parameter 5114 its short retract.

For Haas controls after Haas, "Mill Operator's Manual" and "Lathe Operator's Manual" (Next
Generation Control): similar to Fanuc, but P of a dwell is in s with a decimal point and in ms
without, M88 and M89 switch coolant through the spindle, G84 starts the spindle itself (G74 on a
mill and G184 on a lathe for left-hand threads), and a mill has no thread cutting. Setting 22 is
the height above the last depth where a peck begins.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    CoolantKind,
    MachineType,
    ProgramEnd,
    RateMode,
    RigidTap,
    SpindleDirection,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.iso_code import IsoCode
from stepnc_model.post.words import (
    ascii_text,
    pointed,
)
from stepnc_model.toolpath.path import ArcPlane, Point
from stepnc_model.units import ms_from_seconds

LONGEST = 100
"""Greatest length of a comment in characters."""

MOST_TOOLS = 99
"""Greatest tool number on a lathe, which has two digits."""

LATHE_MODES = {RateMode.PER_MINUTE: "G98", RateMode.PER_REVOLUTION: "G99"}

REFUSED = re.compile(r"[^A-Z0-9 .,+\-*/=#\[\]&_?@]")
"""Characters not in every character set; % and ; would end the program or the block."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DialectTraits:
    """Differences between the controls of the Fanuc family."""

    head: str
    """Program number in the head of the program."""
    seconds: Callable[[float], str]
    """Format a dwell in seconds as a P word."""
    coolant: Mapping[CoolantKind, str]
    coolant_ends: tuple[str, ...]
    threads: Mapping[MachineType, str]
    """G code of thread cutting by machine type."""
    taps: Mapping[tuple[MachineType, SpindleDirection], str]
    """G code of rigid tapping by machine type and spindle direction."""
    tap_speed: str
    """Word before the S word of a rigid tap."""
    retract: frozenset[MachineType]
    """Machine types where a rigid tap names its absolute retract plane."""


FANUC = DialectTraits(
    head="O0001",
    seconds=lambda value: f"P{round(ms_from_seconds(value))}",
    coolant={CoolantKind.FLOOD: "M8", CoolantKind.MIST: "M7", CoolantKind.THROUGH: "M8"},
    coolant_ends=("M9",),
    threads={MachineType.MILL: "G33", MachineType.LATHE: "G32"},
    taps={
        (MachineType.MILL, SpindleDirection.CLOCKWISE): "G84",
        (MachineType.MILL, SpindleDirection.COUNTERCLOCKWISE): "G74",
        (MachineType.LATHE, SpindleDirection.CLOCKWISE): "G84",
    },
    tap_speed="M29",
    retract=frozenset({MachineType.MILL}),
)


class Fanuc(IsoCode):
    """Writer of NC code for Fanuc and Haas controls."""

    exact_codes: ClassVar[tuple[str, ...]] = ("G61", "G64")

    def __init__(self, manner: DialectTraits = FANUC) -> None:
        super().__init__()
        self.manner = manner
        self.coolant_codes = manner.coolant

    def number(self, value: float, places: int) -> str:
        """Format a number with a decimal point: without it old controls count in µm."""
        return pointed(value, places)

    def start(self, name: str) -> Iterator[str]:
        """Write the percent sign, the program number and the initial modes."""
        yield "%"
        yield f"{self.manner.head} {self.text(name)}"
        is_lathe = self.machine is MachineType.LATHE
        self.plane_words(ArcPlane.ZX if is_lathe else ArcPlane.XY)
        self.modal.set("mode", "G99" if is_lathe else "G94")
        yield from self.line(
            "G18 G21 G40 G54 G80 G97 G99" if is_lathe else "G17 G21 G40 G49 G54 G80 G90 G94"
        )

    def end(self, _: ProgramEnd) -> Iterator[str]:
        """Write the program end and the percent sign."""
        yield from self.inexact()
        yield from self.line("M30")
        yield "%"

    def text(self, text: str) -> str:
        """Format a comment in capitals, using only safe characters."""
        plain = ascii_text(text).upper().replace("(", "[").replace(")", "]")
        return f"({REFUSED.sub(' ', plain)[:LONGEST]})"

    def tool_change(self, block: ToolChange) -> Iterator[str]:
        """Write T and M6, with the offset in the next z move; on a lathe T holds both."""
        if self.machine is MachineType.MILL:
            yield from self.line(f"T{block.number}", "M6")
            self.pend(f"G43 H{block.number}")
            return
        if block.number > MOST_TOOLS:
            raise PostError(f"tool {block.number}: a lathe has at most {MOST_TOOLS} tools")
        yield from self.line(f"T{block.number:02}{block.number:02}")
        self.pend("")

    def mode_code(self, mode: RateMode) -> str:
        """G code of a feed mode: G94 and G95, or G98 and G99 on a lathe."""
        is_lathe = self.machine is MachineType.LATHE
        return LATHE_MODES[mode] if is_lathe else super().mode_code(mode)

    def surface_speed(self, speed: str, limit: str, sense: str) -> Iterator[str]:
        """Write G50 with the limit, then G96; without a limit the previous one stays."""
        if limit:
            yield from self.line("G50", f"S{limit}")
        yield from self.line("G96", f"S{speed}", sense)

    def coolant_off(self) -> Iterator[str]:
        """Switch all coolant off."""
        codes = [self.manner.coolant_ends[0]] if self.cooling - {self._through} else []
        if self._through in self.cooling:
            codes.append(self.manner.coolant_ends[-1])
        self.cooling.clear()
        for code in dict.fromkeys(codes):
            yield from self.line(code)

    @property
    def _through(self) -> str:
        return self.manner.coolant[CoolantKind.THROUGH]

    def seconds(self, value: float) -> str:
        """Format a dwell time as a P word."""
        return self.manner.seconds(value)

    def thread_words(self, start: Point, block: ThreadingMove) -> list[str]:
        """Thread cutting code with the lead as the F word."""
        if self.machine not in self.manner.threads:
            raise PostError(f"a synchronised move: this {self.machine} does not support it")
        return [self.manner.threads[self.machine], f"F{self.number(block.lead, 4)}"]

    def rigid_tap(self, block: RigidTap) -> Iterator[str]:
        """Write the speed, the tapping cycle with the lead in F, and its end."""
        code = self.manner.taps.get((self.machine, block.sense))
        if code is None:
            raise PostError(f"a left-hand rigid tap: this {self.machine} does not support it")
        is_mill = self.machine is MachineType.MILL
        retract = ""
        if self.machine in self.manner.retract:
            retract = f"R{self.number(block.start[2], self.places)}"
        yield from self.line(self.manner.tap_speed, self.speed(block.speed))
        yield from self.line(
            self.mode(RateMode.PER_REVOLUTION),
            "G99" if is_mill else "",
            code,
            f"Z{self.number(block.bottom_z, self.places)}",
            retract,
            f"F{self.number(block.lead, 4)}",
        )
        yield from self.line("G80")


HAAS = DialectTraits(
    head="O00001",
    seconds=lambda value: f"P{pointed(value, 3)}",
    coolant={CoolantKind.FLOOD: "M8", CoolantKind.MIST: "M7", CoolantKind.THROUGH: "M88"},
    coolant_ends=("M9", "M89"),
    threads={MachineType.LATHE: "G32"},
    taps={
        (MachineType.MILL, SpindleDirection.CLOCKWISE): "G84",
        (MachineType.MILL, SpindleDirection.COUNTERCLOCKWISE): "G74",
        (MachineType.LATHE, SpindleDirection.CLOCKWISE): "G84",
        (MachineType.LATHE, SpindleDirection.COUNTERCLOCKWISE): "G184",
    },
    tap_speed="",
    retract=frozenset({MachineType.MILL, MachineType.LATHE}),
)
