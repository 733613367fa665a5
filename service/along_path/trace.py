"""Feed, force and power of a run along its path and over time, in bounded memory.

Lengths are those of the programmed path, so that runs of one path at different feeds have the
same places.
"""

from dataclasses import dataclass
from enum import IntEnum
from math import ceil

import numpy as np

from service.plots.buckets import BucketedRun, Buckets
from simulator.machine.samples import Episode
from simulator.machine.sensing import sensed
from simulator.motion.segments import Floats
from simulator.spec import Machine
from stepnc_model.units import kw_from_watts, mm_min_from_speed

INTERVAL = 0.02
"""Time between samples, s."""

MOST = 50_000
"""Largest number of samples at once."""

MOST_POINTS = 20_000
"""Largest number of points of the path that are kept."""


class PathSignal(IntEnum):
    """Signals that are kept; the value is the column index."""

    FEED = 0
    """mm/min."""
    FORCE = 1
    """N."""
    POWER = 2
    """Power of the spindle drive, kW."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathTrace:
    """Signals of a run."""

    along: BucketedRun
    """Signals by the length of the path, mm."""
    over_time: BucketedRun
    """Signals by the time, s."""
    points: Floats
    """Points of the path with the feed there, (P, 4), mm and mm/min."""


class PathTraceKeeper:
    """Collects the signals of a run. Running state."""

    def __init__(self) -> None:
        self.length = 0.0
        """Length of the path so far, mm."""
        self._along, self._over_time = Buckets(len(PathSignal)), Buckets(len(PathSignal))
        self._points: list[Floats] = []
        self._stride, self._count = 1, 0

    def add(self, episode: Episode, machine: Machine) -> None:
        """Add the signals of an episode."""
        count = ceil((episode.end - episode.begin) / INTERVAL)
        for first in range(0, count, MOST):
            rows = np.arange(first, min(first + MOST, count)) + 0.5
            self._add(
                episode, machine, episode.begin + rows / count * (episode.end - episode.begin)
            )
        if episode.course is not None:
            self.length += float(episode.course.offsets[-1])

    def _add(self, episode: Episode, machine: Machine, times: Floats) -> None:
        samples = sensed(episode, machine, times)
        values = np.column_stack((
            mm_min_from_speed(1.0) * samples.path_speed,
            samples.cutting_force,
            kw_from_watts(1.0) * samples.spindle_power,
        ))
        self._over_time.add(times, values)
        if episode.course is None:
            return
        at = episode.kinematics(times)
        where = self.length + episode.course.offsets[at.segment] + at.station
        is_new = np.diff(where, prepend=-np.inf) > 0.0
        self._along.add(where[is_new], values[is_new])
        self._keep(np.column_stack((samples.position, values[:, PathSignal.FEED])))

    def _keep(self, points: Floats) -> None:
        """Keep every n-th point; n doubles whenever there are too many."""
        self._points.append(points[(-self._count) % self._stride :: self._stride])
        self._count += len(points)
        if sum(map(len, self._points)) > MOST_POINTS:
            self._points = [np.concatenate(self._points)[::2]]
            self._stride *= 2

    def trace(self) -> PathTrace:
        """Return the signals collected so far."""
        points = np.concatenate(self._points) if self._points else np.empty((0, 4))
        return PathTrace(
            along=self._along.trace(), over_time=self._over_time.trace(), points=points
        )
