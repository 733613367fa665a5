"""Rows of a stretch while it is collected. Running state."""

from collections.abc import Callable
from math import atan2, cos, inf, nan, sin

import numpy as np

from simulator.machine.acts import Stretch
from simulator.motion.segments import Segments
from stepnc_model.post.blocks import Circular
from stepnc_model.toolpath.path import Arc, Point, radius

Speeds = Callable[[float, float], tuple[float, float]]
"""speed along the path and of the spindle, for x in the middle and at the end of a piece"""


class Rows:
    """Lines and arcs that wait to become a stretch."""

    def __init__(self) -> None:
        self._points: list[tuple[Point, Point, Point]] = []
        self._numbers: list[tuple[float, float, int, int, float]] = []
        self._way, self._back = 0, 0

    def __len__(self) -> int:
        return len(self._points)

    def line(
        self,
        start: Point,
        end: Point,
        *,
        speed: float,
        line: int,
        spindle: float = nan,
        is_way: bool = False,
    ) -> None:
        """One line, rapid when its speed is infinite."""
        leads = is_way and self._way == len(self._points)
        self._way += leads
        self._back = self._back + 1 if is_way and not leads else 0
        self._points.append((start, end, start))
        self._numbers.append((speed, 0.0, 2, line, spindle))

    def arc(
        self, start: Point, block: Circular, *, pieces: int, speeds: Speeds, line: int
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
            speed, spindle = speeds(at((index - 0.5) / pieces)[0], there[0])
            self._points.append((here, there, block.centre))
            self._numbers.append((speed, block.turn / pieces, normal, line, spindle))
            here = there

    def taken(self) -> Stretch:
        """The stretch; the rows are empty afterwards."""
        points = np.array(self._points)
        speed, turn, normal, line, spindle = np.array(self._numbers).T
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
        return Stretch(segments=segments, spindle_speed=spindle, way=way, back=back)
