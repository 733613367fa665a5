"""Common part of the G-code writers: modal ISO 6983 words in a fixed order.

A dialect derives from :class:`IsoCode` and overrides what differs.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import ClassVar

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
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
from stepnc_model.post.grid import flat, merged, on_grid, single_turns
from stepnc_model.post.words import Modal, decimal
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import m_min_from_speed, mm_min_from_speed, rpm_from_rev_s

PLANE_CODES = {ArcPlane.XY: "G17", ArcPlane.ZX: "G18", ArcPlane.YZ: "G19"}
SENSE_CODES = {SpindleDirection.CLOCKWISE: "M3", SpindleDirection.COUNTERCLOCKWISE: "M4"}
RATE_PLACES = {RateMode.PER_MINUTE: 3, RateMode.PER_REVOLUTION: 4}


class IsoCode(ABC):
    """Writer of one G-code program; tracks the modal state and the position of the tool."""

    places: ClassVar[int] = 3
    """Decimal places of a coordinate."""
    speed_places: ClassVar[int] = 0
    """Decimal places of an S word."""
    last_number: ClassVar[int] = 99999
    """Greatest block number; later blocks have none."""
    coolant_codes: Mapping[CoolantKind, str] = {
        CoolantKind.FLOOD: "M8",
        CoolantKind.MIST: "M7",
        CoolantKind.THROUGH: "M8",
    }
    cycle_codes: ClassVar[Mapping[CycleKind, str]] = {
        CycleKind.DRILL: "G81",
        CycleKind.DWELL: "G82",
        CycleKind.PECK: "G83",
        CycleKind.CHIP_BREAK: "G73",
        CycleKind.BORE: "G85",
        CycleKind.BORE_STOP: "G86",
    }
    exact_codes: ClassVar[tuple[str, ...]] = ()
    """Codes of exact stops and of the control's own rounding of corners; empty: none."""
    dwelling: ClassVar[frozenset[CycleKind]] = frozenset({CycleKind.DWELL})
    """Cycles that dwell at the bottom."""

    def __init__(self) -> None:
        self.modal = Modal()
        self.machine = MachineType.MILL
        self.at: list[float | None] = [None, None, None]
        self.is_surface_speed = False
        self.cooling: set[str] = set()
        self._number = 0
        self._pending = ""
        self._cycle: tuple[object, ...] = ()
        self._makers: dict[type, Callable[..., Iterator[str]]] = {
            ProgramStart: self._start,
            ProgramEnd: self.end,
            Comment: self.comment,
            PathControl: self.path_mode,
            Message: self.message,
            ToolChange: self.tool_change,
            SpindleOn: self.spindle_on,
            SurfaceSpeed: self._surface_speed,
            SpindleOff: lambda _: self.line("M5"),
            SpindleOrient: self.orient,
            Coolant: self.coolant,
            Retract: self._retract,
            Rapid: self.rapid,
            Linear: self._linear,
            Circular: self._circular,
            ThreadingMove: self._threading,
            RigidTap: self._rigid_tap,
            Pause: self.pause,
            ProgramStopBlock: lambda _: self.line("M0"),
            OptionalStopBlock: lambda _: self.line("M1"),
            DrillingCycle: self.drilling_cycle,
        }

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """Lines of the G-code program."""
        kept = self.keeps if cycles is Cycles.OWN else None
        shaped = self.shaped(flat(blocks, kept))
        for block in merged(on_grid(shaped, self.places)):
            if self._cycle and not isinstance(block, DrillingCycle):
                self._cycle = ()
                yield from self.line("G80")
            yield from self._makers[type(block)](block)

    # Methods that dialects override.

    def number(self, value: float, places: int) -> str:
        """Format a number as the control expects it."""
        return decimal(value, places)

    def shaped(self, blocks: Iterable[Block]) -> Iterator[Block]:
        """Adapt arcs to what the control supports."""
        return single_turns(blocks)

    def keeps(self, cycle: DrillingCycle) -> bool:
        """True if the control has its own cycle for this one."""
        return (
            self.machine is MachineType.MILL
            and cycle.kind in self.cycle_codes
            and (not cycle.dwell or cycle.kind in self.dwelling)
        )

    @abstractmethod
    def start(self, name: str) -> Iterator[str]:
        """Write the head of the NC program."""

    @abstractmethod
    def end(self, _: ProgramEnd) -> Iterator[str]:
        """Write the end of the NC program."""

    @abstractmethod
    def text(self, text: str) -> str:
        """Format a comment with the delimiters of the control."""

    @abstractmethod
    def tool_change(self, block: ToolChange) -> Iterator[str]:
        """Write a tool change and the length offset."""

    def mode_code(self, mode: RateMode) -> str:
        """G code of a feed mode, per minute or per revolution."""
        return "G94" if mode is RateMode.PER_MINUTE else "G95"

    @abstractmethod
    def surface_speed(self, speed: str, limit: str, sense: str) -> Iterator[str]:
        """Write a constant surface speed in m/min, with an optional limit in rpm."""

    @abstractmethod
    def thread_words(self, start: Point, block: ThreadingMove) -> list[str]:
        """Motion code and lead of a synchronised move."""

    @abstractmethod
    def rigid_tap(self, block: RigidTap) -> Iterator[str]:
        """Write a rigid tap at the current position."""

    def seconds(self, value: float) -> str:
        """Dwell time as a word, with its address letter."""
        return f"P{self.number(value, 3)}"

    def turn_words(self, block: Circular) -> list[str]:
        """Words for the number of turns of an arc."""
        return []

    # Methods that all dialects share.

    def line(self, *words: str) -> Iterator[str]:
        """Write one numbered line of the words that are not empty."""
        kept = [word for word in words if word]
        if kept:
            self._number += 10
            if self._number <= self.last_number:
                kept.insert(0, f"N{self._number}")
            yield " ".join(kept)

    def comment(self, block: Comment) -> Iterator[str]:
        """Write a comment on a separate line."""
        yield self.text(block.text)

    def path_mode(self, block: PathControl) -> Iterator[str]:
        """Write exact stops; where corners are rounded, the control knows how far."""
        if self.exact_codes and block.tolerance == 0.0:
            yield from self.line(self.modal.word("path", self.exact_codes[0]))

    def inexact(self) -> Iterator[str]:
        """End exact stops: the next program may rely on the control's own mode."""
        if self.exact_codes and not self.modal.word("path", self.exact_codes[0]):
            yield from self.line(self.exact_codes[1])

    def message(self, block: Message) -> Iterator[str]:
        """Write a message as a comment; not all controls show text without stopping."""
        yield self.text(block.text)

    def spindle_on(self, block: SpindleOn) -> Iterator[str]:
        """Switch the spindle on at constant speed."""
        code = "G97" if self.is_surface_speed else ""
        self.is_surface_speed = False
        yield from self.line(code, self.speed(block.speed), SENSE_CODES[block.sense])

    def speed(self, speed: float) -> str:
        """Spindle speed as an S word in rpm."""
        return f"S{decimal(rpm_from_rev_s(speed), self.speed_places)}"

    def orient(self, _: SpindleOrient) -> Iterator[str]:
        """Orient the spindle at angle 0."""
        return self.line("M19")

    def coolant(self, block: Coolant) -> Iterator[str]:
        """Switch coolant: off as a whole if any kind ends, then on as needed."""
        codes = {self.coolant_codes[kind]: None for kind in sorted(block.kinds)}
        if not self.cooling <= set(codes):
            yield from self.coolant_off()
        for code in codes:
            if code not in self.cooling:
                yield from self.line(code)
                self.cooling.add(code)

    def coolant_off(self) -> Iterator[str]:
        """Switch all coolant off."""
        self.cooling.clear()
        return self.line("M9")

    def rapid(self, block: Rapid) -> Iterator[str]:
        """Write a straight rapid move."""
        words = self.coordinates(block.end)
        if words:
            yield from self.line(self.modal.word("motion", "G0"), *self._offset(), *words)

    def pause(self, block: Pause) -> Iterator[str]:
        """Write a dwell block (G4)."""
        return self.line("G4", self.seconds(block.seconds))

    def drilling_cycle(self, block: DrillingCycle) -> Iterator[str]:
        """Write a canned cycle in full, or only its next position."""
        x, y = block.at
        words = [f"X{self.number(x, self.places)}", f"Y{self.number(y, self.places)}"]
        key = (
            block.kind,
            block.retract_z,
            block.bottom_z,
            block.rate,
            block.step_depth,
            block.dwell,
        )
        if key != self._cycle:
            # In another plane the cycle would drill along the normal of that plane.
            head = [self.plane_words(ArcPlane.XY), self.mode(block.rate.mode), "G99"]
            words = [*head, self.cycle_codes[block.kind], *words]
            words += [
                f"Z{self.number(block.bottom_z, self.places)}",
                f"R{self.number(block.retract_z, self.places)}",
            ]
            if block.kind in {CycleKind.PECK, CycleKind.CHIP_BREAK}:
                words.append(f"Q{self.number(block.step_depth, self.places)}")
            if block.kind in self.dwelling:
                words.append(self.seconds(block.dwell))
            words.append(self.rate(block.rate))
        self._cycle = key
        self.modal.forget("motion")
        self.at = [x, y, block.retract_z]
        yield from self.line(*words)

    def coordinates(self, end: Point) -> list[str]:
        """Words of the axes that move; X of a lathe is a diameter."""
        words: list[str] = []
        at = self.at
        if end[0] != at[0]:
            x = end[0] if self.machine is MachineType.MILL else 2.0 * end[0]
            words.append(f"X{self.number(x, self.places)}")
        if end[1] != at[1] and self.machine is MachineType.MILL:
            words.append(f"Y{self.number(end[1], self.places)}")
        elif end[1] and self.machine is MachineType.LATHE:
            raise PostError(f"y = {end[1]:g} mm: a lathe has no y axis")
        if end[2] != at[2]:
            words.append(f"Z{self.number(end[2], self.places)}")
        self.at = list(end)
        return words

    def mode(self, mode: RateMode) -> str:
        """G code of a feed mode, if the mode changes."""
        word = self.modal.word("mode", self.mode_code(mode))
        if word:
            self.modal.forget("F")
        return word

    def rate(self, rate: Rate) -> str:
        """Feed as an F word, if it changes."""
        return self.modal.word("F", f"F{self.rate_text(rate)}")

    def rate_text(self, rate: Rate) -> str:
        """Feed as text, in mm/min or mm per revolution."""
        is_per_minute = rate.mode is RateMode.PER_MINUTE
        value = mm_min_from_speed(rate.value) if is_per_minute else rate.value
        text = self.number(value, RATE_PLACES[rate.mode])
        if float(text) <= 0.0:
            raise PostError(f"feed {value:g} ({rate.mode}): too small for an F word")
        return text

    def _start(self, block: ProgramStart) -> Iterator[str]:
        self.machine = block.machine
        return self.start(block.name)

    def plane_words(self, plane: ArcPlane) -> str:
        """G code of an arc plane, if it changes."""
        return self.modal.word("plane", PLANE_CODES[plane])

    def pend(self, words: str) -> None:
        """Keep words for the next rapid along z, as needed for length offsets."""
        self._pending = words
        self.at = [None, None, None]
        self.modal.forget("motion", "F")

    def _offset(self) -> list[str]:
        pending, self._pending = self._pending, ""
        return [pending]

    def _surface_speed(self, block: SurfaceSpeed) -> Iterator[str]:
        if self.machine is MachineType.MILL:
            raise PostError("constant surface speed: not supported on a milling machine")
        limit = ""
        if block.limit is not None:
            limit = decimal(rpm_from_rev_s(block.limit), self.speed_places)
        speed = decimal(m_min_from_speed(block.speed), self.speed_places)
        self.is_surface_speed = True
        return self.surface_speed(speed, limit, SENSE_CODES[block.sense])

    def _retract(self, block: Retract) -> Iterator[str]:
        if block.z != self.at[2]:
            self.at[2] = block.z
            z = f"Z{self.number(block.z, self.places)}"
            yield from self.line(self.modal.word("motion", "G0"), *self._offset(), z)

    def _linear(self, block: Linear) -> Iterator[str]:
        mode = self.mode(block.rate.mode)
        words = self.coordinates(block.end)
        motion = self.modal.word("motion", "G1")
        yield from self.line(mode, motion, *words, self.rate(block.rate))

    def _circular(self, block: Circular) -> Iterator[str]:
        start = self.at
        first, second, _ = block.arc.plane.axes
        offsets = [0.0, 0.0]
        for place, axis in enumerate((first, second)):
            from_ = start[axis]
            if from_ is None:
                raise PostError("an arc from an unknown position")
            offsets[place] = block.arc.centre[axis] - from_
        plane = self.plane_words(block.arc.plane)
        mode = self.mode(block.rate.mode)
        # A full circle moves no axis: always write both axes of the plane.
        self.at = [None if i in {first, second} else v for i, v in enumerate(start)]
        words = self.coordinates(block.end)
        centre = [
            f"{'IJK'[axis]}{self.number(offset, self.places)}"
            for axis, offset in sorted(zip((first, second), offsets, strict=True))
        ]
        motion = self.modal.word("motion", "G3" if block.arc.turn > 0.0 else "G2")
        turn = self.turn_words(block)
        yield from self.line(plane, mode, motion, *words, *centre, *turn, self.rate(block.rate))

    def _threading(self, block: ThreadingMove) -> Iterator[str]:
        start = self.known()
        head, *lead = self.thread_words(start, block)
        words = self.coordinates(block.end)
        # Some controls take the lead as the feed: write both again.
        self.modal.forget("motion", "F")
        yield from self.line(head, *words, *lead)

    def _rigid_tap(self, block: RigidTap) -> Iterator[str]:
        yield from self.rapid(Rapid(end=block.start))
        if self.machine is MachineType.MILL:
            yield from self.line(self.plane_words(ArcPlane.XY))
        yield from self.rigid_tap(block)
        self.modal.forget("motion", "F")

    def known(self) -> Point:
        """Position of the tool, which must be known."""
        x, y, z = self.at
        if x is None or y is None or z is None:
            raise PostError("a cut from an unknown position")
        return x, y, z
