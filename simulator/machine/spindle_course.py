"""Spindle speed over time: ramps at constant acceleration, and constant surface speed.

The speed is piecewise linear in time, so that speed, acceleration and angle have a closed form.
Units rev/s, s.
"""

from dataclasses import dataclass
from math import inf, isnan

import numpy as np

from simulator.motion.segments import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpindleCourse:
    """Spindle speed over time: linear between knots, constant before and after them."""

    times: Floats
    """Times of the knots, (K,), s, ascending."""
    speeds: Floats
    """Spindle speeds at the knots, (K,), rev/s, positive clockwise."""
    turned: float = 0.0
    """Number of revolutions up to the first knot."""

    @property
    def reached(self) -> float:
        """Time at which the last speed is reached, s."""
        return float(self.times[-1])

    @property
    def target(self) -> float:
        """Final spindle speed, rev/s."""
        return float(self.speeds[-1])

    def speed(self, times: Floats) -> Floats:
        """Spindle speed at given times, rev/s."""
        return np.interp(times, self.times, self.speeds)

    def acceleration(self, times: Floats) -> Floats:
        """Acceleration at given times, rev/s²; at a knot, that of the following piece."""
        if len(self.times) == 1:
            return np.zeros_like(times)
        spans = np.diff(self.times)
        slopes = np.zeros(len(self.times) + 1)
        np.divide(np.diff(self.speeds), spans, out=slopes[1:-1], where=spans > 0.0)
        return slopes[np.searchsorted(self.times, times, side="right")]

    def revolutions(self, times: Floats) -> Floats:
        """Number of revolutions up to given times."""
        means = 0.5 * (self.speeds[1:] + self.speeds[:-1])
        made = np.concatenate(([0.0], np.cumsum(means * np.diff(self.times))))
        row = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, None)
        since = times - self.times[row]
        mean = 0.5 * (self.speed(times) + self.speeds[row])
        return self.turned + made[row] + mean * since


def standing(time: float, speed: float = 0.0) -> SpindleCourse:
    """Spindle speed over time for a constant speed."""
    return SpindleCourse(times=np.array([time]), speeds=np.array([speed]))


def ramped(
    course: SpindleCourse, now: float, speed: float, *, acceleration: float | None
) -> SpindleCourse:
    """Spindle speed over time for a change to another speed that begins now.

    Parameters
    ----------
    course : SpindleCourse
        Course until now.
    now : float, s
    speed : float, rev/s
        Signed target speed.
    acceleration : float, rev/s², or None
        None for an immediate change.
    """
    here = np.array([now])
    current = float(course.speed(here)[0])
    turned = float(course.revolutions(here)[0])
    span = abs(speed - current) / (acceleration or inf)
    times, speeds = [now, now + span], [current, speed]
    if current * speed < 0.0:
        # The moment of standstill is a separate knot because friction reverses there.
        times.insert(1, now + span * current / (current - speed))
        speeds.insert(1, 0.0)
    return SpindleCourse(times=np.array(times), speeds=np.array(speeds), turned=turned)


def following(
    course: SpindleCourse, begin: float, ends: Floats, *, wanted: Floats, acceleration: float
) -> SpindleCourse:
    """Spindle speed over time that follows the radius at constant surface speed.

    Parameters
    ----------
    course : SpindleCourse
        Course until now.
    begin : float, s
    ends : (N,) array, s
        End time of each piece of the path.
    wanted : (N,) array, rev/s
        Target speed at the end of each piece; NaN: unchanged.
    acceleration : float, rev/s²
        Infinite for an immediate change.
    """
    here = np.array([begin])
    times, speeds = [begin], [float(course.speed(here)[0])]
    for end, speed in zip(ends.tolist(), wanted.tolist(), strict=True):
        if end <= times[-1]:
            continue
        most = acceleration * (end - times[-1])
        change = 0.0 if isnan(speed) else speed - speeds[-1]
        speeds.append(speeds[-1] + min(max(change, -most), most))
        times.append(end)
    turned = float(course.revolutions(here)[0])
    return SpindleCourse(times=np.array(times), speeds=np.array(speeds), turned=turned)
