"""Joints between moves of LinuxCNC's planner: how fast, and on which curve, they are passed.

Units mm, s, rad. References are in :mod:`simulator.motion.linuxcnc_planner`.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.path_limits import corners, goes_on
from simulator.motion.segments import AxisLimits, Bools, Floats, Ints, Segments
from stepnc_model.post.blocks import PathControl

KINK = 0.1
"""Share of the acceleration that passing a corner without a blend may take."""

CENTRIPETAL = float(np.sqrt(0.75))
"""Share of the acceleration that a blend uses across the path."""

ALONG = 0.5
"""Share of the acceleration that is left along a blend."""

REVERSAL = np.radians(2.0)
"""Angle between opposite directions below which the path stops, rad."""

LEAST_PERIODS = 1.02
"""Servo periods that a move takes, at least."""

LEAST_SHARE = 1e-12
"""Square of the share of an axis in a plane below which it counts as beside it."""

FLAT = 1e-6
"""Share of a direction out of the plane of an arc above which there is no blend with it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MovePlan:
    """Limits of K moves by themselves."""

    moves: Segments
    limits: AxisLimits
    wanted: Floats
    """Commanded speed F, (K,), mm/s; for rapids the greatest."""
    planned: Floats
    """Speed for which joints are planned, (K,), mm/s: with the greatest feed override."""
    fastest: Floats
    """Greatest speed, (K,), mm/s."""
    acceleration: Floats
    """Greatest acceleration, (K,), mm/s²."""
    along: Floats
    """Share of it that is left along the path, (K,); less than 1 on arcs."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Joints:
    """Speeds and blends at the K − 1 joints between K moves."""

    moves: Segments
    speed: Floats
    """Greatest speed at the joint, or on its blend, (K−1,), mm/s."""
    length: Floats
    """Length of the blend, (K−1,), mm; 0 without one."""
    acceleration: Floats
    """Acceleration along the blend, (K−1,), mm/s²."""
    trim: Floats
    """Length that the blend takes from the end of one move and the start of the other,
    (K−1,), mm."""
    reduction: Floats
    """Share of the acceleration that the joints of each move take from it, (K,)."""
    is_halved: Bools
    """Whether a move overlaps with a neighbour and has half its acceleration, (K,)."""

    def blend(self, joint: Ints, part: Floats) -> tuple[Floats, Floats, Floats]:
        """Position, direction and curvature at a part of the way through blends, (M, 3) each.

        The curve is a cubic that begins and ends in the directions of the moves; it differs
        from the planner's arc by less than a thousandth of its radius.
        """
        moves = self.moves
        out = np.maximum(moves.length[joint] - self.trim[joint], 0.0)
        begin, into = moves.position(joint, out), moves.direction(joint, out)
        end = moves.position(joint + 1, self.trim[joint])
        leave = moves.direction(joint + 1, self.trim[joint])
        chord = np.linalg.norm(end - begin, axis=1)
        angle = np.arccos(np.clip(np.sum(into * leave, axis=1), -1.0, 1.0))
        # Handles of the cubic that is nearest to an arc of this angle and chord.
        handle = chord / (3.0 * np.cos(0.25 * angle) ** 2)
        one = begin + handle[:, None] * into
        two = end - handle[:, None] * leave
        t = part[:, None]
        position = (
            (1 - t) ** 3 * begin + 3 * (1 - t) ** 2 * t * one + 3 * (1 - t) * t**2 * two
            + t**3 * end
        )  # fmt: skip
        rate = 3 * (
            (1 - t) ** 2 * (one - begin) + 2 * (1 - t) * t * (two - one) + t**2 * (end - two)
        )
        change = 6 * ((1 - t) * (two - 2 * one + begin) + t * (end - 2 * two + one))
        size = np.linalg.norm(rate, axis=1)[:, None]
        direction = rate / np.where(size > 0.0, size, 1.0)
        across = change - np.sum(change * direction, axis=1)[:, None] * direction
        return position, direction, across / np.where(size > 0.0, size, 1.0) ** 2


def joints(plan: MovePlan, *, mode: PathControl, period: float) -> Joints:
    """Decide how each joint is passed.

    Parameters
    ----------
    period : float, s
        Servo period.
    """
    moves, count = plan.moves, len(plan.moves) - 1
    before, after = corners(moves)
    angle = np.arccos(np.clip(np.sum(before * after, axis=1), -1.0, 1.0))
    changes = moves.is_rapid[1:] != moves.is_rapid[:-1]
    is_stop = changes | (angle > np.pi - REVERSAL)
    if mode.is_exact_stop:
        is_stop |= ~goes_on(moves)
    kink, taken = _kinks(plan, before, after, period=period)
    is_corner = taken >= KINK
    length, along, trim = np.zeros(count), np.zeros(count), np.zeros(count)
    speed, is_overlap = kink.copy(), np.zeros(count, np.bool_)
    if mode.tolerance == 0.0:
        is_stop |= is_corner
        # Stops at corners keep the share that passing them would have taken.
        taken[changes | mode.is_exact_stop] = 0.0
    else:
        taken[is_stop] = 0.0
        rows = np.flatnonzero(is_corner & ~is_stop)
        corner = _Corners(
            rows=rows, before=before[rows], after=after[rows], angle=angle[rows],
            tolerance=mode.tolerance,
        )  # fmt: skip
        arc = _arcs(plan, corner, period=period)
        # Tried at corners of 12° to 168°: an arc is taken where there can be one.
        is_arc = (arc.speed > 0.0) & (arc.speed >= kink[rows])
        is_passed = ~is_arc & (0.5 * _overlap(plan, corner, plan.planned) > kink[rows])
        passed = _overlap(plan, corner, np.minimum(plan.wanted, plan.fastest))
        wanted = np.maximum(plan.wanted[rows], plan.wanted[rows + 1])
        speed[rows] = np.where(is_arc, np.minimum(arc.speed, wanted), speed[rows])
        speed[rows] = np.where(is_passed, passed, speed[rows])
        length[rows] = np.where(is_arc, arc.length, 0.0)
        along[rows] = np.where(is_arc, arc.acceleration, 0.0)
        trim[rows] = np.where(is_arc, arc.trim, 0.0)
        taken[rows] = np.where(is_arc | is_passed, 0.0, taken[rows])
        is_overlap[rows] = is_passed
    return Joints(
        moves=moves,
        speed=np.where(is_stop, 0.0, speed),
        length=length,
        acceleration=along,
        trim=trim,
        reduction=np.maximum(np.append(0.0, taken), np.append(taken, 0.0)),
        is_halved=np.append(False, is_overlap) | np.append(is_overlap, False),
    )


def _kinks(
    plan: MovePlan, before: Floats, after: Floats, *, period: float
) -> tuple[Floats, Floats]:
    """Speeds at which joints are passed without a blend, and shares of acceleration for it."""
    moves = plan.moves
    greatest = np.minimum(plan.planned[:-1], plan.planned[1:])
    is_arc = moves.turn != 0.0
    # The direction changes within one servo period, in which the next move speeds up.
    sudden = greatest / period + plan.acceleration[1:]
    share = (np.abs(after - before) / plan.limits.acceleration).max(axis=1) * sudden
    share *= np.where(is_arc[:-1] | is_arc[1:], 1.0 / ALONG, 1.0)
    share[goes_on(moves)] = 0.0
    return greatest * KINK / np.maximum(share, KINK), np.minimum(share, KINK)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Corners:
    """M corners that may be rounded."""

    rows: Ints
    """Moves before them, (M,)."""
    before: Floats
    """Directions before them, (M, 3)."""
    after: Floats
    angle: Floats
    """Angles by which the path turns, (M,), rad; greater than 0, less than π."""
    tolerance: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Arcs:
    """Arcs that would replace M corners; the speed is 0 where there can be none."""

    speed: Floats
    length: Floats
    trim: Floats
    acceleration: Floats


def _arcs(plan: MovePlan, corner: _Corners, *, period: float) -> _Arcs:
    """Widest arcs within the tolerance that the speed makes use of."""
    moves, limits, rows = plan.moves, plan.limits, corner.rows
    half = 0.5 * (np.pi - corner.angle)
    shorter = np.minimum(moves.length[rows], moves.length[rows + 1])
    allowed = np.minimum(corner.tolerance, 0.25 * shorter)
    # The second is cos θ/(1 − sin θ) without cancellation.
    space = np.minimum(0.5 * shorter, allowed * (1.0 + np.sin(half)) / np.cos(half))
    normal = np.cross(corner.before, corner.after)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    in_plane = np.sqrt(np.maximum(1.0 - normal**2, LEAST_SHARE))
    grip = np.min(limits.acceleration / in_plane, axis=1)
    widest = space * np.tan(half)
    goal = np.maximum(plan.planned[rows], plan.planned[rows + 1])
    goal = np.minimum(goal, np.min(limits.rapid / in_plane, axis=1))
    speed = np.minimum(np.sqrt(CENTRIPETAL * grip * widest), goal)
    needed = np.minimum(np.sqrt(grip * space), speed) * 2.0 * speed / (grip * corner.angle)
    radius = np.maximum(speed**2 / (CENTRIPETAL * grip), np.minimum(widest, needed))
    length = radius * corner.angle
    speed = np.minimum(speed, length / (LEAST_PERIODS * period))
    for row in (rows, rows + 1):
        # With an arc there is one only in its plane.
        side = np.arange(3) == moves.normal[row][:, None]
        across = np.maximum(np.abs(corner.before), np.abs(corner.after))
        leaves = np.max(across, axis=1, where=side, initial=0.0) > FLAT
        speed = np.where((moves.turn[row] != 0.0) & leaves, 0.0, speed)
    return _Arcs(
        speed=speed, length=length, trim=radius / np.tan(half), acceleration=ALONG * grip
    )


def _overlap(plan: MovePlan, corner: _Corners, most: Floats) -> Floats:
    """Speed at which moves overlap that end and begin with half their acceleration."""
    grip = 0.5 * plan.acceleration * plan.along
    reached = np.minimum(np.sqrt(grip * plan.moves.length), most)
    longest, ramp = plan.moves.length / reached, reached / grip
    one, two = corner.rows, corner.rows + 1
    time = np.minimum(np.minimum(longest[one], longest[two]), np.maximum(ramp[one], ramp[two]))
    speed = np.minimum(reached[one], time * grip[one])
    speed = np.minimum(speed, np.minimum(reached[two], time * grip[two]))
    # Infinite without a tolerance.
    cosine = np.cos(0.5 * (np.pi - corner.angle))
    return np.minimum(
        speed, 2.0 * np.sqrt(np.minimum(grip[one], grip[two]) * corner.tolerance / cosine)
    )
