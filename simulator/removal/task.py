"""What marches through what: stock, tool, path and the room to work in, as kernels take them.

Units mm and rad.
"""

from typing import NamedTuple

import numpy as np

from simulator.motion.segments import Floats, Segments
from simulator.removal.profile import Profile, is_upright
from simulator.removal.rim import ENGAGEMENT, Past
from simulator.removal.ring import ROUND_SAMPLES, SAMPLES, Room, Tool, room_for
from simulator.removal.zmap import Grid

DEEPEST = 12
"""halvings of a stretch"""


class March(NamedTuple):
    """How to march."""

    step: float
    """mm, longest stretch between two stations"""
    least: float
    """mm, shortest stretch"""
    shank: float
    """mm above the tip where the cutting edge ends; infinite: never"""
    coarse: float
    """mm over which the map's own rim tells more than noise"""
    shape: Floats
    """(7,) numbers of the tool's profile"""
    neck: Profile
    """of the shank above the edge"""
    holder: Profile
    overhang: float
    """mm above the tip where the holder begins; infinite: there is none"""
    tip_sine: float
    """sine of half the point angle"""


class Desk(NamedTuple):
    """Room for the work along a part of a row."""

    rim: Room
    parts: Floats
    """(DEEPEST,) shares of the row, of stretches that wait"""
    seen: Floats
    """(DEEPEST, ENGAGEMENT) engagement there"""
    left: Floats
    """(ENGAGEMENT,) engagement where the stretch begins"""
    raised: Floats
    """(13,) row of the shank or the holder"""


class Task(NamedTuple):
    """What cuts what, and how."""

    grid: Grid
    past: Past
    tool: Tool
    how: March
    desk: Desk


def desk_for(tool: Tool) -> Desk:
    """Room for the work of a tool."""
    samples = SAMPLES if is_upright(tool.profile) else ROUND_SAMPLES
    return Desk(
        room_for(samples),
        np.empty(DEEPEST),
        np.empty((DEEPEST, ENGAGEMENT)),
        np.empty(ENGAGEMENT),
        np.empty(13),
    )


def rows_of(segments: Segments) -> Floats:
    """(N, 13) start, end, centre, radius, angle of the first arm, turn, normal."""
    rows = np.arange(len(segments))
    first = (segments.normal + 1) % 3
    second = (segments.normal + 2) % 3
    arm = segments.start - segments.centre
    angle = np.arctan2(arm[rows, second], arm[rows, first])
    columns = (segments.start, segments.end, segments.centre)
    numbers = (segments.radius, angle, segments.turn, segments.normal.astype(np.float64))
    return np.ascontiguousarray(np.column_stack([*columns, *numbers]))
