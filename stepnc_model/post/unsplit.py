"""Moves that differ only in whether they touch material, as one: a control need not know."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import dist

from stepnc_model.toolpath.path import Move, MoveType, Point, Step

STRAIGHT = 1e-9
"""mm by which two lines may be longer than the one from end to end"""

INTERPOLATED = {MoveType.CONTACT, MoveType.NO_CONTACT}


def unsplit(start: Point, steps: Sequence[Step]) -> Iterator[Step]:
    """Steps with the cuts between contact and air taken out."""
    held: Move | None = None
    for step in steps:
        if held is not None:
            joined = _joined(start, held, step) if isinstance(step, Move) else None
            if joined is not None:
                held = joined
                continue
            yield held
            start = held.end
            held = None
        if isinstance(step, Move):
            held = step
        else:
            yield step
    if held is not None:
        yield held


def _joined(start: Point, one: Move, other: Move) -> Move | None:
    """Both as one move, or None where they are two."""
    if one.type is other.type or {one.type, other.type} != INTERPOLATED:
        return None
    if one.feed != other.feed:
        return None
    if one.arc is None and other.arc is None:
        way = dist(start, one.end) + dist(one.end, other.end)
        return other if way - dist(start, other.end) <= STRAIGHT else None
    if one.arc is None or other.arc is None or one.arc.plane is not other.arc.plane:
        return None
    first, second, normal = one.arc.plane.axes
    is_one_circle = all(
        abs(one.arc.centre[axis] - other.arc.centre[axis]) <= STRAIGHT
        for axis in (first, second)
    )
    is_flat = start[normal] == one.end[normal] == other.end[normal]
    turns = one.arc.turn, other.arc.turn
    if not is_one_circle or not is_flat or turns[0] * turns[1] <= 0.0:
        return None
    return replace(other, arc=replace(other.arc, turn=sum(turns)))
