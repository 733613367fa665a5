"""Signal processing: readings of any period become spindle revolutions.

Readings of tooth periods show each tooth. Others, as the load of a drive at 5 to 100 Hz, are
averaged over a revolution at least, and show none: their revolutions have no values of teeth.

The third stage of [1]_, Fig. 5; control laws, warnings and estimates use its result. Units: mm,
s, N, W, rev/s.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Process monitoring and control" and Fig. 5.
"""

from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from controller.signals.ports import Floats, Reading
from controller.signals.spectrum import UNKNOWN, Spectrum, spectrum
from stepnc_model.tuples import quick_replace

COVERED = 0.5
"""Share of samples from which a revolution has a valid mean force."""

SAME_SPEED = 0.01
"""Relative change of spindle speed that load may cause; a larger one is another speed."""

NOT_A_TOOTH = 0.5
"""Share of a tooth period by which the last reading of a feed may be too long or too short."""

EXACT = 0.02
"""Share of a tooth period by which any other reading of teeth may differ from one."""

LATE = 0.5
"""Share of a reading by which it may begin late or early."""

WHOLE = 0.999
"""Turns from which a revolution is whole; times are rounded."""


@quick_replace
class Revolution(NamedTuple):
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
    normal: float = nan
    """Mean force normal to the edges, N; NaN: not measured, or lost in a reading."""
    by_teeth: bool = True
    """Whether its readings were tooth periods; if not, it may last some turns."""

    @property
    def turns(self) -> float:
        """Number of turns of the spindle that it lasts."""
        return self.period * self.spindle_speed

    @property
    def teeth(self) -> int:
        """Number of teeth of the cutter."""
        return len(self.tooth_peaks)

    @property
    def is_covered(self) -> bool:
        """True if enough samples arrived for a valid mean."""
        return self.coverage >= COVERED


class Collector:
    """Collector of readings into complete revolutions (mutable state).

    It begins a revolution with any tooth, and restarts when spindle speed, number of teeth or
    workingstep change, when some time is skipped, where the override does not act and where the
    spindle stands. A revolution in which all readings are tooth periods, none of them skipped,
    is one by teeth; any other is averaged over one turn or more.
    """

    __slots__ = ("_before", "_is_by_teeth", "_last", "_readings", "_turns")

    def __init__(self) -> None:
        self._readings: list[Reading] = []
        self._last: Reading | None = None
        self._before = 0.0
        self._turns = 0.0
        self._is_by_teeth = True

    def add(self, reading: Reading, *, is_tooth: bool = True) -> Revolution | None:
        """Add a conditioned reading; return the revolution if it completes one.

        Parameters
        ----------
        is_tooth : bool
            Whether it may be a tooth period; pieces that were put together are none.
        """
        if not reading.can_override or not reading.spindle_speed > 0.0:
            self._restart()
            self._last = None
            return None
        last = self._last
        if last is None or not follows(last, reading) or _is_skipped(last, reading):
            self._restart()
            # Progress runs at the rate of the override.
            self._before = reading.progress - reading.override * reading.period
        elif self._readings:
            # Only the last reading of a feed is a part of a tooth period.
            self._is_by_teeth &= _off(last) <= EXACT
        self._is_by_teeth &= is_tooth and _off(reading) <= NOT_A_TOOTH
        self._last = reading
        self._readings.append(reading)
        self._turns += reading.period * reading.spindle_speed
        return self._completed(reading)

    def _completed(self, reading: Reading) -> Revolution | None:
        """Revolution that the last reading completes, if any."""
        if self._is_by_teeth and len(self._readings) == reading.teeth:
            done = revolution(self._readings, progress_before=self._before)
        elif not self._is_by_teeth and self._turns >= WHOLE:
            done = averaged(self._readings, progress_before=self._before)
        else:
            return None
        self._restart()
        self._before = reading.progress
        return done

    def _restart(self) -> None:
        self._readings.clear()
        self._turns = 0.0
        self._is_by_teeth = True


class ToothJoiner:
    """Puts readings that are shorter than a tooth period together (mutable state).

    The force changes within a tooth period: a part of one says nothing on the load of a tooth.
    """

    __slots__ = ("_last", "_readings")

    def __init__(self) -> None:
        self._readings: list[Reading] = []
        self._last: Reading | None = None

    def add(self, reading: Reading) -> Reading | None:
        """Add a reading; return the reading of a tooth period or more, None before."""
        last, self._last = self._last, reading
        if not reading.can_override or _is_whole(last, reading):
            self._readings.clear()
            return reading
        if self._readings and not follows(self._readings[-1], reading):
            self._readings.clear()
        self._readings.append(reading)
        if sum(tooth_periods(each) for each in self._readings) < WHOLE:
            return None
        whole = _joined(self._readings)
        self._readings.clear()
        return whole


def _is_whole(last: Reading | None, reading: Reading) -> bool:
    """True if a reading is a tooth period or more, or what the end of a feed left of one."""
    periods = tooth_periods(reading)
    if periods >= 1.0 - EXACT:
        return True
    is_rest = last is not None and last.can_override and _off(last) <= EXACT
    return is_rest and periods >= 1.0 - NOT_A_TOOTH


def tooth_periods(reading: Reading) -> float:
    """Number of tooth periods that a reading lasts."""
    return reading.period * reading.spindle_speed * reading.teeth


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
    feeds, overrides = [each.feed for each in readings], [each.override for each in readings]
    teeth, first = len(readings), readings[0].tooth
    return Revolution(
        time=last.time,
        period=sum(each.period for each in readings),
        force=shown.force,
        peak=shown.peak,
        tooth_peaks=_by_number(shown.peaks, first),
        tooth_means=_by_number(shown.means, first),
        tooth_feeds=_by_number(np.array(feeds), first),
        tooth_overrides=_by_number(np.array(overrides), first),
        samples=len(last.force),
        first=first,
        coverage=shown.coverage,
        power=sum(powers) / len(powers) if powers else nan,
        feed=sum(feeds) / teeth,
        override=sum(overrides) / teeth,
        spindle_speed=last.spindle_speed,
        progress=last.progress,
        progress_before=progress_before,
        workingstep=last.workingstep,
        tooth_passing=shown.lines.tooth_passing,
        once_per_revolution=shown.lines.once_per_revolution,
        normal=_normal(readings),
    )


def averaged(readings: Sequence[Reading], *, progress_before: float) -> Revolution:
    """Combine readings that are no tooth periods into their mean over a turn or more.

    Parameters
    ----------
    readings : sequence of Reading
        Consecutive ones, in the order of time.
    progress_before : float, s
        Program time at an override of 1, when the first began.
    """
    whole = _joined(readings)
    values, unknown = whole.force, np.full(whole.teeth, nan)
    seen = values[~np.isnan(values)]
    shares = [_seen(each.force)[2] for each in readings]
    coverage = (
        sum(share * each.period for share, each in zip(shares, readings, strict=True))
        / whole.period
    )
    return Revolution(
        time=whole.time,
        period=whole.period,
        force=_mean(readings) if coverage >= COVERED else nan,
        peak=float(seen.max()) if len(seen) else nan,
        tooth_peaks=unknown,
        tooth_means=unknown,
        tooth_feeds=unknown,
        tooth_overrides=unknown,
        samples=1,
        first=readings[0].tooth,
        coverage=coverage,
        power=whole.power,
        feed=whole.feed,
        override=whole.override,
        spindle_speed=whole.spindle_speed,
        progress=whole.progress,
        progress_before=progress_before,
        workingstep=whole.workingstep,
        tooth_passing=nan,
        once_per_revolution=nan,
        normal=whole.normal,
        by_teeth=False,
    )


def _mean(readings: Sequence[Reading]) -> float:
    """Mean force over the time of readings, N; NaN if nothing is known."""
    known = [(float(_seen(each.force)[0]), each.period) for each in readings]
    known = [(value, period) for value, period in known if not isnan(value)]
    seconds = sum(period for _, period in known)
    return sum(value * period for value, period in known) / seconds if seconds else nan


def _joined(readings: Sequence[Reading]) -> Reading:
    """One reading of all the time of consecutive ones, with the mean force of each."""
    period = sum(each.period for each in readings)
    powers = [(each.power, each.period) for each in readings if not isnan(each.power)]
    seconds = sum(each for _, each in powers)
    # Readings of unequal lengths have no evenly spaced samples: the whole has its mean.
    return readings[-1]._replace(
        period=period,
        force=np.array([_mean(readings)]) if len(readings) > 1 else readings[0].force,
        power=sum(power * each for power, each in powers) / seconds if seconds else nan,
        feed=sum(each.feed * each.period for each in readings) / period,
        override=sum(each.override * each.period for each in readings) / period,
        normal=_normal(readings),
    )


def _normal(readings: Sequence[Reading]) -> float:
    """Mean normal force over the time of readings, N; NaN if one is not known."""
    if isnan(readings[0].normal):
        return nan
    seconds = sum(each.period for each in readings)
    return sum(each.normal * each.period for each in readings) / seconds


def _off(reading: Reading) -> float:
    """Share of a tooth period by which a reading is no tooth period."""
    return abs(tooth_periods(reading) - 1.0)


def _is_skipped(last: Reading, reading: Reading) -> bool:
    """True if a tooth is skipped between readings that are tooth periods."""
    is_next = reading.tooth == (last.tooth + 1) % last.teeth
    return not is_next and max(_off(last), _off(reading)) <= EXACT


def follows(last: Reading, reading: Reading) -> bool:
    """True if a reading directly continues the last one, without change or gap."""
    late = reading.time - reading.period - last.time
    return (
        reading.teeth == last.teeth
        and reading.workingstep == last.workingstep
        and abs(reading.spindle_speed - last.spindle_speed) <= SAME_SPEED * last.spindle_speed
        and abs(late) <= LATE * reading.period
    )


class _Shown(NamedTuple):
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
