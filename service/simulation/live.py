"""Live data of a simulated run: samples as rows in the user's units, for other processes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import inf
from typing import Any

import numpy as np

from service.live.journal import LiveFolder
from service.live.playback import PlaybackClock
from service.live.series import SeriesWriter
from simulator.errors import SimulationError
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats
from stepnc_model.units import mm_min_from_speed, rpm_from_rev_s

MM_MIN, RPM = mm_min_from_speed(1.0), rpm_from_rev_s(1.0)
"""Feed of 1 mm/s in mm/min, and speed of 1 rev/s in rpm."""

CM3_MIN = 0.001 * mm_min_from_speed(1.0)
"""Removal rate of 1 mm³/s, in cm³/min."""

COLUMNS: Mapping[str, Callable[[Samples], Floats]] = {
    "time_s": lambda samples: samples.time,
    "x_mm": lambda samples: samples.position[:, 0],
    "y_mm": lambda samples: samples.position[:, 1],
    "z_mm": lambda samples: samples.position[:, 2],
    "feed_programmed_mm_min": lambda samples: MM_MIN * samples.feed_programmed,
    "feed_actual_mm_min": lambda samples: MM_MIN * samples.path_speed,
    "spindle_speed_rpm": lambda samples: RPM * samples.spindle_speed,
    "x_power_w": lambda samples: samples.axis_power[:, 0],
    "y_power_w": lambda samples: samples.axis_power[:, 1],
    "z_power_w": lambda samples: samples.axis_power[:, 2],
    "spindle_power_w": lambda samples: samples.spindle_power,
    "coolant_power_w": lambda samples: samples.coolant_power,
    "base_power_w": lambda samples: samples.base_power,
    "total_power_w": lambda samples: samples.total_power,
    "cutting_force_n": lambda samples: samples.cutting_force,
    "removal_rate_cm3_min": lambda samples: CM3_MIN * samples.removal_rate,
    "axial_depth_mm": lambda samples: samples.axial_depth,
    "radial_width_mm": lambda samples: samples.radial_width,
    "execution": lambda samples: samples.execution.astype(np.float64),
    "path_mode": lambda samples: samples.path_mode.astype(np.float64),
    "overload": lambda samples: samples.overload.astype(np.float64),
    "tool": lambda samples: samples.tool.astype(np.float64),
    "workingstep": lambda samples: samples.workingstep.astype(np.float64),
}
"""Columns of a row; enumerations are those of :mod:`simulator.machine.samples`."""


SHOWN = 0.1
"""Wall-clock time between two updates of a paced run, in s."""

MOST_SAMPLES = 20_000_000
"""Largest number of samples of a run, some gigabytes in a file."""


class LiveSamples:
    """Writes the samples of a run as live rows; enter its writer with ``with``. Running state.

    Parameters
    ----------
    paced : callable
        Function that waits until the machine may have come to a time, in s.
    apart : float, s
        Machine time between two updates, so that a paced run shows nothing too early.
    """

    def __init__(
        self, folder: LiveFolder, paced: Callable[[float], None], *, apart: float = inf
    ) -> None:
        self.writer = SeriesWriter(folder.series, list(COLUMNS))
        self._folder, self._paced, self._apart = folder, paced, apart
        self._workingsteps: Sequence[str] = ()
        self._count = 0

    def begin(self, workingsteps: Sequence[str]) -> None:
        """Store the workingstep ids, as a ``SampleWatcher`` does."""
        self._workingsteps = workingsteps

    def add(self, samples: Samples) -> None:
        """Write samples as rows, as a ``SampleWatcher`` does.

        Raises
        ------
        SimulationError
            When there are more samples than can be stored.
        StorageFull, Unavailable
            When the rows cannot be written.
        """
        if not len(samples):
            return
        self._count += len(samples)
        if self._count > MOST_SAMPLES:
            text = f"more than {MOST_SAMPLES} samples until {samples.time[0]:.0f} s"
            raise SimulationError(f"{text}: choose a lower sampling rate")
        rows = np.column_stack([of(samples) for of in COLUMNS.values()])
        ends = np.flatnonzero(np.diff(samples.time // self._apart)) + 1
        first = 0
        for end in [*ends.tolist(), len(samples)]:
            self.writer.add(rows[first:end])
            self._folder.write_status(self._status(samples, end - 1))
            self._paced(float(samples.time[end - 1]))
            first = end

    def _status(self, samples: Samples, at: int) -> dict[str, Any]:
        number = int(samples.workingstep[at])
        return {
            "time_s": float(samples.time[at]),
            "workingstep": self._workingsteps[number - 1] if number else None,
            "workingsteps": list(self._workingsteps),
            "is_series_full": self.writer.is_full,
        }


@contextmanager
def watched(folder: LiveFolder, pace: float) -> Iterator[LiveSamples]:
    """Watch a run at a pace, in simulated seconds per wall-clock second; 0: no waiting."""
    clock = PlaybackClock(pace)
    live = LiveSamples(folder, clock.wait_for, apart=clock.factor * SHOWN or inf)
    with live.writer:
        yield live
