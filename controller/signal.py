"""Signal processing: readings of single tooth periods become spindle revolutions.

The third stage of [1]_, Fig. 5; control laws, warnings and estimates use its result. Units: mm,
s, N, W, rev/s.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Process monitoring and control" and Fig. 5.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, nan

import numpy as np

from controller.ports import Floats, Reading
from controller.spectrum import UNKNOWN, Spectrum, spectrum

COVERED = 0.5
"""Share of samples from which a revolution has a valid mean force."""

SAME_SPEED = 0.01
"""Relative change of spindle speed that load may cause; a larger one is another speed."""

NOT_A_TOOTH = 0.5
"""Share of a tooth period by which a reading may be too long, too short or late."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Revolution:
    """Sensor values of one revolution of the spindle."""

    time: float
    """Time at the end of the revolution, s."""
    period: float
    """Duration of the revolution, s."""
    force: float
    """Mean force, every tooth weighted equally, N; NaN: less than half of the samples
    arrived."""
    peak: float
    """Greatest of the samples that arrived, N; NaN: none did."""
    tooth_peaks: Floats
    """Greatest force in the period of each tooth, by tooth number, (z,), N; NaN: all lost."""
    tooth_means: Floats
    """Mean force in the period of each tooth, (z,), N."""
    tooth_feeds: Floats
    """Mean feed in the period of each tooth, (z,), mm/s."""
    tooth_overrides: Floats
    """Mean override that the axes ran in the period of each tooth, (z,)."""
    samples: int
    """Number of samples per tooth period; 1: single teeth are not resolved."""
    first: int
    """Number of the tooth whose period came first."""
    coverage: float
    """Share of samples that were not lost."""
    power: float
    """Mean power of the main drive, W; NaN: all samples lost."""
    feed: float
    """Mean feed during the revolution, mm/s."""
    override: float
    """Mean override that the axes ran."""
    spindle_speed: float
    """Spindle speed, rev/s."""
    progress: float
    """Program time at an override of 1 at the end of the revolution, s."""
    progress_before: float
    """Program time at an override of 1 at the beginning of the revolution, s."""
    workingstep: int
    """Number of the workingstep, counted from 1; 0: none."""
    tooth_passing: float
    """Amplitude at the tooth passing frequency, N; NaN: not known."""
    once_per_revolution: float
    """Amplitude at the spindle frequency, N; NaN: not known."""

    @property
    def teeth(self) -> int:
        """Number of teeth of the cutter."""
        return len(self.tooth_peaks)

    @property
    def is_covered(self) -> bool:
        """Whether enough samples arrived for a valid mean."""
        return self.coverage >= COVERED


class Collector:
    """Collector of readings into complete revolutions (mutable state).

    It begins a revolution with any tooth, and restarts when spindle speed, number of teeth or
    workingstep change, when a tooth or some time is skipped, and after a reading that is not a
    tooth period: the override does not act, the spindle stands, or the reading is far too long
    or too short.
    """

    __slots__ = ("_before", "_last", "_readings")

    def __init__(self) -> None:
        self._readings: list[Reading] = []
        self._last: Reading | None = None
        self._before = 0.0

    def add(self, reading: Reading) -> Revolution | None:
        """Add a conditioned reading; return the revolution if it completes one."""
        if not _is_tooth(reading):
            self._readings.clear()
            self._last = None
            return None
        if self._last is None or not _follows(self._last, reading):
            self._readings.clear()
            # Progress runs at the rate of the override.
            self._before = reading.progress - reading.override * reading.period
        self._last = reading
        self._readings.append(reading)
        if len(self._readings) < reading.teeth:
            return None
        done = revolution(self._readings, progress_before=self._before)
        self._readings.clear()
        self._before = reading.progress
        return done


def revolution(readings: Sequence[Reading], *, progress_before: float) -> Revolution:
    """Combine readings of consecutive teeth into one revolution.

    Parameters
    ----------
    readings : sequence of Reading
        One of each tooth, in the order of time.
    progress_before : float, s
        Program time at an override of 1, when the first began.
    """
    last, shown = readings[-1], _shown(readings)
    powers = [each.power for each in readings if not isnan(each.power)]
    teeth, first = len(readings), readings[0].tooth
    return Revolution(
        time=last.time,
        period=sum(each.period for each in readings),
        force=shown.force,
        peak=shown.peak,
        tooth_peaks=_by_number(shown.peaks, first),
        tooth_means=_by_number(shown.means, first),
        tooth_feeds=_by_number(np.array([each.feed for each in readings]), first),
        tooth_overrides=_by_number(np.array([each.override for each in readings]), first),
        samples=len(last.force),
        first=first,
        coverage=shown.coverage,
        power=sum(powers) / len(powers) if powers else nan,
        feed=sum(each.feed for each in readings) / teeth,
        override=sum(each.override for each in readings) / teeth,
        spindle_speed=last.spindle_speed,
        progress=last.progress,
        progress_before=progress_before,
        workingstep=last.workingstep,
        tooth_passing=shown.lines.tooth_passing,
        once_per_revolution=shown.lines.once_per_revolution,
    )


def _is_tooth(reading: Reading) -> bool:
    """Whether a reading covers one tooth period at feed."""
    if not reading.can_override:
        return False
    periods = reading.period * reading.spindle_speed * reading.teeth
    return abs(periods - 1.0) <= NOT_A_TOOTH


def _follows(last: Reading, reading: Reading) -> bool:
    """Whether a reading directly continues the last one, without change or gap."""
    late = reading.time - reading.period - last.time
    return (
        reading.teeth == last.teeth
        and reading.tooth == (last.tooth + 1) % last.teeth
        and reading.workingstep == last.workingstep
        and abs(reading.spindle_speed - last.spindle_speed) <= SAME_SPEED * last.spindle_speed
        and abs(late) <= NOT_A_TOOTH * reading.period
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Shown:
    """Forces of one revolution from its samples, with the teeth in the order of time."""

    force: float
    peak: float
    means: Floats
    peaks: Floats
    coverage: float
    lines: Spectrum


def _shown(readings: Sequence[Reading]) -> _Shown:
    """Forces of a revolution; fast when no sample is missing."""
    teeth, count = len(readings), len(readings[0].force)
    samples = np.concatenate([each.force for each in readings])
    is_even = count > 0 and all(len(each.force) == count for each in readings)
    # A single lost sample makes the sum NaN.
    if not is_even or isnan(np.add.reduce(samples)):
        return _partly_shown(readings, samples)
    grid = samples.reshape(teeth, count)
    means, peaks = np.add.reduce(grid, axis=1) / count, np.maximum.reduce(grid, axis=1)
    return _Shown(
        force=float(np.add.reduce(means)) / teeth,
        peak=float(np.maximum.reduce(peaks)),
        means=means,
        peaks=peaks,
        coverage=1.0,
        lines=spectrum(samples, teeth),
    )


def _partly_shown(readings: Sequence[Reading], samples: Floats) -> _Shown:
    """Forces of a revolution with lost samples or unequal tooth periods."""
    means, peaks, shares = np.array([_seen(each.force) for each in readings]).T
    coverage = float(shares.mean())
    known = means[~np.isnan(means)]
    force, lines = float(known.mean()) if coverage >= COVERED else nan, UNKNOWN
    counts = {len(each.force) for each in readings}
    if coverage >= COVERED and 0 not in counts:
        filled = _filled(samples)
        lines = spectrum(filled, len(readings))
        if len(counts) == 1:
            # Lost samples differ from the others, as a tooth enters and leaves.
            force = float(filled.mean())
    return _Shown(
        force=force,
        peak=float(np.fmax.reduce(peaks)),
        means=means,
        peaks=peaks,
        coverage=coverage,
        lines=lines,
    )


def _seen(samples: Floats) -> tuple[float, float, float]:
    """Mean, peak and share of the samples of one tooth that were not lost."""
    seen = samples[~np.isnan(samples)]
    if not len(seen):
        return nan, nan, 0.0
    return float(seen.mean()), float(seen.max()), len(seen) / len(samples)


def _filled(samples: Floats) -> Floats:
    """Fill lost samples by interpolation between neighbours, cyclic over the revolution."""
    at = np.arange(len(samples))
    lost = np.isnan(samples)
    filled: Floats = np.interp(at, at[~lost], samples[~lost], period=len(samples))
    return filled


def _by_number(values: Floats, first: int) -> Floats:
    """Reorder values from the order of time to the order of tooth numbers."""
    if first == 0:
        return values
    cut = len(values) - first
    return np.concatenate((values[cut:], values[:cut]))
