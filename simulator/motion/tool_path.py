"""Tool path of a workingstep as the axes run it: legs from rest to rest, and their duration.

The path is read as by a control: moves that differ only in whether they touch material are
merged. A leg ends where the path waits: at a dwell, and where the spindle gets another speed,
for which the feed waits. At constant surface speed a move is split so that the speed changes by
at most a few per cent from piece to piece. Tool changes and the approach to the path are not
included. Units mm, s, rev/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, pi, sqrt
from typing import NamedTuple

import numpy as np

from simulator.motion.control import ExactStop, control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import (
    AxisLimits,
    Bools,
    ControlModel,
    Floats,
    Ints,
    Leg,
    Segments,
    SpindleRamp,
    axis_limits,
    chained,
)
from simulator.spec import Machine, Spindle
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PostError
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import (
    RateMode,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
)
from stepnc_model.post.canonical import synchronised
from stepnc_model.post.modal_state import ModalState
from stepnc_model.post.neutral import unsplit
from stepnc_model.toolpath.path import (
    Dwell,
    Feed,
    Move,
    Point,
    SpindleCommand,
    SpindleSpeedChange,
    ToolPath,
)

PIECE = 0.02
"""Relative change of the radius within one piece at constant surface speed."""

MOST_PIECES = 400

NEAREST = 0.02
"""Distance from the axis, mm, within which a path is not split further."""


def in_pieces(segments: Segments, least: float) -> Segments:
    """Split segments so that the spindle speed changes little from piece to piece.

    Parameters
    ----------
    least : float, mm
        Radius within which the spindle has its greatest speed.
    """
    return _split(segments, _pieces(segments, max(least, NEAREST)))


def behind(wanted: Floats, length: Floats, advance: Floats, *, ramp: float) -> Floats:
    """Mean speeds of a spindle that follows the radius as fast as it can.

    A feed per revolution is synchronised with the spindle: over a piece of path that takes some
    number of revolutions, the spindle ramps towards the speed for this piece and then keeps it.
    When the next feed move begins after a rapid, it has caught up.

    Parameters
    ----------
    wanted : (N,) array, rev/s
        Speed required by the radius; the first is reached, as a feed waits for the spindle.
    length : (N,) array, mm
    advance : (N,) array, mm
        Feeds per revolution; 0 if there is none.
    ramp : float, rev/s²
    """
    mean, speed, is_late = wanted.copy(), 0.0, False
    is_locked = (advance > 0.0) & (length > 0.0)
    for row in np.flatnonzero(is_locked):
        if row == 0 or not is_locked[row - 1]:
            speed, is_late = float(wanted[row]), False
        turns, goal = float(length[row] / advance[row]), float(wanted[row])
        rise = ramp if goal > speed else -ramp
        until = abs(goal - speed) / ramp
        if turns >= 0.5 * (speed + goal) * until:
            # A spindle that was not late also follows the radius within the piece.
            catch_up = 0.5 * (speed + goal) * until
            seconds = until + (turns - catch_up) / goal if is_late else turns / goal
            speed, is_late = goal, False
        else:
            is_late = True
            seconds = (sqrt(speed * speed + 2.0 * rise * turns) - speed) / rise
            speed += rise * seconds
        mean[row] = turns / seconds
    return mean


def _pieces(segments: Segments, least: float) -> Ints:
    """Number of pieces into which each segment is split at constant surface speed, (N,).

    Within the radius ``least``, mm, the spindle has its greatest speed.
    """
    one, other = np.abs(segments.start[:, 0]), np.abs(segments.end[:, 0])
    low = np.maximum(np.minimum(one, other), least)
    high = np.maximum(np.maximum(one, other), low)
    count = np.clip(np.ceil(np.log(high / low) / PIECE), 1, MOST_PIECES)
    pieces: Ints = np.where(segments.is_rapid, 1, count).astype(np.int64)
    return pieces


def _split(segments: Segments, pieces: Ints) -> Segments:
    """Split each segment into a number of pieces of equal length."""
    rows = np.repeat(np.arange(len(segments)), pieces)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    step = (segments.length / pieces)[rows]
    is_last = number + 1 == pieces[rows]
    end = segments.position(rows, (number + 1) * step)
    end[is_last] = segments.end
    start = np.concatenate((segments.start[:1], end[:-1]))
    start[number == 0] = segments.start
    return replace(segments[rows], start=start, end=end, turn=(segments.turn / pieces)[rows])


Spin = SpindleOn | SurfaceSpeed | SpindleOff

LookUp = Callable[[Feed], ModalState]
"""Function that returns the modal state which applies to a feed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ToolPathRun:
    """Tool path as the axes run it."""

    moves: tuple[Move, ...]
    segments: Segments
    """N lines and arcs; ``block`` is the index of the move."""
    spindle: Floats
    """Magnitude of the spindle speed in the middle of each segment, (N,), rev/s."""
    is_clockwise: bool
    """Whether the spindle turns clockwise at the first cut."""
    legs: tuple[Leg, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedRatios:
    """Ratios of feed and speed to the programmed ones for a technology; and the plunge feed."""

    technology: Ref[Entity]
    feed: float = 1.0
    """Ratio of the feed per tooth, or per revolution, to the programmed one."""
    speed: float = 1.0
    """Ratio of the spindle speed to the programmed one."""
    plunge: float | None = None
    """Plunge feed per revolution on the way down into the material, mm; None: unchanged."""


class _MoveRow(NamedTuple):
    """Move with its start point and the modal state that applies."""

    start: Point
    move: Move
    state: ModalState | None
    """Modal state of a feed move; None for a rapid."""


class PathGeometry:
    """Moves of a tool path and their lines and arcs, made once for all runs of the path."""

    def __init__(self, path: ToolPath) -> None:
        self.path = path
        self.steps = tuple(unsplit(path.start, path.steps))
        """Steps without moves that were split only between contact and air."""
        self._segments: dict[tuple[int, int], Segments] = {}
        """Lines and arcs by the first move of a leg and the number of its moves."""

    def segments(self, rows: Sequence[_MoveRow], first: int) -> Segments:
        """Lines and arcs of consecutive moves, the first with an index; at unlimited speed."""
        which = first, len(rows)
        if which not in self._segments:
            self._segments[which] = _segments(rows, first=first)
        return self._segments[which]


def run_of(shape: PathGeometry, look_up: LookUp, spindle: Spindle) -> ToolPathRun:
    """Convert the moves of a tool path to segments and legs as the axes run them.

    Parameters
    ----------
    look_up : callable
        Conditions of a feed, as from :func:`stepnc_model.post.modal_state.conditions`.
    spindle : Spindle
        Gives the acceleration and the greatest speed.

    Raises
    ------
    PostError
        If a cut has no feed, or has a feed per revolution with a stopped spindle.
    SchemaError
        If a technology or tool cannot be used.
    """
    return _Collector(shape, look_up, spindle).run()


def paced(look_up: LookUp, pace: SpeedRatios) -> LookUp:
    """Scale feed and speed of one technology; feeds that belong to the path are kept."""

    def faster(feed: Feed) -> ModalState:
        if feed.is_plunge and pace.plunge is not None:
            feed = replace(feed, per_revolution=pace.plunge)
        found = look_up(feed)
        spindle, rate = found.spindle, found.rate
        is_other = feed.technology != pace.technology
        # Rapids and ways in that repeat the spindle speed follow it, at feeds of their own.
        if is_other and spindle != look_up(Feed(technology=pace.technology)).spindle:
            return found
        if isinstance(spindle, (SpindleOn, SurfaceSpeed)):
            spindle = replace(spindle, speed=spindle.speed * pace.speed)
        if rate is not None and feed.velocity is None and not is_other:
            is_own = feed.per_revolution is not None
            factor = 1.0 if is_own else pace.feed
            # A mill's feed per revolution was converted to a feed per time at the old speed.
            if rate.mode is RateMode.PER_MINUTE:
                factor *= pace.speed
            rate = replace(rate, value=rate.value * factor)
        return replace(found, spindle=spindle, rate=rate)

    return faster


def usual_motion(machine: Machine) -> tuple[ControlModel, AxisLimits]:
    """Control model and axis limits used for estimating times: FIR filter.

    If nothing is known of a machine's axes, it runs at commanded speed without ramps; its
    rapids use the rapid speed of the machine, or take no time.
    """
    limits = axis_limits(machine)
    if np.isfinite(limits.acceleration).any():
        return control_model(ControlModelName.FIR, limits), limits
    rapid = np.full(3, machine.rapid or _NO_TIME)
    return ExactStop(), replace(limits, rapid=rapid)


_NO_TIME = 1e9  # mm/s


def follows(run: ToolPathRun, technology: Ref[Entity]) -> Bools:
    """True if each segment runs at the feed given by a technology, (N,)."""
    feeds = [move.feed for move in run.moves]
    is_bound = [
        feed is not None
        and feed.technology == technology
        and feed.velocity is None
        and feed.per_revolution is None
        and not feed.is_synchronised
        for feed in feeds
    ]
    bound: Bools = np.array(is_bound, dtype=np.bool_)[run.segments.block]
    return bound


def plunges(run: ToolPathRun) -> Bools:
    """True if each segment plunges into the material, possibly at a feed of its own, (N,)."""
    is_plunge = [move.feed is not None and move.feed.is_plunge for move in run.moves]
    plunging: Bools = np.array(is_plunge, dtype=np.bool_)[run.segments.block]
    return plunging


class _Collector:
    """Converter of a tool path; keeps the position of the tool and the state of the spindle."""

    def __init__(self, shape: PathGeometry, look_up: LookUp, spindle: Spindle) -> None:
        self.shape = shape
        self.path = path = shape.path
        self.look_up = look_up
        self.ramp = spindle.acceleration or inf
        self.fastest = spindle.max_speed or inf
        self.at = path.start
        self.feed: Feed | None = None
        """Feed of the last cut."""
        self.state: ModalState | None = None
        """Modal state for this feed."""
        self.speed: float | None = None
        """Commanded spindle speed, rev/s, signed; None: not set, or constant surface speed."""
        self.spin: Spin | None = None
        """Spindle command of the current technology."""
        self.rows: list[_MoveRow] = []
        self.moves: list[Move] = []
        self.parts: list[tuple[Segments, Floats]] = []
        self.legs: list[Leg] = []
        self.is_clockwise: bool | None = None
        self.is_spindle_awaited = False
        """Whether the wait of the last leg is for the spindle."""
        self.followed: float | None = None
        """Spindle speed at constant surface speed as commanded last, rev/s."""
        self.target: float | None = None
        """Spindle speed to which the spindle ramps during this leg, rev/s; None: no ramp."""

    def run(self) -> ToolPathRun:
        """Convert the whole path; the spindle is already turning when it begins."""
        if self.path.technology_ref is not None:
            self._take(self.look_up(Feed(technology=self.path.technology_ref)))
        for step in self.shape.steps:
            match step:
                case Move():
                    self._move(step)
                case Dwell():
                    self._close(self._seconds(step))
                    self.is_spindle_awaited = False
                case SpindleSpeedChange(technology=technology):
                    self._take(self.look_up(Feed(technology=technology)))
                case SpindleCommand():
                    self._turn(self.spin, step)
        if self.is_spindle_awaited and all(row.state is None for row in self.rows):
            # Only a feed waits for the spindle, and no feed follows.
            self.legs[-1] = replace(self.legs[-1], wait=0.0)
        self._close(0.0)
        segments = [part for part, _ in self.parts]
        return ToolPathRun(
            moves=tuple(self.moves),
            segments=replace(
                chained(segments), block=np.concatenate([part.block for part in segments])
            ),
            spindle=np.concatenate([spindle for _, spindle in self.parts]),
            is_clockwise=self.is_clockwise is not False,
            legs=tuple(self.legs),
        )

    def _move(self, move: Move) -> None:
        found = None
        if move.feed is not None:
            # Most moves have the same feed object as the previous one.
            if move.feed is not self.feed or self.state is None:
                self.feed, self.state = move.feed, self.look_up(move.feed)
            found = self.state
            self._take(found)
        if isinstance(self.spin, SurfaceSpeed):
            self._follow(move)
        self.rows.append(_MoveRow(self.at, move, found))
        self.at = move.end

    def _follow(self, move: Move) -> None:
        """Close legs where a rapid begins to change the spindle speed and a feed waits for it.

        A rapid goes to the speed at its end at once; a feed follows the radius.
        """
        is_feed = move.feed is not None
        here, there = self._speeds(np.array([self.at[0], move.end[0]])).tolist()
        wanted = here if is_feed else there
        if self.followed is not None and wanted != self.followed:
            if self.rows:
                self._close(0.0)
            self.target = wanted
        if is_feed and self.target is not None:
            self._close(0.0, is_awaited=True)
        self.followed = there

    def _take(self, state: ModalState) -> None:
        """Apply the spindle command of a technology."""
        if state.spindle is not None and state.spindle != self.spin:
            self._turn(state.spindle, SpindleCommand.START)

    def _turn(self, spin: Spin | None, command: SpindleCommand) -> None:
        """Change the spindle speed and close the leg if the next feed must wait for it."""
        wanted = None if isinstance(spin, SurfaceSpeed) else self._signed(spin, command)
        wait = 0.0
        if wanted is not None and self.speed is not None:
            wait = abs(wanted - self.speed) / self.ramp
        if wait > 0.0 or any(row.state is not None for row in self.rows):
            self._close(wait)
            self.is_spindle_awaited = True
        self.spin, self.speed = spin, wanted
        self.followed = self.target = None

    def _signed(self, spin: Spin | None, command: SpindleCommand) -> float:
        """Signed spindle speed after a command, rev/s, positive clockwise."""
        if not isinstance(spin, SpindleOn):
            return 0.0
        sign = {SpindleCommand.START: 1.0, SpindleCommand.REVERSE: -1.0}.get(command, 0.0)
        if spin.sense is not SpindleDirection.CLOCKWISE:
            sign = -sign
        return sign * min(spin.speed, self.fastest)

    def _seconds(self, dwell: Dwell) -> float:
        if dwell.seconds is not None:
            return dwell.seconds
        speed = float(self._speeds(np.array([self.at[0]]))[0])
        if dwell.revolutions is None or speed <= 0.0:
            raise PostError(f"'{self.path.id}': dwell in revolutions with a stopped spindle")
        return dwell.revolutions / speed

    def _speeds(self, x: Floats) -> Floats:
        """Spindle speed where the radius is |x|, (N,), rev/s."""
        if not isinstance(self.spin, SurfaceSpeed):
            return np.full(len(x), abs(self.speed or 0.0))
        most = min(self.fastest, self.spin.limit or inf)
        around = 2.0 * pi * np.abs(x)
        at_most = np.full(len(x), most)
        speeds: Floats = np.minimum(
            np.divide(self.spin.speed, around, out=at_most, where=around > 0.0), most
        )
        return speeds

    def _close(self, wait: float, *, is_awaited: bool = False) -> None:
        """Close a leg with the moves so far, and state whether a feed waits for its ramp."""
        segments, spindle = self._timed()
        if self.is_clockwise is None and any(row.state is not None for row in self.rows):
            self.is_clockwise = self._turns_clockwise()
        first = self.legs[-1].last if self.legs else 0
        ramp, is_fed = None, bool(self.rows) and self.rows[-1].state is not None
        if self.target is not None:
            ramp = SpindleRamp(speed=self.target, acceleration=self.ramp, is_awaited=is_awaited)
        ends_at = float(spindle[-1]) if is_fed else None
        last = first + len(segments)
        self.legs.append(Leg(first=first, last=last, wait=wait, ramp=ramp, spindle=ends_at))
        self.target = None
        self.parts.append((segments, spindle))
        self.moves += [row.move for row in self.rows]
        self.rows = []

    def _turns_clockwise(self) -> bool:
        if isinstance(self.spin, SurfaceSpeed):
            return self.spin.sense is SpindleDirection.CLOCKWISE
        return (self.speed or 0.0) >= 0.0

    def _timed(self) -> tuple[Segments, Floats]:
        """Segments of the collected rows with their feeds, and spindle speeds."""
        segments = self.shape.segments(self.rows, len(self.moves))
        if isinstance(self.spin, SurfaceSpeed):
            least = self.spin.speed / (2.0 * pi * min(self.fastest, self.spin.limit or inf))
            segments = in_pieces(segments, least)
        spindle = self._speeds(np.zeros(len(segments)))
        if isinstance(self.spin, SurfaceSpeed):
            rows = np.arange(len(segments))
            spindle = self._speeds(segments.position(rows, 0.5 * segments.length)[:, 0])
            found = [self.rows[of].state for of in segments.block - len(self.moves)]
            spindle = behind(spindle, segments.length, _advance(found), ramp=self.ramp)
        speed = segments.speed.copy()
        for row, of in enumerate(segments.block - len(self.moves)):
            found = self.rows[of].state
            if found is not None:
                speed[row] = self._feed(self.rows[of], found, float(spindle[row]))
        return replace(segments, speed=speed), spindle

    def _feed(self, row: _MoveRow, state: ModalState, spindle: float) -> float:
        """Speed along the path, mm/s."""
        if state.lead is not None:
            speed = synchronised(row.start, row.move.end, state.lead) * spindle
        elif state.rate is None:
            speed = 0.0
        elif state.rate.mode is RateMode.PER_REVOLUTION:
            speed = state.rate.value * spindle
        else:
            speed = state.rate.value
        if not 0.0 < speed < inf:
            why = state.note or f"{speed:g} mm/s"
            raise PostError(f"'{self.path.id}': a cut without feed: {why}")
        return speed


def _advance(states: Sequence[ModalState | None]) -> Floats:
    """Feeds per revolution, (N,), mm; 0 for rapids and for feeds per time."""
    rates = [None if each is None else each.rate for each in states]
    return np.array([
        rate.value if rate is not None and rate.mode is RateMode.PER_REVOLUTION else 0.0
        for rate in rates
    ])


def _segments(rows: Sequence[_MoveRow], *, first: int) -> Segments:
    """Lines and arcs of moves, all at unlimited speed."""
    arcs = [row.move.arc for row in rows]
    centre = [arc.centre if arc else row.start for row, arc in zip(rows, arcs, strict=True)]
    normal = [arc.plane.axes[2] if arc else 2 for arc in arcs]
    turn = [arc.turn if arc else 0.0 for arc in arcs]
    return Segments(
        start=np.array([row.start for row in rows], dtype=np.float64).reshape(-1, 3),
        end=np.array([row.move.end for row in rows], dtype=np.float64).reshape(-1, 3),
        speed=np.full(len(rows), inf),
        is_rapid=np.array([row.state is None for row in rows], dtype=np.bool_),
        centre=np.array(centre, dtype=np.float64).reshape(-1, 3),
        turn=np.array(turn, dtype=np.float64),
        normal=np.array(normal, dtype=np.int64),
        block=first + np.arange(len(rows)),
    )
