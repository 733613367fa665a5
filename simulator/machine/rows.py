"""Rows of a stretch while it is collected. Running state."""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, cos, inf, nan, sin

import numpy as np

from simulator.machine.acts import Stretch
from simulator.motion.segments import Segments
from stepnc_model.post.blocks import Circular
from stepnc_model.toolpath.path import Arc, Point, radius


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """How fast a piece is run."""

    speed: float
    """mm/s along the path, while the spindle has its speed; infinite: rapid"""
    spindle: float = nan
    """rev/s at the end; NaN: it keeps its speed"""
    per_revolution: float = nan
    """mm; NaN: a feed by time"""


Paces = Callable[[float, float], Pace]
"""pace for x in the middle and at the end of a piece"""


class Rows:
    """Lines and arcs that wait to become a stretch."""

    def __init__(self) -> None:
        self._points: list[tuple[Point, Point, Point]] = []
        self._numbers: list[tuple[float, int, int, float, float, float]] = []
        self._way, self._back = 0, 0

    def __len__(self) -> int:
        return len(self._points)

    def line(
        self,
        start: Point,
        end: Point,
        *,
        pace: Pace,
        line: int,
        is_way: bool = False,
    ) -> None:
        """One line, rapid when its speed is infinite."""
        leads = is_way and self._way == len(self._points)
        self._way += leads
        self._back = self._back + 1 if is_way and not leads else 0
        self._add((start, end, start), pace, turn=0.0, normal=2, line=line)

    def arc(
        self, start: Point, block: Circular, *, pieces: int, paces: Paces, line: int
    ) -> None:
        """One arc or helix in pieces."""
        first, second, normal = block.plane.axes
        size = radius(start, Arc(centre=block.centre, turn=block.turn, plane=block.plane))
        angle = atan2(start[second] - block.centre[second], start[first] - block.centre[first])
        rise = block.end[normal] - start[normal]

        def at(part: float) -> Point:
            point = [0.0, 0.0, 0.0]
            point[first] = block.centre[first] + size * cos(angle + part * block.turn)
            point[second] = block.centre[second] + size * sin(angle + part * block.turn)
            point[normal] = start[normal] + part * rise
            return point[0], point[1], point[2]

        here, self._back = start, 0
        for index in range(1, pieces + 1):
            there = block.end if index == pieces else at(index / pieces)
            pace = paces(at((index - 0.5) / pieces)[0], there[0])
            points = here, there, block.centre
            self._add(points, pace, turn=block.turn / pieces, normal=normal, line=line)
            here = there

    def _add(
        self,
        points: tuple[Point, Point, Point],
        pace: Pace,
        *,
        turn: float,
        normal: int,
        line: int,
    ) -> None:
        self._points.append(points)
        per_time = (pace.speed, pace.spindle, pace.per_revolution)
        self._numbers.append((turn, normal, line, *per_time))

    def taken(self) -> Stretch:
        """The stretch; the rows are empty afterwards."""
        points = np.array(self._points)
        turn, normal, line, speed, spindle, per_revolution = np.array(self._numbers).T
        way, back = self._way, self._back
        self._points, self._numbers, self._way, self._back = [], [], 0, 0
        segments = Segments(
            start=points[:, 0],
            end=points[:, 1],
            speed=speed,
            is_rapid=speed == inf,
            centre=points[:, 2],
            turn=turn,
            normal=normal.astype(np.int64),
            block=line.astype(np.int64),
        )
        return Stretch(
            segments=segments,
            spindle_speed=spindle,
            per_revolution=per_revolution,
            way=way,
            back=back,
        )
