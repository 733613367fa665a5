"""Virtual machine for closed-loop control: sensors to read and a feed override to set.

It walks through the cells of a :class:`NominalCourse`, one tooth period per reading. The feed
follows the override with a lag, and the forces follow from this feed and from hidden
influences. It satisfies the protocols of :mod:`controller.ports` without importing them. Units
mm, s, N, W, rev/s.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import ceil, exp, inf, pi
from typing import NamedTuple

import numpy as np

from simulator.errors import MachineSilent
from simulator.motion.segments import Floats, Ints
from simulator.physics.flank import CUTTING, NORMAL
from simulator.physics.milling import RADIAL_SHARE
from simulator.plant.course import SAMPLES, EngagedTeeth, NominalCourse, pattern
from simulator.plant.dynamometer import DYNAMOMETER, POWER_METER, Acquisition, Instrument
from simulator.plant.hidden import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading

LONGEST = 0.25
"""Longest reading without a tooth passing, s, so that the loop keeps running."""

SLOWEST = 0.1
"""Spindle speed below which the spindle counts as stopped, rev/s."""

NMM_S_PER_WATT = 1000.0

_FINE = 100.0  # reciprocal resolution to which patterns round angles and runout over feed


class TrueState(NamedTuple):
    """True state of the machine in the last period."""

    force: float = 0.0
    """Mean tangential force, N."""
    peak: float = 0.0
    """Greatest tangential force, N."""
    power: float = 0.0
    """Power of the main drive, W."""
    removal_rate: float = 0.0
    """Removal rate, mm³/s."""
    axial_depth: float = 0.0
    """Axial depth of cut, mm."""
    flank_wear: float = 0.0
    """Flank wear, mm."""
    cell: int = 0
    """Index of the cell in the course."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrumentation:
    """Instruments, drive efficiency and seed of the noise."""

    dynamometer: Instrument = DYNAMOMETER
    power_meter: Instrument = POWER_METER
    efficiency: float = 1.0
    """Efficiency of the main drive."""
    has_normal: bool = False
    """Whether the dynamometer shows the force normal to the edges too."""
    reading_period: float = 0.0
    """Time between readings, each the mean force since the last, s; 0: tooth periods."""
    jitter: float = 0.0
    """Greatest deviation of that time, as a share."""
    seed: int = 0


@dataclass(kw_only=True)
class _Now:
    """Current state of the machine in its course; a mutable object."""

    time: float = 0.0
    progress: float = 0.0
    cell: int = 0
    turned: int = 0
    """Number of tooth periods since the start of the run."""
    override: float = 1.0
    """Override that the axes actually follow."""
    commanded: float = 1.0
    tool: int = 0
    """Number of the tool that is cutting, or that cut last."""
    flank_wear: dict[int, float] = field(default_factory=dict)
    """Flank wear by tool number, mm."""
    broken: dict[int, int] = field(default_factory=dict)
    """Index of the broken tooth by tool number."""
    locked: float | None = None
    """Override that the axes run whatever is commanded."""
    turned_part: float = 0.0
    """Part of a tooth period that has passed, where readings are none."""
    silent_until: float = -inf
    is_cut_off: bool = False
    factors: dict[HiddenQuantity, float] = field(
        default_factory=lambda: {HiddenQuantity.DEPTH: 1.0, HiddenQuantity.HARDNESS: 1.0}
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Lagged:
    """Response of the axes within a period; kept until one of another length is asked for."""

    period: float
    steps: Floats
    """Share of the period at each sample, (K,)."""
    gone: Floats
    """Share of the difference to the command that is gone then, (K,)."""


class ControlledMachine:
    """Virtual machine with a feed override; a mutable object.

    Parameters
    ----------
    course : NominalCourse
    hidden : HiddenTruth
    bench : Instrumentation
    """

    def __init__(
        self, course: NominalCourse, hidden: HiddenTruth, bench: Instrumentation
    ) -> None:
        self.course = course
        self.hidden = hidden
        self.truth = TrueState()
        self._bench = bench
        forces, powers, normals, self._periods = np.random.default_rng(bench.seed).spawn(4)
        self._normals = Acquisition(bench.dynamometer, normals)
        self._forces = Acquisition(bench.dynamometer, forces)
        self._powers = Acquisition(bench.power_meter, powers)
        # A tooth that breaks before the first cut belongs to the first tool.
        self._now = _Now(tool=int(course.tool[course.can_override.argmax()]))
        self._changes = sorted(hidden.changes, key=lambda change: change.time)
        self._ends: list[float] = course.until.tolist()
        self._lagged = _Lagged(period=0.0, steps=np.empty(0), gone=np.empty(0))

    @property
    def time(self) -> float:
        """Time of the run, in seconds."""
        return self._now.time

    @property
    def commanded(self) -> float:
        """Last commanded override."""
        return self._now.commanded

    @property
    def share(self) -> float:
        """Completed share of the program, 0 to 1."""
        return self._now.progress / self.course.duration

    @property
    def factors(self) -> Mapping[HiddenQuantity, float]:
        """Current hidden factors on depth and hardness."""
        return self._now.factors

    def set(self, override: float, /) -> None:
        """Set the feed over the programmed feed; 0 holds the feed."""
        if not 0.0 <= override < inf:
            raise ValueError(f"override {override:g} must be at least 0 and finite")
        self._now.commanded = override

    def change(self, change: HiddenChange) -> None:
        """Apply a hidden change at the next reading, or later at its time."""
        self._changes = sorted((*self._changes, change), key=lambda each: each.time)

    def read(self) -> Reading | None:
        """Run one tooth period, or a wait without feed; return None at the end of the program.

        Raises
        ------
        MachineSilent
            If the connection to the machine is broken.
        """
        now, course = self._now, self.course
        if now.cell >= len(course):
            return None
        while self._changes and self._changes[0].time <= now.time:
            self._apply(self._changes.pop(0))
        if now.is_cut_off:
            raise MachineSilent(now.time)
        if course.can_override[now.cell]:
            return self._feed()
        return self._wait()

    def _apply(self, change: HiddenChange) -> None:
        match change.what:
            case HiddenQuantity.TOOTH:
                self._now.broken[self._now.tool] = int(change.value)
            case HiddenQuantity.LINE:
                self._now.is_cut_off = True
            case HiddenQuantity.OVERRIDE:
                self._now.locked = change.value
            case HiddenQuantity.SILENCE:
                self._now.silent_until = change.time + change.value
            case _:
                self._now.factors[change.what] = change.value

    def _wait(self) -> Reading:
        """Run a rapid, dwell or tool change at its own pace, up to the next change or feed."""
        now, course = self._now, self.course
        cell, step = now.cell, int(course.workingstep[now.cell])
        beyond = cell
        while (
            beyond < len(course)
            and not course.can_override[beyond]
            and course.workingstep[beyond] == step
            and (beyond == cell or self._ends[beyond] - now.progress <= LONGEST)
        ):
            beyond += 1
        end = min(self._ends[beyond - 1], now.progress + LONGEST)
        period = end - now.progress
        now.override = self._aim
        self._go_on(end, period)
        idle = float(course.idle_power[cell])
        self.truth = TrueState(power=idle, flank_wear=self._flank_wear, cell=cell)
        feed = float(course.feed[cell:beyond].max())
        still = np.zeros(SAMPLES)
        return self._reading(cell, period, still, feed=feed, tooth=0, override=now.override)

    def _feed(self) -> Reading:
        """Run one reading at the override, or less of it if the feed ends."""
        now, course, cell = self._now, self.course, self._now.cell
        now.tool = int(course.tool[cell])
        teeth, speed = int(course.teeth[cell]), float(course.spindle_speed[cell])
        passing = 1.0 / (teeth * speed) if speed > SLOWEST else LONGEST
        period = self._period(passing)
        count = max(SAMPLES, ceil(SAMPLES * period / passing))
        ways = self._ways(period, count)
        end = now.progress + float(ways[-1])
        until = self._feed_end(cell, end)
        if until < end:
            period *= _part(ways, until - now.progress)
            ways, end = self._ways(period, count), until
        now.override = self._aim + (now.override - self._aim) * self._left(period)
        overrides = _steps(ways) * (count / period)
        rows = self._rows(ways)
        last = int(rows[-1])
        cut = last if course.force[last] > 0.0 else cell
        tooth = now.turned % teeth
        chips, land = self._mean_forces(rows, overrides)
        mean: Floats = chips + land
        force = mean
        if course.force[cut] > 0.0:
            force = mean * self._shape(cut, tooth, count, periods=period / passing)
        override = float(ways[-1]) / period
        average = float(np.add.reduce(mean)) / count
        self.truth = self._truth(cut, mean=average, force=force, override=override)
        if self.truth.force > 0.0:
            now.flank_wear[now.tool] = self._flank_wear + self.hidden.wear_rate * period
        self._turn(period / passing)
        self._go_on(end, period)
        feed = override * float(course.feed[cell])
        if self._bench.reading_period:
            force = np.array([force.mean()])
        reading = self._reading(cell, period, force, feed=feed, tooth=tooth, override=override)
        return self._with_normal(reading, chips, land) if self._bench.has_normal else reading

    def _rows(self, ways: Floats) -> Ints:
        """Cell of each sample; of a tooth period within a cell, one for all of them."""
        progress, last = self._now.progress, len(self._ends) - 1
        begin, end = progress + float(ways[0]), progress + float(ways[-1])
        cell = min(bisect_left(self._ends, begin, lo=max(self._now.cell - 1, 0)), last)
        if begin <= end <= self._ends[cell] or cell == last:
            return np.array([cell])
        found = self.course.until.searchsorted(progress + ways, side="left")
        return np.minimum(found, last)

    @property
    def _aim(self) -> float:
        """Override towards which the axes go."""
        now = self._now
        return now.commanded if now.locked is None else now.locked

    def _period(self, passing: float) -> float:
        """Duration of the next reading, s, where a tooth takes some time to pass."""
        bench = self._bench
        if not bench.reading_period:
            return passing
        return bench.reading_period * (1.0 + bench.jitter * self._periods.uniform(-1.0, 1.0))

    def _turn(self, periods: float) -> None:
        """Turn the spindle on by some tooth periods."""
        now = self._now
        if not self._bench.reading_period:
            now.turned += 1
            return
        whole, now.turned_part = divmod(now.turned_part + periods, 1.0)
        now.turned += int(whole)

    def _shape(self, cell: int, tooth: int, count: int, *, periods: float) -> Floats:
        """Force of the teeth over their mean at each sample of a reading."""
        shape = self._pattern(cell)
        if not self._bench.reading_period:
            own: Floats = shape[tooth]
            return own
        begin = tooth + self._now.turned_part
        at = begin + periods * (np.arange(count) + 0.5) / count
        found: Floats = shape.ravel()[(at * SAMPLES).astype(np.int64) % shape.size]
        return found

    def _with_normal(self, reading: Reading, chips: Floats, land: Floats) -> Reading:
        """Add the force normal to the edges, as its channel shows it."""
        true = float(RADIAL_SHARE * chips.mean() + NORMAL / CUTTING * land.mean())
        is_lost = reading.time <= self._now.silent_until
        shown = self._normals.shown_one(
            true, time=reading.time, interval=reading.period, is_lost=is_lost
        )
        return reading._replace(normal=shown)

    def _truth(self, cut: int, *, mean: float, force: Floats, override: float) -> TrueState:
        course, depth = self.course, self._now.factors[HiddenQuantity.DEPTH]
        around = pi * float(course.diameter[cut]) * float(course.spindle_speed[cut])
        cutting = mean * around / NMM_S_PER_WATT
        return TrueState(
            force=mean,
            peak=float(force.max()),
            power=float(course.idle_power[cut]) + cutting / self._bench.efficiency,
            removal_rate=depth * override * float(course.removal_rate[cut]),
            axial_depth=depth * float(course.axial_depth[cut]),
            flank_wear=self._flank_wear,
            cell=cut,
        )

    @property
    def _flank_wear(self) -> float:
        """Flank wear of the tool that is cutting, mm."""
        return self._now.flank_wear.get(self._now.tool, self.hidden.flank_wear)

    def _left(self, seconds: float) -> float:
        """Remaining share of the difference to a commanded override after some seconds."""
        return exp(-seconds / self.hidden.servo_lag)

    def _ways(self, period: float, count: int) -> Floats:
        """Program time after each sample of a period, s; the override lags its command."""
        lag, aim = self.hidden.servo_lag, self._aim
        if self._lagged.period != period or len(self._lagged.steps) != count:
            steps = (np.arange(count) + 1.0) / count
            gone = 1.0 - np.exp(-period * steps / lag)
            self._lagged = _Lagged(period=period, steps=steps, gone=gone)
        known = self._lagged
        ways: Floats = (
            aim * period * known.steps + (self._now.override - aim) * lag * known.gone
        )
        return ways

    def _feed_end(self, cell: int, end: float) -> float:
        """Program time at which the current feed ends, at most the given time, s."""
        course, step = self.course, self.course.workingstep[cell]
        while cell < len(course) and course.can_override[cell]:
            if course.workingstep[cell] != step:
                break
            if self._ends[cell] >= end:
                return end
            cell += 1
        return self._ends[cell - 1]

    def _mean_forces(self, rows: Ints, overrides: Floats) -> tuple[Floats, Floats]:
        """Mean forces of chips and of the wear land over a revolution at each sample, N."""
        now, hidden, course = self._now, self.hidden, self.course
        factor = hidden.force_factor * now.factors[HiddenQuantity.HARDNESS]
        exponent = float(course.exponent[now.cell])
        chips: Floats = factor * course.force[rows] * overrides**exponent
        # The force on the wear land is independent of the chip.
        land: Floats = self._flank_wear * course.land_force[rows].astype(np.float64)
        depth = now.factors[HiddenQuantity.DEPTH]
        chips *= depth
        return chips, depth * land

    def _pattern(self, cell: int) -> Floats:
        course = self.course
        teeth, speed = int(course.teeth[cell]), float(course.spindle_speed[cell])
        per_tooth = self._now.override * float(course.feed[cell]) / (teeth * speed)
        runout = self.hidden.eccentricity / per_tooth if per_tooth > 0.0 else 0.0
        return pattern(
            EngagedTeeth(
                number=teeth,
                entry_angle=_rounded(float(course.entry_angle[cell])),
                exit_angle=_rounded(float(course.exit_angle[cell])),
                exponent=round(float(course.exponent[cell]), 4),
                lag=_rounded(self._now.factors[HiddenQuantity.DEPTH] * float(course.lag[cell])),
                runout=_rounded(runout),
                broken=self._now.broken.get(self._now.tool),
            )
        )

    def _go_on(self, end: float, period: float) -> None:
        """Advance to a point in the program."""
        now = self._now
        now.time += period
        now.progress = end
        now.cell = bisect_right(self._ends, end, lo=now.cell)

    def _reading(
        self,
        cell: int,
        period: float,
        force: Floats,
        *,
        feed: float,
        tooth: int,
        override: float,
    ) -> Reading:
        now, course = self._now, self.course
        is_lost = now.time <= now.silent_until
        interval = period / SAMPLES
        power = self._powers.shown_one(
            self.truth.power, time=now.time, interval=period, is_lost=is_lost
        )
        return Reading(
            time=now.time,
            period=period,
            force=self._forces.shown(force, time=now.time, interval=interval, is_lost=is_lost),
            power=power,
            feed=feed,
            override=override,
            spindle_speed=float(course.spindle_speed[cell]),
            teeth=int(course.teeth[cell]),
            tooth=tooth,
            progress=now.progress,
            workingstep=int(course.workingstep[cell]),
            can_override=bool(course.can_override[cell]),
        )


def _steps(ways: Floats) -> Floats:
    """Differences between samples, like numpy's ``diff`` with a zero prepended, but faster."""
    steps = ways.copy()
    steps[1:] -= ways[:-1]
    return steps


def _part(ways: Floats, way: float) -> float:
    """Share of a period after which a given part of its program time has passed."""
    known = np.concatenate(([0.0], ways))
    return float(np.interp(way, known, np.arange(len(known)))) / len(ways)


def _rounded(value: float) -> float:
    return round(value * _FINE) / _FINE
