"""Speed of the spindle by time: ramps at its acceleration, and following of the radius.

Piecewise linear in time, so that speed, acceleration and angle are closed form. rev/s, s.
"""

from dataclasses import dataclass
from math import inf, isnan

import numpy as np

from simulator.motion.segments import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpindleCourse:
    """Speed at knots; straight between them, constant before the first and after the last."""

    times: Floats
    """Times, (K,) s, ascending"""
    speeds: Floats
    """Speeds, (K,) rev/s, positive clockwise"""
    turned: float = 0.0
    """revolutions made until the first knot"""

    @property
    def reached(self) -> float:
        """Time at which the last speed is reached, s."""
        return float(self.times[-1])

    @property
    def target(self) -> float:
        """Last speed, rev/s."""
        return float(self.speeds[-1])

    def speed(self, times: Floats) -> Floats:
        """Speed at times, rev/s."""
        return np.interp(times, self.times, self.speeds)

    def acceleration(self, times: Floats) -> Floats:
        """Acceleration at times, rev/s²; that of the piece that begins at a knot."""
        if len(self.times) == 1:
            return np.zeros_like(times)
        spans = np.diff(self.times)
        slopes = np.zeros(len(self.times) + 1)
        np.divide(np.diff(self.speeds), spans, out=slopes[1:-1], where=spans > 0.0)
        return slopes[np.searchsorted(self.times, times, side="right")]

    def revolutions(self, times: Floats) -> Floats:
        """Revolutions made until times."""
        means = 0.5 * (self.speeds[1:] + self.speeds[:-1])
        made = np.concatenate(([0.0], np.cumsum(means * np.diff(self.times))))
        row = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, None)
        since = times - self.times[row]
        mean = 0.5 * (self.speed(times) + self.speeds[row])
        return self.turned + made[row] + mean * since


def standing(time: float, speed: float = 0.0) -> SpindleCourse:
    """A spindle that keeps its speed."""
    return SpindleCourse(times=np.array([time]), speeds=np.array([speed]))


def ramped(
    course: SpindleCourse, now: float, speed: float, *, acceleration: float | None
) -> SpindleCourse:
    """The course from now on when the spindle goes to another speed at once.

    Parameters
    ----------
    course : SpindleCourse
        Until now.
    now : float, s
    speed : float, rev/s
        Signed.
    acceleration : float, rev/s², or None
        None: without delay.
    """
    here = np.array([now])
    current = float(course.speed(here)[0])
    turned = float(course.revolutions(here)[0])
    span = abs(speed - current) / (acceleration or inf)
    times, speeds = [now, now + span], [current, speed]
    if current * speed < 0.0:
        # Standing for a moment is a knot of its own: friction turns round there.
        times.insert(1, now + span * current / (current - speed))
        speeds.insert(1, 0.0)
    return SpindleCourse(times=np.array(times), speeds=np.array(speeds), turned=turned)


def following(
    course: SpindleCourse, begin: float, ends: Floats, *, wanted: Floats, acceleration: float
) -> SpindleCourse:
    """The course when the spindle follows the radius, as fast as it can.

    Parameters
    ----------
    course : SpindleCourse
        Until now.
    begin : float, s
    ends : (N,) array, s
        When each piece of the path ends.
    wanted : (N,) array, rev/s
        Speed at the end of each; NaN: as it is.
    acceleration : float, rev/s²
        Infinite: without delay.
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
