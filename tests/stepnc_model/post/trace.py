"""What canonical commands come to: each motion with all that holds while it runs.

Two lists mean the same when their traces do, whatever the order in which feeds, speeds and
planes were said, and however often.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import zip_longest
from math import dist, pi

from stepnc_model.post.blocks import Circular, Rate
from stepnc_model.post.canonical import PLANES, Canonical
from stepnc_model.post.grid import turns
from stepnc_model.toolpath.arc import point_at, swept
from stepnc_model.toolpath.path import Arc, ArcPlane, Point

LENGTH = 1e-3
"""mm, the last digit of most controls"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TracedEvent:
    """One motion, or one thing done between motions."""

    kind: str
    numbers: tuple[float, ...] = ()
    """mm: end, then the middle of an arc, which short arcs of large radius have better defined
    than a centre; of a thread also its lead; s of a dwell"""
    state: tuple[str | None, ...] = ()
    """mode of the feed, sense of the spindle, coolant, plane and sense of an arc"""
    speeds: tuple[float, ...] = ()
    """feed in mm/min or mm/rev, spindle in rpm or m/min, limit in rpm"""


def trace(commands: Iterable[Canonical]) -> tuple[TracedEvent, ...]:
    """The events of canonical commands; a line below the last digit of a control is none."""
    return tuple(_Tracer(0.5 * LENGTH).events(commands))


def difference(
    one: Iterable[Canonical],
    other: Iterable[Canonical],
    *,
    length: float = LENGTH,
    speed: float = 1e-3,
) -> str:
    """Where two lists part, in words; empty where they never do.

    Parameters
    ----------
    one, other : iterable of Canonical
    length : float, mm
        By which coordinates may differ, and the longest line that is none; also s, for dwells.
    speed : float
        By which feeds (mm/min, mm/rev) and speeds (rpm, m/min) may differ.
    """
    pairs = zip_longest(_Tracer(length).events(one), _Tracer(length).events(other))
    for index, (a, b) in enumerate(pairs):
        if a is None or b is None:
            return f"event {index}: {a} against {b}"
        if (
            (a.kind, a.state) != (b.kind, b.state)
            or not _are_near(a.numbers, b.numbers, length)
            or not _are_near(a.speeds, b.speeds, speed)
        ):
            return f"event {index}: {a} against {b}"
    return ""


def _are_near(one: tuple[float, ...], other: tuple[float, ...], tolerance: float) -> bool:
    # A float of twelve digits is as good as its text: limits of 1e30 rpm are printed in full.
    return len(one) == len(other) and all(
        abs(a - b) <= max(tolerance, 1e-12 * abs(a)) for a, b in zip(one, other, strict=True)
    )


class _Tracer:
    """Running state of a control, as far as canonical commands tell it."""

    def __init__(self, least: float) -> None:
        self.least = least
        self.at: Point = (0.0, 0.0, 0.0)
        self.plane = ArcPlane.XY
        self.feed = 0.0
        self.mode = 0.0
        self.speed = 0.0
        self.limit = 0.0
        self.sense: str | None = None
        self.coolant: set[str] = set()
        self.lead: float | None = None

    def events(self, commands: Iterable[Canonical]) -> Iterator[TracedEvent]:
        """Events, in order."""
        for command in commands:
            yield from self._step(command)

    def _step(self, command: Canonical) -> Iterator[TracedEvent]:
        name = command.name
        numbers = tuple(v for v in command.arguments if not isinstance(v, str))
        match name:
            case "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED":
                yield from self._line(name, (numbers[0], numbers[1], numbers[2]))
            case "ARC_FEED":
                yield from self._arc(numbers)
            case "RIGID_TAP":
                yield self._cutting("tap", (*numbers, self.lead or 0.0))
            case "DWELL":
                if numbers[0] > 0.0:
                    yield TracedEvent(kind="dwell", numbers=numbers)
            case "CHANGE_TOOL":
                self.sense = None
                yield TracedEvent(kind="tool", state=(str(command.arguments[0]),))
            case "PROGRAM_STOP" | "OPTIONAL_PROGRAM_STOP" | "PROGRAM_END":
                yield TracedEvent(kind=name.lower())
            case _:
                self._set(command, numbers)

    def _set(self, command: Canonical, numbers: tuple[float, ...]) -> None:
        """Take in what holds from here."""
        match command.name:
            case "SET_FEED_RATE":
                self.feed = numbers[0]
            case "SET_FEED_MODE":
                self.mode = numbers[0]
            case "SET_SPINDLE_SPEED":
                self.speed = numbers[0]
            case "SET_SPINDLE_MODE":
                self.limit = numbers[0]
            case "START_SPEED_FEED_SYNC":
                self.lead = numbers[0]
            case "STOP_SPEED_FEED_SYNCH":
                self.lead = None
            case "SELECT_PLANE":
                self.plane = next(p for p, n in PLANES.items() if n == command.arguments[0])
            case "START_SPINDLE_CLOCKWISE" | "START_SPINDLE_COUNTERCLOCKWISE":
                self.sense = command.name.removeprefix("START_SPINDLE_")
            case "STOP_SPINDLE_TURNING":
                self.sense = None
            case "FLOOD_ON" | "MIST_ON":
                self.coolant.add(command.name.removesuffix("_ON"))
            case "FLOOD_OFF" | "MIST_OFF":
                self.coolant.discard(command.name.removesuffix("_OFF"))

    def _line(self, name: str, end: Point) -> Iterator[TracedEvent]:
        length, self.at = dist(self.at, end), end
        if length > self.least:
            if name == "STRAIGHT_TRAVERSE":
                yield TracedEvent(kind="traverse", numbers=end)
            elif self.lead is not None:
                yield self._cutting("thread", (*end, self.lead))
            else:
                yield self._cutting("feed", end)

    def _arc(self, numbers: tuple[float, ...]) -> Iterator[TracedEvent]:
        first, second, normal = self.plane.axes
        point, centre = [0.0, 0.0, 0.0], list(self.at)
        point[first], point[second], centre[first], centre[second] = numbers[:4]
        point[normal] = numbers[5]
        end, middle = (point[0], point[1], point[2]), (centre[0], centre[1], centre[2])
        sense = 1.0 if numbers[4] > 0.0 else -1.0
        angle = swept(self.at, end, middle, self.plane, sense=sense)
        turn = sense * (angle + 2.0 * pi * (abs(numbers[4]) - 1.0))
        arc = Circular(
            end=end, arc=Arc(centre=middle, turn=turn, plane=self.plane), rate=Rate(value=0.0)
        )
        for single in turns(self.at, arc):
            middle = point_at(self.at, single, 0.5)
            self.at = single.end
            words = (self.plane.value, "CCW" if sense > 0.0 else "CW")
            yield self._cutting("arc", (*single.end, *middle), *words)

    def _cutting(self, kind: str, numbers: tuple[float, ...], *words: str) -> TracedEvent:
        """An event with feed, spindle and coolant."""
        is_bound = kind in {"thread", "tap"}
        turning = (self.speed, self.limit) if self.sense is not None else ()
        return TracedEvent(
            kind=kind,
            numbers=numbers,
            state=(
                None if is_bound else f"{self.mode:g}",
                self.sense,
                "+".join(sorted(self.coolant)),
                *words,
            ),
            speeds=turning if is_bound else (self.feed, *turning),
        )
