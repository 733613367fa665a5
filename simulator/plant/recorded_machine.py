"""Recorded run as a machine of the closed loop: what was measured, at places of the program.

The recorded positions are followed along the course of the program: from each sample to the
next, the place nearest to the measured position among those that the tool can have reached.
So every moment of the run gets a program time, whatever feed was run. The override of a
recorded run is what it was; commands have no effect. Units mm, s, N, W.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan

import numpy as np

from simulator.errors import CalibrationError
from simulator.motion.segments import Bools, Floats
from simulator.plant.controlled_machine import LONGEST, SLOWEST, TrueState
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange
from simulator.reading import Reading
from stepnc_model.plurals import counted

AHEAD = 2.0
"""Multiple of the measured way within which the next place is looked for."""

MARGIN = 2.0
"""Way that is looked at beyond, in mm."""

PREFERENCE = 0.1
"""Distance that counts as much as a unit of way more or less than was measured."""

FITS = 0.05
"""Mean distance from the path, in mm, at which an offset needs no other to compare with."""

FAR = 5.0
"""Distance from the path at which a sample is not of this program, in mm."""

MOST_FAR = 0.2
"""Share of such samples in a run that is refused."""

ALIKE = 0.1
"""Difference of overrides by feed and by positions, as a share, up to which it is noise."""

SMOOTH = 0.1
"""Time before and after a moment over which its override is measured, in s."""

TINY = 1e-12
"""Squared length of a step between cells that counts as none, in mm²."""

LOOKS = 13
"""Number of places around one at which forces are compared."""

LIKE = 1.1
"""Ratio of forces that count as the same."""

FEWEST = 3
"""Fewest samples."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordedSignals:
    """N samples of a recorded run, ascending in time; NaN where a value is unknown."""

    time: Floats
    """Time of each sample, (N,), s."""
    position: Floats
    """Position of the tool, (N, 3), mm."""
    feed: Floats
    """Feed along the path, (N,), mm/s."""
    force: Floats
    """Mean tangential cutting force over a revolution, (N,), N."""
    power: Floats
    """Power of the main drive, (N,), W."""


def program_times(signals: RecordedSignals, course: NominalCourse) -> Floats:
    """Return the program time of each sample, (N,), s; it never goes back.

    Raises
    ------
    CalibrationError
        When there are too few samples, or the run is not one of this program.
    """
    if len(signals.time) < FEWEST:
        raise CalibrationError(
            f"{counted(len(signals.time), 'sample')}; at least {FEWEST} are needed"
        )
    # An axis that is hardly recorded does not count.
    is_known = ~np.isnan(signals.position)
    has_axis = is_known.sum(axis=0) >= 0.5 * is_known.any(axis=1).sum()
    has_axis &= is_known.any(axis=0)
    rows = np.flatnonzero(is_known[:, has_axis].all(axis=1))
    if len(rows) < FEWEST or not has_axis.any():
        raise CalibrationError("no positions of the axes are recorded")
    measured = signals.position[np.ix_(rows, has_axis)]
    path = np.asarray(course.position, dtype=np.float64)[:, has_axis]
    way = _way(path)
    gone = _way(measured)
    if not gone[-1] > 0.0:
        raise CalibrationError("the recorded positions do not change")
    places, far = _placed(measured, path, gone, way)
    if np.mean(far > FAR) > MOST_FAR:
        raise CalibrationError(
            f"{np.mean(far > FAR):.0%} of the positions are more than {FAR:g} mm off the path: "
            "is it a run of this program?"
        )
    middles = course.until - 0.5 * np.diff(course.until, prepend=0.0)
    found = np.interp(places, np.arange(len(course)), middles)
    found[-1] = course.duration if places[-1] >= len(course) - 2 else found[-1]
    times: Floats = np.interp(signals.time, signals.time[rows], found)
    return times


def _way(path: Floats) -> Floats:
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _placed(measured: Floats, path: Floats, gone: Floats, way: Floats) -> tuple[Floats, Floats]:
    """Return the place of each sample and its distance with the offset that fits best."""
    best: tuple[Floats, Floats] | None = None
    for offset in _offsets(measured, path, gone * (way[-1] / gone[-1]), way):
        found = _followed(measured - offset, path, gone, way)
        if best is None or _misfit(found[1]) < _misfit(best[1]):
            best = found
        if _misfit(found[1]) <= FITS:
            break
    assert best is not None
    return best


def _misfit(far: Floats) -> float:
    """Return the mean distance from the path, in mm; samples of something else count alike."""
    return float(np.minimum(far, FAR).mean())


def _offsets(measured: Floats, path: Floats, gone: Floats, way: Floats) -> Iterator[Floats]:
    """Generate offsets of the recorded zero point that may be, in mm, the likeliest first.

    A whole run goes as far to both sides as the program. The way gone tells less: corners that
    are cut between samples shorten it, so that all samples seem to lag.
    """
    yield np.zeros(path.shape[1])
    yield 0.5 * sum(ends(measured, axis=0) - ends(path, axis=0) for ends in (np.min, np.max))
    near = np.minimum(way.searchsorted(gone), len(path) - 1)
    yield np.median(measured - path[near], axis=0)


def _followed(
    measured: Floats, path: Floats, gone: Floats, way: Floats
) -> tuple[Floats, Floats]:
    """Return the place of each sample, in cells with fractions, and its distance in mm."""
    places, far = np.zeros(len(measured)), np.zeros(len(measured))
    steps = np.diff(path, axis=0)
    squares = np.maximum(np.sum(steps * steps, axis=1), TINY)
    place = 0.0
    for row, position in enumerate(measured):
        step = gone[row] - gone[row - 1] if row else 0.0
        at = min(int(place), len(steps) - 1)
        here = way[at] + (place - at) * (way[at + 1] - way[at])
        # A tool that stands still stays where it is: the path may come by again.
        if step > 0.0 or row == 0:
            end = int(way.searchsorted(here + AHEAD * step + MARGIN))
            end = min(max(end, at + 1), len(steps))
            rows = slice(at, end)
            parts = np.sum((position - path[rows]) * steps[rows], axis=1) / squares[rows]
            parts = np.clip(parts, 0.0, 1.0)
            parts[0] = max(parts[0], place - at)
            near = path[rows] + parts[:, np.newaxis] * steps[rows]
            distances = np.linalg.norm(near - position, axis=1)
            # Of places that are equally near, the one as far along as the tool has moved.
            ways = way[rows] + parts * (way[at + 1 : end + 1] - way[rows])
            best = int((distances + PREFERENCE * np.abs(ways - here - step)).argmin())
            place, far[row] = at + best + parts[best], distances[best]
        places[row] = place
    return places, far


def _steady(course: NominalCourse, interval: float) -> Bools:
    """Return for each cell whether the force hardly changes around it, (N,).

    A force between two samples is interpolated, so that it knows of an interval on both sides.
    """
    force = np.asarray(course.force, dtype=np.float64)
    low, high = force.copy(), force.copy()
    for away in np.linspace(-1.0, 1.0, LOOKS) * (SMOOTH + interval):
        rows = np.minimum(course.until.searchsorted(course.until + away), len(course) - 1)
        np.minimum(low, force[rows], out=low)
        np.maximum(high, force[rows], out=high)
    return np.asarray(high <= LIKE * low)


class RecordedMachine:
    """Recorded run that is read tooth period by tooth period; a mutable object.

    It satisfies the protocols of :mod:`controller.signals.ports` without importing them.

    Parameters
    ----------
    course : NominalCourse
        Course of the program that was run.

    Raises
    ------
    CalibrationError
        As :func:`program_times`.
    """

    def __init__(self, course: NominalCourse, signals: RecordedSignals) -> None:
        self.course = course
        self.truth = TrueState()
        self.commanded = 1.0
        self._signals = signals
        self._program = program_times(signals, course)
        self._ends: list[float] = course.until.tolist()
        self._is_steady = _steady(course, self.interval)
        self._end = float(signals.time[-1])
        self._cell = int(course.until.searchsorted(self._program[0], side="right"))
        self._progress = float(self._program[0])
        self._turned = 0
        self.time = float(signals.time[0])
        """Time of the run, in s."""

    @property
    def interval(self) -> float:
        """Usual time between samples, in s."""
        return float(np.median(np.diff(self._signals.time)))

    @property
    def share(self) -> float:
        """Completed share of the program, 0 to 1."""
        return self._progress / self.course.duration

    def set(self, override: float, /) -> None:
        """Do nothing: the run is over."""

    def change(self, change: HiddenChange) -> None:
        """Refuse a change: the run is over."""
        raise ValueError(f"{change.what} of a recorded run cannot be changed")

    def read(self) -> Reading | None:
        """Return the next reading; None at the end of the recording."""
        while self._cell < len(self.course) and self.time < self._end:
            begin, cell = self.time, self._cell
            is_feed = bool(self.course.can_override[cell])
            self._go_on(cell, is_feed=is_feed)
            if self.time > begin:
                return self._reading(cell, self.time - begin, is_feed=is_feed)
        return None

    def _go_on(self, cell: int, *, is_feed: bool) -> None:
        """Go on by one tooth period, or to the end of the feed or of what is no feed."""
        course = self.course
        speed = float(course.spindle_speed[cell])
        period = LONGEST
        if is_feed and speed > SLOWEST:
            period = 1.0 / (int(course.teeth[cell]) * speed)
        time = min(self.time + period, self._end)
        end = float(np.interp(time, self._signals.time, self._program))
        until = self._stretch_end(cell, end)
        if until < end:
            time, end = max(self._time_at(until), self.time), until
        self.time = time
        self._progress = max(end, self._progress)
        while self._cell < len(self._ends) and self._ends[self._cell] <= self._progress:
            self._cell += 1

    def _stretch_end(self, cell: int, end: float) -> float:
        """Return the program time at which feed or its absence ends, at most the given one."""
        course = self.course
        is_feed, step = course.can_override[cell], course.workingstep[cell]
        while (
            cell < len(course)
            and course.can_override[cell] == is_feed
            and course.workingstep[cell] == step
        ):
            if self._ends[cell] >= end:
                return end
            cell += 1
        return self._ends[cell - 1]

    def _time_at(self, progress: float) -> float:
        """Return the time at which a program time is reached, in s."""
        row = int(self._program.searchsorted(progress))
        if row == 0 or row >= len(self._program):
            return float(self._signals.time[min(row, len(self._program) - 1)])
        rows = slice(row - 1, row + 1)
        return float(np.interp(progress, self._program[rows], self._signals.time[rows]))

    def _override(self, time: float) -> float:
        """Return the progress in program time over that in time; 0 in a feed hold."""
        times = np.array([time - SMOOTH, time + SMOOTH])
        times = np.clip(times, self._signals.time[0], self._end)
        begin, end = np.interp(times, self._signals.time, self._program)
        return float((end - begin) / (times[1] - times[0]))

    def _override_of(self, feed: float, cell: int, time: float) -> float:
        """Return the override by the recorded feed, or by positions where they contradict it.

        Stamps and positions come in steps, so that positions alone tell an override that
        wavers. Force over wavering feeds looks like the force of a worn edge.
        """
        gone, nominal = self._override(time), float(self.course.feed[cell])
        if not nominal > 0.0 or isnan(feed):
            return gone
        told = feed / nominal
        return told if abs(told - gone) <= ALIKE * gone else gone

    def _reading(self, cell: int, period: float, *, is_feed: bool) -> Reading:
        signals, course, middle = self._signals, self.course, self.time - 0.5 * period
        # NaN beside a sample that is unknown.
        force, power, feed = (
            float(np.interp(middle, signals.time, each))
            for each in (signals.force, signals.power, signals.feed)
        )
        override = self._override_of(feed, cell, middle) if is_feed else 1.0
        teeth = int(course.teeth[cell])
        tooth = self._turned % teeth
        self._turned += is_feed
        # What was removed is known as far as the depth is that of the program.
        self.truth = TrueState(
            force=force,
            peak=force,
            power=power,
            removal_rate=override * float(course.removal_rate[cell]),
            axial_depth=float(course.axial_depth[cell]),
            cell=cell,
        )
        return Reading(
            time=self.time,
            period=period,
            force=np.array([force]),
            power=power,
            feed=feed,
            override=override,
            spindle_speed=float(course.spindle_speed[cell]),
            teeth=teeth,
            tooth=tooth,
            progress=self._progress,
            workingstep=int(course.workingstep[cell]),
            can_override=is_feed,
            # Places of a recording are known less exactly than forces change elsewhere.
            is_placed=bool(self._is_steady[min(self._cell, len(course) - 1)]),
        )
