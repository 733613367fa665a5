"""Signal processing: readings of single tooth periods become revolutions of the spindle.

The third stage of [1]_, Fig. 5: what the control laws, the warning and the estimates live on.
Units mm, s, N, W, rev/s.

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
"""share of samples from which a revolution has a mean force"""

SAME_SPEED = 0.01
"""of the spindle speed: a load slows a spindle by less, another speed is farther away"""

NOT_A_TOOTH = 0.5
"""of a tooth period by which a reading may be longer or shorter, or begin late"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Revolution:
    """Sensor values of one revolution of the spindle."""

    time: float
    """s, at its end"""
    period: float
    """s that it covers"""
    force: float
    """N, mean; every tooth counts the same. NaN: less than half of the samples arrived"""
    peak: float
    """N, greatest of the samples that arrived; NaN: none did"""
    tooth_peaks: Floats
    """(z,) N, greatest while each tooth was the last to enter, by number; NaN: all were lost"""
    tooth_means: Floats
    """(z,) N, the means to the peaks"""
    tooth_feeds: Floats
    """(z,) mm/s, means to the peaks"""
    tooth_overrides: Floats
    """(z,) that the axes ran, means to the peaks"""
    samples: int
    """in a tooth period; 1: single teeth are not told apart"""
    first: int
    """tooth whose period came first"""
    coverage: float
    """share of samples that were not lost"""
    power: float
    """W of the main drive, mean; NaN: all were lost"""
    feed: float
    """mm/s, mean"""
    override: float
    """that the axes ran, mean"""
    spindle_speed: float
    """rev/s"""
    progress: float
    """s of the program at an override of 1, at its end"""
    progress_before: float
    """the same at its begin"""
    workingstep: int
    """counted from 1; 0: none"""
    tooth_passing: float
    """N, amplitude; NaN: not known"""
    once_per_revolution: float
    """N, amplitude; NaN: not known"""

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return len(self.tooth_peaks)

    @property
    def is_covered(self) -> bool:
        """Whether enough samples arrived for a mean."""
        return self.coverage >= COVERED


class Collector:
    """Gathers readings until the last tooth of a revolution. Running state.

    It begins a revolution with whichever tooth comes, and begins anew when spindle speed,
    number of teeth or workingstep change, when a tooth or a time is left out, and after a
    reading that is no tooth period: the override does not act, the spindle stands, or the
    reading is far too long or too short.
    """

    __slots__ = ("_before", "_last", "_readings")

    def __init__(self) -> None:
        self._readings: list[Reading] = []
        self._last: Reading | None = None
        self._before = 0.0

    def add(self, reading: Reading) -> Revolution | None:
        """Take one more reading, conditioned; the revolution, if this completes one."""
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
    """The revolution that readings of consecutive teeth make.

    Parameters
    ----------
    readings : sequence of Reading
        One of each tooth, in the order of time.
    progress_before : float, s
        Of the program at an override of 1, when the first began.
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
    """Whether nothing changed, and no tooth and no time were left out."""
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
    """Revolution made of samples, with teeth in the order of time."""

    force: float
    peak: float
    means: Floats
    peaks: Floats
    coverage: float
    lines: Spectrum


def _shown(readings: Sequence[Reading]) -> _Shown:
    """Forces of a revolution, the quick way when nothing is missing."""
    teeth, count = len(readings), len(readings[0].force)
    samples = np.concatenate([each.force for each in readings])
    is_even = count > 0 and all(len(each.force) == count for each in readings)
    # One lost sample makes the sum NaN.
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
    """Forces of a revolution of which samples were lost, or that has unlike tooth periods."""
    means, peaks, shares = np.array([_seen(each.force) for each in readings]).T
    coverage = float(shares.mean())
    known = means[~np.isnan(means)]
    force, lines = float(known.mean()) if coverage >= COVERED else nan, UNKNOWN
    counts = {len(each.force) for each in readings}
    if coverage >= COVERED and 0 not in counts:
        filled = _filled(samples)
        lines = spectrum(filled, len(readings))
        if len(counts) == 1:
            # What is lost is not like what is there: a tooth enters, and leaves.
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
    """Mean, peak and share of what was not lost of one tooth."""
    seen = samples[~np.isnan(samples)]
    if not len(seen):
        return nan, nan, 0.0
    return float(seen.mean()), float(seen.max()), len(seen) / len(samples)


def _filled(samples: Floats) -> Floats:
    """Samples with lost ones on a line between their neighbours, round the revolution."""
    at = np.arange(len(samples))
    lost = np.isnan(samples)
    filled: Floats = np.interp(at, at[~lost], samples[~lost], period=len(samples))
    return filled


def _by_number(values: Floats, first: int) -> Floats:
    """Values in the order of time, from the first tooth on, in the order of the teeth."""
    if first == 0:
        return values
    cut = len(values) - first
    return np.concatenate((values[cut:], values[:cut]))
