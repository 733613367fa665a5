"""Exact sensor values at given times of an episode, including the power of all components.

Units mm, s, N, W, rev/s.
"""

from collections.abc import Iterator
from math import ceil

import numpy as np

from simulator.machine.cutting import CuttingLoads, cutting_loads, no_loads, worn_loads
from simulator.machine.samples import (
    Condition,
    Episode,
    EpisodeCourse,
    Execution,
    PathMode,
    Samples,
)
from simulator.machine.tooth_loads import bent, entered_loads, tooth_loads
from simulator.motion.segments import AXES, Floats, Ints, Kinematics
from simulator.physics.axis import axis_power
from simulator.physics.spindle import curve_segments, spindle_power
from simulator.removal.stations import StationKind
from simulator.spec import Machine

FAULT_SHARE = 1.5
"""Load at which a drive faults, over its continuous power: customary limit for one minute."""


def axes_power(
    machine: Machine, velocity: Floats, acceleration: Floats, *, feed_force: Floats
) -> Floats:
    """Electrical power of the axes X, Y and Z.

    Parameters
    ----------
    machine : Machine
        An axis without a known drive has no power.
    velocity, acceleration : (M, 3) array, mm/s and mm/s²
    feed_force : (M,) array, N
        Force against the path; each axis takes its share by direction.

    Returns
    -------
    (M, 3) array, W
    """
    power = np.zeros_like(velocity)
    speed = np.linalg.norm(velocity, axis=1)
    moving = np.where(speed > 0.0, speed, 1.0)
    for axis in machine.axes:
        if axis.drive is not None and axis.name in AXES:
            row = AXES.index(axis.name)
            share = np.abs(velocity[:, row]) / moving
            power[:, row] = axis_power(
                axis.drive,
                velocity[:, row],
                acceleration[:, row],
                feed_force=feed_force * share,
            )
    return power


def main_power(
    machine: Machine, speed: Floats, acceleration: Floats, *, cutting_power: Floats
) -> Floats:
    """Power of the spindle drive, W, from speeds in rev/s and cutting power in W."""
    return np.asarray(
        spindle_power(machine.spindle, speed, acceleration, cutting_power=cutting_power)
    )


def continuous_power(machine: Machine, speed: Floats) -> Floats:
    """Continuous power of the spindle drive at speeds in rev/s, W."""
    power = np.full(len(speed), np.inf)
    around = np.abs(speed)
    for part in curve_segments(machine.spindle):
        inside = (around > 0.0) & (around >= part.min_speed) & (around <= part.max_speed)
        power[inside] = part.power_coefficient * around[inside] ** part.power_exponent
    return power


def overload(machine: Machine, cutting_power: Floats, speed: Floats, *, force: Floats) -> Ints:
    """Load condition of the spindle drive, also considering the permitted force.

    As in the optimiser, cutting power over efficiency is compared with the continuous power.
    Ramps of the spindle are ignored because they are short enough for the drive.
    """
    power = cutting_power / machine.spindle.efficiency
    share = power / continuous_power(machine, speed)
    if machine.max_cutting_force is not None:
        share = np.maximum(share, force / machine.max_cutting_force)
    return np.where(
        share > FAULT_SHARE,
        int(Condition.FAULT),
        np.where(share > 1.0, int(Condition.WARNING), int(Condition.NORMAL)),
    )


ROUNDING = 1e-9
"""Tolerance for a sample beyond the end of an episode, as a share of the interval."""

MOST = 65_536
"""Largest number of samples computed at once."""


class Sampler:
    """Takes samples at a constant rate from the start of the program; a mutable object.

    Parameters
    ----------
    rate : float, 1/s
    """

    def __init__(self, machine: Machine, *, rate: float) -> None:
        self._machine = machine
        self._rate = rate
        self._next = 0

    def samples(self, episode: Episode) -> Iterator[Samples]:
        """Samples of the next episode in parts; a short episode may have none."""
        beyond = ceil(episode.end * self._rate - ROUNDING)
        if episode.state.execution is Execution.PROGRAM_COMPLETED:
            beyond = self._next + 1
        while self._next < beyond:
            to = min(beyond, self._next + MOST)
            yield sensed(episode, self._machine, np.arange(self._next, to) / self._rate)
            self._next = to


def sensed(episode: Episode, machine: Machine, times: Floats) -> Samples:
    """Samples at given times of an episode, (M,), s from the start of the program."""
    kinematics = episode.kinematics(times)
    rows = None if episode.course is None else episode.course.stations_at(kinematics)
    state, spindle = episode.state, episode.spindle
    speed = spindle.speed(times)
    loads = _loads(episode, kinematics, rows, speed=speed, times=times)
    power = main_power(machine, speed, spindle.acceleration(times), cutting_power=loads.power)
    factor = episode.power_factor(kinematics)
    count = len(times)
    programmed, mode, line = _programmed(episode, kinematics, count)
    return Samples(
        time=times,
        position=kinematics.position,
        velocity=kinematics.velocity,
        feed_programmed=programmed,
        spindle_programmed=_wanted(episode, kinematics),
        spindle_speed=speed,
        axis_power=factor[:, None]
        * axes_power(
            machine,
            kinematics.velocity,
            kinematics.acceleration,
            feed_force=loads.feed_force,
        ),
        spindle_power=factor * power,
        coolant_power=np.full(count, machine.coolant_power * state.coolant_on),
        base_power=np.full(count, machine.base_power),
        cutting_power=loads.power,
        cutting_force=loads.force,
        feed_force=loads.feed_force,
        back_force=loads.back_force,
        removal_rate=loads.removal_rate,
        chip_thickness=loads.chip_thickness,
        thrust=loads.thrust,
        deflection=loads.deflection,
        axial_depth=_along(episode, rows, "axial_depth", count),
        # A section averaged over a window may imply more width than the cutter has.
        radial_width=np.minimum(
            _along(episode, rows, "radial_width", count),
            _along(episode, rows, "diameter", count),
        ),
        execution=np.full(count, int(state.execution)),
        path_mode=mode,
        coolant=np.full(count, int(state.coolant_on)),
        overload=overload(machine, loads.power, speed, force=_pushing(episode, rows, loads)),
        line=line,
        tool=np.full(count, state.tool),
        workingstep=np.full(count, state.workingstep),
    )


def _loads(
    episode: Episode,
    kinematics: Kinematics,
    rows: Ints | None,
    *,
    speed: Floats,
    times: Floats,
) -> CuttingLoads:
    course = episode.course
    if course is None or rows is None or course.edge is None:
        return no_loads(len(times))
    stations, edge, turning = course.stations, course.edge, np.abs(speed)
    loads = cutting_loads(
        stations,
        rows,
        speed=_cutting_feed(kinematics, stations.kind[rows]),
        spindle_speed=turning,
        edge=edge,
        beyond=course.beyond(kinematics, rows),
    )
    worn = course.worn(times - episode.begin)
    loads = bent(
        loads, course.stations, rows, edge=course.edge, walls=course.walls, flank_wear=worn
    )
    if course.teeth is not None:
        since = _revolutions_since_entry(episode, course, times)
        loads = entered_loads(loads, stations, rows, since_entry=since, edge=edge)
    loads = worn_loads(loads, stations, rows, spindle_speed=turning, edge=edge, flank_wear=worn)
    if course.teeth is None:
        return loads
    turned = episode.spindle.revolutions(times)
    return tooth_loads(
        loads, stations, rows, turned=turned, edge=edge, teeth=course.teeth, flank_wear=worn
    )


def _cutting_feed(kinematics: Kinematics, kind: Ints) -> Floats:
    """Feed at M times, mm/s; for a plunging tool the axial speed, also at a corner."""
    along = np.abs(kinematics.velocity[:, 2])
    path = np.linalg.norm(kinematics.velocity, axis=1)
    feed: Floats = np.where(kind == StationKind.DRILLING, along, path)
    return feed


def _pushing(episode: Episode, rows: Ints | None, loads: CuttingLoads) -> Floats:
    """Force to compare with the machine's limit: the thrust in drilling, else the force."""
    if episode.course is None or rows is None:
        return loads.force
    is_drilling = episode.course.stations.kind[rows] == StationKind.DRILLING
    return np.where(is_drilling, loads.feed_force, loads.force)


def _revolutions_since_entry(episode: Episode, course: EpisodeCourse, times: Floats) -> Floats:
    """Spindle revolutions since the start of the cut that is active at given times."""
    entry = episode.begin + course.entry_times(times - episode.begin)
    turned: Floats = episode.spindle.revolutions(times) - episode.spindle.revolutions(entry)
    return np.abs(turned)


def _along(episode: Episode, rows: Ints | None, name: str, count: int) -> Floats:
    """Values of a column of the stations; 0 at rest."""
    if episode.course is None or rows is None:
        return np.zeros(count)
    column: Floats = getattr(episode.course.stations, name)
    return column[rows]


def _wanted(episode: Episode, kinematics: Kinematics) -> Floats:
    """Programmed spindle speed, per segment at constant surface speed, rev/s."""
    held = np.full(len(kinematics.segment), episode.state.spindle_programmed)
    if episode.course is None:
        return held
    wanted = episode.course.spindle_programmed[kinematics.segment]
    return np.where(np.isnan(wanted), held, wanted)


def _programmed(
    episode: Episode, kinematics: Kinematics, count: int
) -> tuple[Floats, Ints, Ints]:
    """Programmed feed in mm/s, path mode, and program line."""
    if episode.course is None:
        still = np.full(count, int(PathMode.NONE))
        return np.zeros(count), still, np.full(count, episode.state.line)
    segments, at = episode.course.segments, kinematics.segment
    is_rapid = segments.is_rapid[at]
    feed = np.where(is_rapid, 0.0, segments.speed[at])
    mode = np.where(is_rapid, int(PathMode.RAPID), int(PathMode.FEED))
    return feed, mode, segments.block[at]
