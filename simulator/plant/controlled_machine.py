"""Virtual machine for closed-loop control: sensors to read and a feed override to set.

It walks through the cells of a :class:`NominalCourse`, one tooth period per reading. The feed
follows the override with a lag, and the forces follow from this feed and from hidden
influences. It satisfies the protocols of :mod:`controller.signals.ports` without importing
them. Units mm, s, N, W, rev/s.
"""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import ceil, exp, inf, pi
from typing import NamedTuple

import numpy as np

from simulator.errors import MachineSilent
from simulator.motion.segments import Floats
from simulator.physics.flank import CUTTING, NORMAL
from simulator.physics.milling import RADIAL_SHARE
from simulator.plant.course import SAMPLES, EngagedTeeth, NominalCourse, pattern
from simulator.plant.dynamometer import DYNAMOMETER, POWER_METER, Acquisition, Instrument
from simulator.plant.feed_samples import FeedSamples, view
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading
from stepnc_model.units import NMM_S_PER_WATT

LONGEST = 0.25
"""Longest reading without a tooth passing, s, so that the loop keeps running."""

SLOWEST = 0.1
"""Spindle speed below which the spindle counts as stopped, rev/s."""


# Python 3.11 looks up a member of an enumeration by a call.
_DEPTH, _HARDNESS = HiddenQuantity.DEPTH, HiddenQuantity.HARDNESS
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


class _Columns:
    """Columns of a course, as Python reads single cells fastest; no copies."""

    def __init__(self, course: NominalCourse) -> None:
        self.can_override = view(course.can_override)
        self.feed = view(course.feed)
        self.force = view(course.force)
        self.exponent = view(course.exponent)
        self.removal_rate = view(course.removal_rate)
        self.axial_depth = view(course.axial_depth)
        self.idle_power = view(course.idle_power)
        self.spindle_speed = view(course.spindle_speed)
        self.diameter = view(course.diameter)
        self.entry_angle = view(course.entry_angle)
        self.exit_angle = view(course.exit_angle)
        self.lag = view(course.lag)
        self.teeth = view(course.teeth)
        self.tool = view(course.tool)
        self.workingstep = view(course.workingstep)


class ControlledMachine:
    """Virtual machine with a feed override; a mutable object."""

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

    @property
    def course(self) -> NominalCourse:
        """Nominal course of the program; another one of the same cells may take its place."""
        return self._course

    @course.setter
    def course(self, course: NominalCourse) -> None:
        # All that is bound to the arrays of a course goes with it.
        self._course = course
        self._ends: list[float] = course.until.tolist()
        self._columns = _Columns(course)
        self._beyond = 0
        self._kept: dict[int, FeedSamples] = {}
        self._last_teeth: tuple[object, ...] = ()
        self._last_pattern = np.empty(0)

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
        now, columns, cell = self._now, self._columns, self._now.cell
        now.tool = columns.tool[cell]
        teeth, speed = columns.teeth[cell], columns.spindle_speed[cell]
        passing = 1.0 / (teeth * speed) if speed > SLOWEST else LONGEST
        period, aim, before = self._period(passing), self._aim, now.override
        count = max(SAMPLES, ceil(SAMPLES * period / passing))
        samples = self._samples(count)
        samples.go(now.progress, cell, override=before, aim=aim, period=period)
        end = now.progress + samples.way
        until = min(end, self._feed_end(cell))
        if until < end:
            period *= _part(samples.ways, until - now.progress)
            samples.go(now.progress, cell, override=before, aim=aim, period=period)
            end = until
        now.override = aim + (before - aim) * self._left(period)
        row, tooth = samples.row, now.turned % teeth
        cut = row if columns.force[row] > 0.0 else cell
        is_cut, periods = columns.force[cut] > 0.0, period / passing
        samples.shape[...] = self._shape(cut, tooth, count, periods=periods) if is_cut else 1.0
        wear = self._flank_wear
        mean = samples.cut(
            columns.exponent[cell],
            factor=self.hidden.force_factor * now.factors[_HARDNESS],
            depth=now.factors[_DEPTH],
            flank_wear=wear,
        )
        override = samples.way / period
        self.truth = self._truth(cut, mean=mean, peak=samples.peak, override=override)
        if mean > 0.0:
            now.flank_wear[now.tool] = wear + self.hidden.wear_rate * period
        self._turn(periods)
        self._go_on(end, period)
        force = (
            np.array([samples.force.mean()]) if self._bench.reading_period else samples.force
        )
        feed = override * columns.feed[cell]
        reading = self._reading(cell, period, force, feed=feed, tooth=tooth, override=override)
        return self._with_normal(reading, samples) if self._bench.has_normal else reading

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

    def _with_normal(self, reading: Reading, samples: FeedSamples) -> Reading:
        """Add the force normal to the edges, as its channel shows it."""
        chips, land = samples.chips.mean(), samples.land.mean()
        true = float(RADIAL_SHARE * chips + NORMAL / CUTTING * land)
        is_lost = reading.time <= self._now.silent_until
        shown = self._normals.shown_one(
            true, time=reading.time, interval=reading.period, is_lost=is_lost
        )
        return reading._replace(normal=shown)

    def _truth(self, cut: int, *, mean: float, peak: float, override: float) -> TrueState:
        columns, depth = self._columns, self._now.factors[_DEPTH]
        around = pi * columns.diameter[cut] * columns.spindle_speed[cut]
        cutting = mean * around / NMM_S_PER_WATT
        return TrueState(
            force=mean,
            peak=peak,
            power=columns.idle_power[cut] + cutting / self._bench.efficiency,
            removal_rate=depth * override * columns.removal_rate[cut],
            axial_depth=depth * columns.axial_depth[cut],
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

    def _samples(self, count: int) -> FeedSamples:
        """Samples of a reading, kept by their number; readings of a jitter have a few."""
        known = self._kept.get(count)
        if known is None:
            known = FeedSamples(self.course, count, self.hidden.servo_lag)
            self._kept[count] = known
        return known

    def _feed_end(self, cell: int) -> float:
        """Program time at which the feed of a cell ends, s."""
        if cell >= self._beyond:
            columns, beyond, step = self._columns, cell, self._columns.workingstep[cell]
            while (
                beyond < len(self._ends)
                and columns.can_override[beyond]
                and columns.workingstep[beyond] == step
            ):
                beyond += 1
            self._beyond = beyond
        return self._ends[self._beyond - 1]

    def _pattern(self, cell: int) -> Floats:
        columns, now = self._columns, self._now
        teeth, runout = columns.teeth[cell], 0.0
        if self.hidden.eccentricity:
            speed = columns.spindle_speed[cell]
            per_tooth = now.override * columns.feed[cell] / (teeth * speed)
            runout = self.hidden.eccentricity / per_tooth if per_tooth > 0.0 else 0.0
        arc = columns.entry_angle[cell], columns.exit_angle[cell], columns.lag[cell]
        depth, broken = now.factors[_DEPTH], now.broken.get(now.tool)
        wanted = (teeth, columns.exponent[cell], *arc, depth, runout, broken)
        # Most cells of a straight cut have the same arc.
        if wanted != self._last_teeth:
            self._last_teeth = wanted
            self._last_pattern = pattern(
                EngagedTeeth(
                    number=teeth,
                    entry_angle=_rounded(columns.entry_angle[cell]),
                    exit_angle=_rounded(columns.exit_angle[cell]),
                    exponent=round(columns.exponent[cell], 4),
                    lag=_rounded(depth * columns.lag[cell]),
                    runout=_rounded(runout),
                    broken=broken,
                )
            )
        return self._last_pattern

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
        now, columns = self._now, self._columns
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
            spindle_speed=columns.spindle_speed[cell],
            teeth=columns.teeth[cell],
            tooth=tooth,
            progress=now.progress,
            workingstep=columns.workingstep[cell],
            can_override=columns.can_override[cell],
        )


def _part(ways: Floats, way: float) -> float:
    """Share of a period after which a given part of its program time has passed."""
    known = np.concatenate(([0.0], ways))
    return float(np.interp(way, known, np.arange(len(known)))) / len(ways)


def _rounded(value: float) -> float:
    return round(value * _FINE) / _FINE
