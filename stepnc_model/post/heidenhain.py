"""NC code for Heidenhain controls in Klartext, mills only.

After Heidenhain, "iTNC 530 User's Manual, HEIDENHAIN Conversational Format" and "User's Manual
for Cycle Programming": L, CC with C for arcs and CP with IPA and IZ for helices, CYCL DEF 9
(dwell), 13 (orientation), 200 (drilling), 201 (reaming), 205 (universal pecking), 207 (rigid
tapping). Pitch and depth are signed. DR+ turns from the first axis of a plane to its second:
x y, z x, y z.
"""

import re
from collections.abc import Callable, Iterable, Iterator

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    Cycles,
    DrillingCycle,
    Linear,
    MachineType,
    Message,
    OptionalStopBlock,
    PathControl,
    Pause,
    ProgramEnd,
    ProgramStart,
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
)
from stepnc_model.post.grid import end_of, flat, on_grid, turns
from stepnc_model.post.words import Modal, ascii_text, decimal
from stepnc_model.toolpath.arc import FULL
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import deg_from_rad, mm_min_from_speed, rpm_from_rev_s

PLACES = 3
ANGLE_PLACES = 4
LONGEST = 80
"""Greatest length of a comment in characters."""

LONGEST_NAME = 16
KEPT = frozenset({
    CycleKind.DRILL,
    CycleKind.DWELL,
    CycleKind.PECK,
    CycleKind.CHIP_BREAK,
    CycleKind.BORE,
})
DWELLING = frozenset({CycleKind.DWELL, CycleKind.BORE})
TITLES = {
    "200": "DRILLING",
    "201": "REAMING",
    "205": "UNIVERSAL PECKING",
    "207": "RIGID TAPPING NEW",
}


class Heidenhain:
    """Writer of Klartext; tracks the modal state and the position of the tool."""

    def __init__(self) -> None:
        self.modal = Modal()
        self.at: list[float | None] = [None, None, None]
        self.name = ""
        self._number = 0
        self._tool: ToolChange | None = None
        self._cooling = False
        self._helix_end: Point | None = None
        self._makers: dict[type, Callable[..., Iterator[str]]] = {
            ProgramStart: self._start,
            ProgramEnd: self._end,
            Comment: self._comment,
            PathControl: lambda _: iter(()),
            Message: self._comment,
            ToolChange: self._tool_change,
            SpindleOn: self._spindle_on,
            SurfaceSpeed: self._refuse,
            SpindleOff: lambda _: self._line("M5"),
            SpindleOrient: self._orient,
            Coolant: self._coolant,
            Retract: self._retract,
            Rapid: self._rapid,
            Linear: self._linear,
            Circular: self._circular,
            ThreadingMove: self._refuse,
            RigidTap: self._rigid_tap,
            Pause: self._pause,
            ProgramStopBlock: lambda _: self._line("STOP"),
            OptionalStopBlock: lambda _: self._line("M1"),
            DrillingCycle: self._drilling_cycle,
        }

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """Lines of the Klartext program."""
        kept = _keeps if cycles is Cycles.OWN else None
        for block in on_grid(_shaped(flat(blocks, kept)), PLACES):
            # The speed of a new tool is part of its tool call.
            if self._tool is not None and not isinstance(block, (SpindleOn, Comment)):
                yield from self._called("")
            yield from self._makers[type(block)](block)

    def _line(self, *words: str) -> Iterator[str]:
        yield f"{self._number} {' '.join(word for word in words if word)}"
        self._number += 1

    def _start(self, block: ProgramStart) -> Iterator[str]:
        if block.machine is MachineType.LATHE:
            raise PostError("Klartext is written for mills only")
        plain = re.sub(r"[^A-Z0-9]+", "_", ascii_text(block.name).upper()).strip("_")
        self.name = plain[:LONGEST_NAME] or "PART"
        return self._line(f"BEGIN PGM {self.name} MM")

    def _end(self, _: ProgramEnd) -> Iterator[str]:
        yield from self._line("M30")
        yield from self._line(f"END PGM {self.name} MM")

    def _comment(self, block: Comment | Message) -> Iterator[str]:
        # A tilde would continue the block on the next line.
        return self._line(f"; {ascii_text(block.text).replace('~', '-')[:LONGEST]}")

    def _refuse(self, block: Block) -> Iterator[str]:
        raise PostError(f"{type(block).__name__}: Klartext for mills does not support it")

    def _tool_change(self, block: ToolChange) -> Iterator[str]:
        self._tool = block
        self.at = [None, None, None]
        yield from ()

    def _called(self, speed: str) -> Iterator[str]:
        tool, self._tool = self._tool, None
        if tool is not None:
            self.modal.forget("F", "R", "S")
            self.modal.set("S", speed)
            yield from self._line(f"TOOL CALL {tool.number} Z", speed)

    def _spindle_on(self, block: SpindleOn) -> Iterator[str]:
        yield from self._speed(block.speed)
        yield from self._line("M3" if block.sense is SpindleDirection.CLOCKWISE else "M4")

    def _speed(self, speed: float) -> Iterator[str]:
        """Write the spindle speed, in the call of a new tool or in a separate call."""
        text = f"S{decimal(rpm_from_rev_s(speed), 3)}"
        if self._tool is not None:
            yield from self._called(text)
        elif self.modal.word("S", text):
            yield from self._line("TOOL CALL", text)

    def _orient(self, _: SpindleOrient) -> Iterator[str]:
        yield from self._line("CYCL DEF 13.0 ORIENTATION")
        yield from self._line("CYCL DEF 13.1 ANGLE 0")
        yield from self._line("M19")

    def _coolant(self, block: Coolant) -> Iterator[str]:
        """Write M8 for every kind of coolant: other M codes depend on the machine's builder."""
        if bool(block.kinds) is not self._cooling:
            self._cooling = bool(block.kinds)
            yield from self._line("M8" if block.kinds else "M9")

    def _pause(self, block: Pause) -> Iterator[str]:
        yield from self._line("CYCL DEF 9.0 DWELL TIME")
        yield from self._line(f"CYCL DEF 9.1 DWELL {decimal(block.seconds, 3)}")
        self.modal.forget("cycle")

    def _retract(self, block: Retract) -> Iterator[str]:
        if block.z != self.at[2]:
            self.at[2] = block.z
            z = f"Z{_signed(block.z)}"
            yield from self._line("L", z, self.modal.word("R", "R0"), "FMAX")

    def _rapid(self, block: Rapid) -> Iterator[str]:
        words = self._coordinates(block.end)
        if words:
            yield from self._line("L", *words, self.modal.word("R", "R0"), "FMAX")

    def _linear(self, block: Linear) -> Iterator[str]:
        words = self._coordinates(block.end)
        yield from self._line("L", *words, self.modal.word("R", "R0"), self._rate(block.rate))

    def _circular(self, block: Circular) -> Iterator[str]:
        first, second, normal = block.arc.plane.axes
        if self._helix_end is not None:
            # A helix ends by its angle, nearly at its end: a full circle needs the exact point.
            yield from self._linear(Linear(end=self._helix_end, rate=block.rate))
        rise = block.end[normal] - (self.at[normal] or 0.0)
        centre = [f"{'XYZ'[i]}{_signed(block.arc.centre[i])}" for i in sorted((first, second))]
        yield from self._line("CC", *centre)
        sense = "DR+" if block.arc.turn > 0.0 else "DR-"
        rate = self._rate(block.rate)
        is_helix = abs(rise) > 0.0 or abs(block.arc.turn) > FULL + 1e-6
        if is_helix and block.arc.plane is not ArcPlane.XY:
            raise PostError(
                f"a helix in the plane {block.arc.plane}: Klartext supports helices in XY only"
            )
        self.at = list(block.end)
        if is_helix:
            angle = f"IPA{_signed(deg_from_rad(block.arc.turn), ANGLE_PLACES)}"
            yield from self._line("CP", angle, f"IZ{_signed(rise)}", sense, rate)
            self.at, self._helix_end = [None, None, block.end[2]], block.end
            return
        ends = [f"{'XYZ'[i]}{_signed(block.end[i])}" for i in sorted((first, second))]
        yield from self._line("C", *ends, sense, rate)

    def _rigid_tap(self, block: RigidTap) -> Iterator[str]:
        yield from self._rapid(Rapid(end=block.start))
        yield from self._speed(block.speed)
        top, sign = block.start[2], 1.0 if block.sense is SpindleDirection.CLOCKWISE else -1.0
        yield from self._definition(
            "207",
            [
                ("Q200", 0.0, "SET-UP CLEARANCE"),
                ("Q201", block.bottom_z - top, "DEPTH"),
                ("Q239", sign * block.lead, "PITCH"),
                ("Q203", top, "SURFACE COORDINATE"),
                ("Q204", 0.0, "2ND SET-UP CLEARANCE"),
            ],
        )
        yield from self._line("CYCL CALL")

    def _drilling_cycle(self, block: DrillingCycle) -> Iterator[str]:
        yield from self._rapid(Rapid(end=(*block.at, block.retract_z)))
        yield from self._definition(*_cycle(block))
        yield from self._line("CYCL CALL")

    def _definition(
        self, number: str, parameters: list[tuple[str, float, str]]
    ) -> Iterator[str]:
        """Write a cycle definition over several lines, if it is new."""
        lines = [f"  {name}={_signed(value, 4)} ;{title}" for name, value, title in parameters]
        text = " ~\n".join([f"CYCL DEF {number} {TITLES[number]}", *lines])
        if self.modal.word("cycle", text):
            head, *rest = text.split("\n")
            yield from self._line(head)
            yield from rest

    def _coordinates(self, end: Point) -> list[str]:
        """Coordinate words of the axes that move."""
        words = [
            f"{letter}{_signed(value)}"
            for letter, value, old in zip("XYZ", end, self.at, strict=True)
            if value != old
        ]
        self.at, self._helix_end = list(end), None
        return words

    def _rate(self, rate: Rate) -> str:
        """F word in mm/min or FU word in mm per revolution, if it changes."""
        if rate.mode is RateMode.PER_MINUTE:
            text = f"F{decimal(mm_min_from_speed(rate.value), 3)}"
        else:
            text = f"FU{decimal(rate.value, 4)}"
        if float(text.lstrip("FU")) <= 0.0:
            raise PostError(f"feed {rate.value:g} ({rate.mode}): too small for an F word")
        return self.modal.word("F", text)


def _keeps(cycle: DrillingCycle) -> bool:
    """True if Klartext has a drilling cycle; its feed is per minute."""
    return (
        cycle.kind in KEPT
        and (not cycle.dwell or cycle.kind in DWELLING)
        and cycle.rate.mode is RateMode.PER_MINUTE
    )


def _cycle(block: DrillingCycle) -> tuple[str, list[tuple[str, float, str]]]:
    """Number and parameters of a drilling cycle."""
    depth = block.bottom_z - block.retract_z
    clearance = ("Q200", 0.0, "SET-UP CLEARANCE")
    down = ("Q201", depth, "DEPTH")
    feed = ("Q206", mm_min_from_speed(block.rate.value), "FEED RATE FOR PLNGNG")
    dwell = ("Q211", block.dwell, "DWELL TIME AT DEPTH")
    surface = ("Q203", block.retract_z, "SURFACE COORDINATE")
    second = ("Q204", 0.0, "2ND SET-UP CLEARANCE")
    if block.kind is CycleKind.BORE:
        # A retraction feed of 0 means the reaming feed.
        out = ("Q208", 0.0, "RETRACTION FEED RATE")
        return "201", [clearance, down, feed, dwell, out, surface, second]
    if block.kind in {CycleKind.DRILL, CycleKind.DWELL}:
        plunge = ("Q202", -depth, "PLUNGING DEPTH")
        top = ("Q210", 0.0, "DWELL TIME AT TOP")
        return "200", [clearance, down, feed, plunge, top, surface, second, dwell]
    is_peck = block.kind is CycleKind.PECK
    above = block.retract_distance if is_peck else 0.0
    return "205", [
        clearance,
        down,
        feed,
        ("Q202", block.step_depth if is_peck else -depth, "PLUNGING DEPTH"),
        surface,
        second,
        ("Q212", 0.0, "DECREMENT"),
        ("Q205", 0.0, "MIN. PLUNGING DEPTH"),
        ("Q258", above, "UPPER ADV STOP DIST"),
        ("Q259", above, "LOWER ADV STOP DIST"),
        ("Q257", 0.0 if is_peck else block.step_depth, "DEPTH FOR CHIP BRKNG"),
        ("Q256", 0.0 if is_peck else block.retract_distance, "DIST FOR CHIP BRKNG"),
        dwell,
    ]


def _shaped(blocks: Iterable[Block]) -> Iterator[Block]:
    """Split flat arcs into single turns; helices stay unchanged."""
    at: Point = (0.0, 0.0, 0.0)
    for block in blocks:
        if (
            isinstance(block, Circular)
            and block.end[block.arc.plane.axes[2]] == (at[block.arc.plane.axes[2]])
        ):
            yield from turns(at, block)
        else:
            yield block
        at = end_of(block, at)


def _signed(value: float, places: int = PLACES) -> str:
    """Format a number with its sign, as in Klartext."""
    text = decimal(value, places)
    return text if text.startswith("-") else f"+{text}"
