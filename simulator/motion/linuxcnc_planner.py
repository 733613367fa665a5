"""Model of LinuxCNC's trajectory planner, version 2.9.

In ``G64 P`` the planner replaces each corner by an arc that leaves the path by at most P; where
there can be none it passes the corner slowly, or lets the end of one move overlap with the
start of the next. In G61 and G61.1 it stops there. Successive lines of one feed are first
joined to chords that leave their points by at most Q. Speeds at joints follow from a sweep over
as many moves as the planner looks ahead. :mod:`simulator.motion.corner_blends` has the joints.

Two more rules matter for times. An arc keeps half of its acceleration for the path, as if it
ran at its greatest speed. The last move before the control waits (M2, M0, M6, G4) has half the
acceleration, because it waits for a move that it could overlap with.

Where moves overlap only the time is modelled: the path keeps the corner, which the control
rounds by about a quarter of the tolerance (13 µm of 50 µm were measured).

Not modelled: jerk (2.9 has none; 2.10 plans otherwise), synchronised threading, the time that a
queue of moves takes to fill (up to 15 ms where lines are short), and the servo period but for
half a period at each stop and for moves that are shorter than one. Units mm, s.

References
----------
.. [1] LinuxCNC 2.9, trajectory planner: read in its source, measured with
   ``python -m benchmarks.linuxcnc``.
"""

from dataclasses import dataclass
from functools import cached_property
from math import isfinite

import numpy as np

from simulator.motion.corner_blends import (
    CENTRIPETAL,
    LEAST_PERIODS,
    Joints,
    MovePlan,
    joints,
)
from simulator.motion.path_limits import (
    block_lengths,
    goes_on,
    least,
    path_limits,
    slower_in_plane,
)
from simulator.motion.segments import (
    AxisLimits,
    Bools,
    Floats,
    Ints,
    Kinematics,
    Motion,
    Segments,
    distinct,
)
from simulator.motion.sweep import SpeedProfile, profiled, swept
from simulator.planner_settings import USUAL, PlannerSettings
from stepnc_model.post.blocks import PathControl

LOOK_AHEAD = 50
"""Moves over which the planner looks ahead ([TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH)."""

MOST_JOINED = 100
"""Lines that are joined to one move, at most."""

POWER_ON = PathControl(tolerance=0.0254, joining=0.0)
"""Path mode until a program names one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinuxCncPlanner:
    """LinuxCNC's planner in one path mode."""

    settings: PlannerSettings = USUAL
    mode: PathControl = POWER_ON
    is_drained: bool = True
    """Whether the control waits at the end of the path for something other than a move."""
    is_synchronised: bool = False
    """Whether feeds follow the spindle; corners are planned for the greatest speed then."""

    @property
    def joining(self) -> float:
        """Distance from lines that are joined, mm; 0: none are."""
        tolerance, given = self.mode.tolerance, self.mode.joining
        if tolerance == 0.0:
            return 0.0
        if given is None:
            return tolerance if isfinite(tolerance) else 0.0
        return given

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Plan the motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            If there is no segment, or a segment's speed is unlimited.
        """
        if not len(segments):
            raise ValueError("a stretch of path needs at least one segment, got 0")
        moves, last = joined(segments, self.joining)
        if not len(moves):
            return swept(
                segments, last, limits=path_limits(segments, limits), corner=np.empty(0)
            )
        plan = self._limits(moves, limits)
        found = joints(plan, mode=self.mode, period=self.settings.servo_period)
        return _motion(segments, moves, last, plan, found, self)

    def _limits(self, moves: Segments, limits: AxisLimits) -> MovePlan:
        """Limits of each move by itself."""
        share = moves.greatest_shares
        acceleration = least(limits.acceleration, share)
        period = LEAST_PERIODS * self.settings.servo_period
        fastest = np.minimum(least(limits.rapid, share), block_lengths(moves) / period)
        grip = slower_in_plane(moves, limits.acceleration)
        is_arc = moves.turn != 0.0
        bend = np.where(is_arc, moves.bend, 0.0)
        turning = np.full(len(moves), np.inf)
        np.divide(CENTRIPETAL * grip, bend, out=turning, where=bend > 0.0)
        within = np.minimum(least(limits.rapid, share) ** 2 * bend / grip, CENTRIPETAL)
        along = np.where(is_arc, np.sqrt(1.0 - within**2), 1.0)
        fastest = np.minimum(fastest, np.sqrt(turning))
        wanted = np.where(moves.is_rapid, fastest, moves.speed)
        endless = np.flatnonzero(np.isinf(np.minimum(wanted, fastest)))
        if len(endless):
            text = f"segment {endless[0]}: neither command nor axis limits its speed"
            raise ValueError(text)
        override = np.inf if self.is_synchronised else self.settings.max_feed_override
        return MovePlan(
            moves=moves,
            limits=limits,
            wanted=wanted,
            planned=np.minimum(override * wanted, fastest),
            fastest=fastest,
            acceleration=acceleration,
            along=along,
        )


def joined(segments: Segments, distance: float) -> tuple[Segments, Ints]:
    """Moves of the planner: lines of one feed that are joined to chords, [1]_.

    Returns
    -------
    Segments
        The moves that have a length.
    (K,) array of int
        Last segment of each move.
    """
    kept = np.flatnonzero(segments.length > 0.0)
    if not len(kept):
        return segments[kept], kept
    firsts = _first_of_chords(segments[kept], distance)
    lasts = np.append(firsts[1:], len(kept)) - 1
    first, last = kept[firsts], kept[lasts]
    moves = Segments(
        start=segments.start[first],
        end=segments.end[last],
        speed=segments.speed[first],
        is_rapid=segments.is_rapid[first],
        centre=segments.centre[first],
        turn=segments.turn[first],
        normal=segments.normal[first],
        block=segments.block[first],
    )
    return moves, last


def _first_of_chords(segments: Segments, distance: float) -> Ints:
    """First segment of each chord, (K,)."""
    is_line = (segments.turn == 0.0) & ~segments.is_rapid
    may_join = is_line[1:] & is_line[:-1] & (segments.speed[1:] == segments.speed[:-1])
    straight = goes_on(segments) & (segments.speed[1:] == segments.speed[:-1])
    straight &= (segments.turn[1:] == 0.0) & (segments.turn[:-1] == 0.0)
    firsts, begin = [0], 0
    for row in range(1, len(segments)):
        if straight[row - 1]:
            continue
        if may_join[row - 1] and distance > 0.0 and row - begin <= MOST_JOINED:
            inner = segments.end[begin:row] - segments.start[begin]
            if _is_near(inner, segments.end[row] - segments.start[begin], distance):
                continue
        firsts.append(row)
        begin = row
    return np.array(firsts)


def _is_near(points: Floats, chord: Floats, distance: float) -> bool:
    """True if points lie within a distance of a chord from the origin."""
    square = float(chord @ chord)
    if square == 0.0:
        return False
    part = np.clip(points @ chord / square, 0.0, 1.0)
    beside = points - part[:, None] * chord
    return bool((np.linalg.norm(beside, axis=1) <= distance).all())


def _motion(
    segments: Segments,
    moves: Segments,
    last: Ints,
    plan: MovePlan,
    joints: Joints,
    planner: LinuxCncPlanner,
) -> "PlannedMotion":
    """Pieces of the path, and the speed along them."""
    count = len(moves)
    has_blend = np.append(joints.length > 0.0, False)
    # A move, then the blend after it where there is one.
    move = np.repeat(np.arange(count), 1 + has_blend)
    is_blend = np.append(False, move[1:] == move[:-1])
    before, after = np.append(0.0, joints.trim), np.append(joints.trim, 0.0)
    shortened = np.maximum(moves.length - before - after, 0.0)
    acceleration = plan.acceleration * plan.along * (1.0 - joints.reduction)
    acceleration *= np.where(joints.is_halved, 0.5, 1.0)
    if planner.is_drained and planner.mode.tolerance > 0.0 and not joints.is_halved[-1]:
        acceleration[-1] *= 0.5
    cap = np.minimum(plan.wanted, plan.fastest)
    length = np.where(is_blend, np.append(joints.length, 0.0)[move], shortened[move])
    top = np.where(is_blend, np.append(joints.speed, 0.0)[move], cap[move])
    grip = np.where(is_blend, np.append(joints.acceleration, 0.0)[move], acceleration[move])
    # The speed of a blend is that of its piece, so that its ends are tangent.
    joint = np.where(joints.length > 0.0, np.inf, joints.speed)
    corner = np.full(len(move) - 1, np.inf)
    ends = np.flatnonzero(np.diff(move))
    corner[ends] = np.where(is_blend[ends], np.inf, joint)
    corner **= 2
    corner = np.minimum(corner, _seen_ahead(2.0 * grip * length))
    stops = np.append(corner == 0.0, True)
    return PlannedMotion(
        segments=segments,
        moves=moves,
        last=last,
        joints=joints,
        move=move,
        is_blend=is_blend,
        profile=profiled(
            length,
            cap=top**2,
            acceleration=grip,
            corner=corner,
            rest=0.5 * planner.settings.servo_period * stops,
        ),
    )


def _seen_ahead(reach: Floats) -> Floats:
    """Greatest squared speed at each joint from which the moves that are seen lead to rest."""
    total = np.append(0.0, np.cumsum(reach))
    here = np.arange(1, len(reach))
    farthest = np.minimum(here + LOOK_AHEAD, len(reach))
    # The end of the path is a stop by itself.
    return np.where(farthest < len(reach), total[farthest] - total[here], np.inf)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlannedMotion:
    """Motion along moves and the blends between them, in phases of constant acceleration."""

    segments: Segments
    moves: Segments
    last: Ints
    """Last segment of each move."""
    joints: Joints
    move: Ints
    """Move of each piece of the path, or the one before it for a blend."""
    is_blend: Bools
    profile: SpeedProfile

    @property
    def duration(self) -> float:
        """Duration of the whole stretch, s."""
        return self.profile.duration

    @cached_property
    def knots(self) -> Floats:
        """Times at which phases, moves and halves of blends begin and end, s."""
        phases = np.append(self.profile.start, self.duration)
        rows = self._node_piece
        passed = self.profile.time_at(rows, self.profile.length[rows] * self._node_part)
        return distinct(np.append(phases, np.clip(passed, 0.0, self.duration)))

    @cached_property
    def ends(self) -> Floats:
        """End time of each segment, (N,), s; half-way through the blend after it."""
        piece, part = self._node_piece, self._node_part
        goal = np.append(0.0, np.cumsum(self.segments.length))[1:]
        at = np.interp(goal, self._nodes, np.arange(len(self._nodes)))
        node = np.minimum(at.astype(np.int64), len(self._nodes) - 2)
        share = at - node
        row = piece[node]
        station = self.profile.length[row] * (
            part[node] + share * (self._node_end[node] - part[node])
        )
        times = np.minimum(self.profile.time_at(row, station), self.duration)
        times[-1] = self.duration
        return np.maximum.accumulate(times)

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) ascending times in s, between 0 and the duration."""
        state = self.profile.at(times)
        piece, station = state.row, state.station
        move = self.move[piece]
        before = np.append(0.0, self.joints.trim)
        position, direction, bend = (np.empty((len(times), 3)) for _ in range(3))
        on = ~self.is_blend[piece]
        along = before[move[on]] + station[on]
        position[on] = self.moves.position(move[on], along)
        direction[on] = self.moves.direction(move[on], along)
        bend[on] = self.moves.curvature(move[on], along)
        off = np.flatnonzero(~on)
        if len(off):
            part = station[off] / self.profile.length[piece[off]]
            position[off], direction[off], bend[off] = self.joints.blend(move[off], part)
        row, along = self._place(piece, station)
        return Kinematics(
            position=position,
            velocity=direction * state.speed[:, None],
            acceleration=direction * state.acceleration[:, None]
            + bend * (state.speed**2)[:, None],
            segment=row,
            station=along,
        )

    # Where a place on the pieces lies on the programmed path: each piece, and each half of a
    # blend, corresponds to a stretch of it, from one node to the next.

    @cached_property
    def _whole(self) -> Floats:
        """Length of the programmed path up to the end of each move, from 0, (K + 1,), mm."""
        along = np.append(0.0, np.cumsum(self.segments.length))
        return np.append(0.0, along[self.last + 1])

    @cached_property
    def _pieces(self) -> tuple[Floats, Ints, Floats, Floats]:
        whole, moves = self._whole, self.moves
        before = np.append(0.0, self.joints.trim)
        after = np.append(self.joints.trim, 0.0)
        scale = np.diff(whole) / moves.length
        nodes, piece, part, end = [0.0], [], [], []
        for row, (move, is_blend) in enumerate(
            zip(self.move.tolist(), self.is_blend.tolist(), strict=True)
        ):
            if not is_blend:
                nodes.append(float(whole[move + 1] - after[move] * scale[move]))
                piece.append(row)
                part.append(0.0)
                end.append(1.0)
                continue
            nodes.append(float(whole[move + 1]))
            nodes.append(float(whole[move + 1] + before[move + 1] * scale[move + 1]))
            piece += [row, row]
            part += [0.0, 0.5]
            end += [0.5, 1.0]
        return (
            np.maximum.accumulate(np.array(nodes)), np.array(piece), np.array(part),
            np.array(end),
        )  # fmt: skip

    @property
    def _nodes(self) -> Floats:
        return self._pieces[0]

    @property
    def _node_piece(self) -> Ints:
        return self._pieces[1]

    @property
    def _node_part(self) -> Floats:
        return self._pieces[2]

    @property
    def _node_end(self) -> Floats:
        return self._pieces[3]

    def _place(self, piece: Ints, station: Floats) -> tuple[Ints, Floats]:
        """Segment and position along it of places on the pieces."""
        length = self.profile.length[piece]
        part = np.divide(station, length, out=np.zeros(len(station)), where=length > 0.0)
        first = np.searchsorted(self._node_piece, piece)
        late = self.is_blend[piece] & (part >= 0.5)
        node = first + late
        low, high = self._node_part[node], self._node_end[node]
        share = np.clip((part - low) / (high - low), 0.0, 1.0)
        goal = self._nodes[node] + share * (self._nodes[node + 1] - self._nodes[node])
        along = np.append(0.0, np.cumsum(self.segments.length))
        row = np.clip(np.searchsorted(along, goal, side="right") - 1, 0, len(along) - 2)
        return row, np.clip(goal - along[row], 0.0, self.segments.length[row])
