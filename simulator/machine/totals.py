"""Time, energy and peak loads of a run by workingstep, independent of the sampling rate.

Powers are integrated with two Gauss points between the times at which they are not smooth: this
is exact for straight moves, whose powers are quadratic in time; elsewhere the accuracy depends
on the spacing of the stations. The time within a ramp at which braking begins to need power is
not located; ramps of the spindle are divided finely instead. Peaks are also searched at both
ends of each span. Units s, J, W, N, mm³.
"""

from dataclasses import dataclass, field, replace
from math import pi, sqrt

import numpy as np

from simulator.machine.samples import Condition, Episode, PathMode, Samples
from simulator.machine.sensing import main_power, sensed
from simulator.motion.segments import Floats
from simulator.spec import Machine
from stepnc_model.units import NMM_S_PER_WATT

PLACES = np.array([1e-6, 0.5 - 0.5 / sqrt(3.0), 0.5 + 0.5 / sqrt(3.0), 1.0 - 1e-6])
"""Sample points on 0 to 1: just inside the ends, and the abscissae of the two-point rule."""

WEIGHTS = np.array([0.0, 0.5, 0.5, 0.0])

RAMP_STEP = 0.05
"""Longest time step within a ramp of the spindle, s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Energy:
    """Electrical energy by component, J."""

    x_axis: float = 0.0
    y_axis: float = 0.0
    z_axis: float = 0.0
    spindle: float = 0.0
    """Energy of the spindle drive, including cutting, J."""
    coolant: float = 0.0
    base: float = 0.0

    @property
    def total(self) -> float:
        """Total energy of all components, J."""
        axes = self.x_axis + self.y_axis + self.z_axis
        return axes + self.spindle + self.coolant + self.base

    def __add__(self, other: "Energy") -> "Energy":
        return Energy(
            x_axis=self.x_axis + other.x_axis,
            y_axis=self.y_axis + other.y_axis,
            z_axis=self.z_axis + other.z_axis,
            spindle=self.spindle + other.spindle,
            coolant=self.coolant + other.coolant,
            base=self.base + other.base,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """Greatest value of a quantity, with its time and program line."""

    value: float = 0.0
    time: float = 0.0
    """Time of the greatest value, s."""
    line: int = 0

    def or_greater(self, values: Floats, samples: Samples) -> "Peak":
        """Return the greater of this peak and the peak of further samples."""
        at = int(values.argmax())
        if values[at] <= self.value:
            return self
        return Peak(
            value=float(values[at]), time=float(samples.time[at]), line=int(samples.line[at])
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Total:
    """Time, energy and peak loads of one workingstep, or of the time between workingsteps."""

    duration: float = 0.0
    """Duration, s."""
    cutting_time: float = 0.0
    """Time with chips, s."""
    rapid_time: float = 0.0
    """Time in rapid, s."""
    waiting_time: float = 0.0
    """Time at rest, s: pauses, tool changes, waiting for the spindle."""
    way_time: float = 0.0
    """Time before and after the path, s: tool change, spindle start, approach and retract."""
    energy: Energy = field(default_factory=Energy)
    cutting_energy: float = 0.0
    """Cutting energy at the edge, J."""
    volume: float = 0.0
    """Removed volume, mm³."""
    power: Peak = field(default_factory=Peak)
    """Peak power of the spindle drive, W."""
    cutting_power: Peak = field(default_factory=Peak)
    """Peak cutting power at the edge, W."""
    drive_power: Peak = field(default_factory=Peak)
    """Peak power of the spindle drive while cutting, W: cutting and idle power, without the
    power that accelerates the spindle at constant surface speed."""
    force: Peak = field(default_factory=Peak)
    """Peak tangential force, N; without the plunges of mills."""
    thrust: Peak = field(default_factory=Peak)
    """Peak thrust of drills and plunges, N."""
    torque: Peak = field(default_factory=Peak)
    """Peak torque of the cut at the spindle, N·mm."""
    chip: Peak = field(default_factory=Peak)
    """Peak mean chip thickness, mm."""
    deflection: Peak = field(default_factory=Peak)
    """Peak deflection of an end mill while it generates a wall, mm."""
    overload_time: float = 0.0
    """Time above the continuous power or the permitted force, s."""

    @property
    def air_time(self) -> float:
        """Time in feed without chips, s."""
        known = self.cutting_time + self.rapid_time + self.waiting_time
        return max(self.duration - known, 0.0)

    def plus(self, other: "Total") -> "Total":
        """Sum of two totals, with the greater of their peaks."""
        return Total(
            duration=self.duration + other.duration,
            cutting_time=self.cutting_time + other.cutting_time,
            rapid_time=self.rapid_time + other.rapid_time,
            waiting_time=self.waiting_time + other.waiting_time,
            way_time=self.way_time + other.way_time,
            energy=self.energy + other.energy,
            cutting_energy=self.cutting_energy + other.cutting_energy,
            volume=self.volume + other.volume,
            power=max(self.power, other.power, key=_value),
            cutting_power=max(self.cutting_power, other.cutting_power, key=_value),
            drive_power=max(self.drive_power, other.drive_power, key=_value),
            force=max(self.force, other.force, key=_value),
            thrust=max(self.thrust, other.thrust, key=_value),
            torque=max(self.torque, other.torque, key=_value),
            chip=max(self.chip, other.chip, key=_value),
            deflection=max(self.deflection, other.deflection, key=_value),
            overload_time=self.overload_time + other.overload_time,
        )


def _value(peak: Peak) -> float:
    return peak.value


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Quadrature:
    """Times and weights with which powers of an episode are integrated over K spans."""

    nodes: Floats
    """Times between which all powers are smooth, (K + 1,), s."""
    times: Floats
    """Times within each span, (K, 4), s from the start of the program; the first and the last
    have no weight and are for peaks."""
    weights: Floats
    """Weights of these times, (K, 4), s."""


def quadrature(episode: Episode) -> Quadrature:
    """Quadrature of an episode; without spans if the episode takes no time."""
    nodes = _nodes(episode)
    spans = np.diff(nodes)[:, None]
    return Quadrature(
        nodes=nodes, times=nodes[:-1, None] + spans * PLACES, weights=spans * WEIGHTS
    )


def added(total: Total, episode: Episode, machine: Machine) -> Total:
    """Add an episode to a total."""
    total = replace(total, duration=total.duration + episode.end - episode.begin)
    places = quadrature(episode)
    if not len(places.times):
        return total
    weights = places.weights.ravel()
    samples = sensed(episode, machine, places.times.ravel())
    axes = weights @ samples.axis_power
    energy = Energy(
        x_axis=float(axes[0]),
        y_axis=float(axes[1]),
        z_axis=float(axes[2]),
        spindle=float(weights @ samples.spindle_power),
        coolant=float(weights @ samples.coolant_power),
        base=float(weights @ samples.base_power),
    )
    # A rapid through material is not a cut but a collision, and reported as such.
    feeds = samples.path_mode != PathMode.RAPID
    is_loaded = samples.overload != Condition.NORMAL
    return replace(
        total,
        cutting_time=total.cutting_time + float(weights @ (samples.removal_rate > 0.0)),
        rapid_time=total.rapid_time + float(weights @ (samples.path_mode == PathMode.RAPID)),
        waiting_time=total.waiting_time + float(weights @ (samples.path_mode == PathMode.NONE)),
        energy=total.energy + energy,
        cutting_energy=total.cutting_energy + float(weights @ samples.cutting_power),
        volume=total.volume + float(weights @ samples.removal_rate),
        way_time=total.way_time + _time_off_path(episode),
        power=total.power.or_greater(samples.spindle_power, samples),
        cutting_power=total.cutting_power.or_greater(feeds * samples.cutting_power, samples),
        drive_power=total.drive_power.or_greater(
            np.where(samples.removal_rate > 0.0, feeds * _steady(samples, episode, machine), 0),
            samples,
        ),
        force=total.force.or_greater(feeds * _across(samples, episode), samples),
        thrust=total.thrust.or_greater(feeds * samples.thrust, samples),
        torque=total.torque.or_greater(feeds * _torque(samples), samples),
        chip=total.chip.or_greater(feeds * samples.chip_thickness, samples),
        deflection=total.deflection.or_greater(feeds * samples.deflection, samples),
        overload_time=total.overload_time + float(weights @ is_loaded),
    )


def _steady(samples: Samples, episode: Episode, machine: Machine) -> Floats:
    """Power of the spindle drive at constant speed, W."""
    still = np.zeros(len(samples.time))
    power: Floats = main_power(
        machine, samples.spindle_speed, still, cutting_power=samples.cutting_power
    )
    if episode.course is None or episode.course.power_factor is None:
        return power
    return episode.power_factor(episode.kinematics(samples.time)) * power


def _time_off_path(episode: Episode) -> float:
    """Time of an episode before and after the path of its workingstep, s."""
    course = episode.course
    if course is None:
        return episode.end - episode.begin if episode.state.is_way else 0.0
    ends = course.motion.ends
    there = float(ends[course.way - 1]) if course.way else 0.0
    back = float(ends[-1] - ends[-1 - course.back]) if course.back else 0.0
    return there + back


def _torque(samples: Samples) -> Floats:
    """Torque of the cut at the spindle, N·mm."""
    around = 2.0 * pi * np.abs(samples.spindle_speed)
    turning = around > 0.0
    watts = np.divide(samples.cutting_power, around, out=np.zeros(len(around)), where=turning)
    return NMM_S_PER_WATT * watts


def _across(samples: Samples, episode: Episode) -> Floats:
    """Cutting force without plunges of a mill, N."""
    course = episode.course
    if course is None or course.edge is None or course.edge.flutes is None:
        return samples.cutting_force
    return np.where(samples.thrust > 0.0, 0.0, samples.cutting_force)


def _nodes(episode: Episode) -> Floats:
    """Times at which some power is not smooth, both ends included, s."""
    ends = np.array([episode.begin, episode.end])
    places = [ends, _ramps(episode.spindle.times)]
    if episode.course is not None:
        places.append(episode.begin + episode.course.nodes)
    nodes = np.unique(np.concatenate(places))
    return nodes[(nodes >= episode.begin) & (nodes <= episode.end)]


def _ramps(knots: Floats) -> Floats:
    """Knots of the spindle's course, with further times between them, s."""
    spans = np.diff(knots)
    count = np.maximum(np.ceil(spans / RAMP_STEP).astype(np.int64), 1)
    rows = np.repeat(np.arange(len(spans)), count)
    index = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count)
    return np.append(knots[rows] + spans[rows] * index / count[rows], knots[-1])
