"""Machining cycle of one part on one machine: time, energy, and energy of each movement.

The energy with a random deviation of motor powers (:mod:`simulator.machine.deviation`) is exact
without another run: it is a sum over the movements, each times one uniform factor. Units s, J,
W.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from simulator.machine.deviation import movement_of
from simulator.machine.samples import Episode
from simulator.machine.sensing import sensed
from simulator.machine.totals import quadrature
from simulator.motion.segments import Floats
from simulator.spec import Machine, PowerDeviation

PARTS = 100
"""Number K of equal parts of the time at which the energy profile is known."""

MOST_DRAWN = 1 << 20
"""Greatest number of random numbers drawn at once, 8 MB."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartCycle:
    """Machining of one part on one machine, from a run of the virtual machine."""

    time: float
    """Time from the start to the end of the program, s."""
    energy: float
    """Total electrical energy without deviation, J."""
    peak_power: float
    """Greatest total power of the run, W."""
    traverse_energies: Floats
    """Energy drawn by the motors in each rapid movement, in order, (T,), J."""
    feed_energies: Floats
    """Energy drawn by the motors in each feed movement, in order, (F,), J."""
    profile: Floats
    """Share of the energy drawn until k/K of the time, (K + 1,), from 0 to 1."""


def cycle_of(episodes: Iterable[Episode], machine: Machine) -> PartCycle:
    """Cycle of a part from the episodes of a run without deviation.

    Parameters
    ----------
    episodes : iterable of Episode
        All episodes of the run, in order.
    machine : Machine
    """
    end, peak = 0.0, 0.0
    times, spent = [np.zeros(1)], [np.zeros(0)]
    traverse, feed = [np.zeros(0)], [np.zeros(0)]
    for episode in episodes:
        end = episode.end
        places = quadrature(episode)
        if not len(places.times):
            continue
        samples = sensed(episode, machine, places.times.ravel())
        watts = samples.total_power.reshape(places.times.shape)
        peak = max(peak, float(watts.max()))
        times.append(places.nodes[1:])
        spent.append((places.weights * watts).sum(axis=1))
        if episode.course is None:
            continue
        motors = samples.axis_power.sum(axis=1) + samples.spindle_power
        drawn = (places.weights * motors.reshape(places.times.shape)).sum(axis=1)
        movement = movement_of(episode.course.segments)
        middle = 0.5 * (places.nodes[:-1] + places.nodes[1:])
        at = movement[episode.kinematics(middle).segment]
        energies = np.bincount(at, weights=drawn, minlength=int(movement[-1]) + 1)
        _, begins = np.unique(movement, return_index=True)
        is_rapid = episode.course.segments.is_rapid[begins]
        traverse.append(energies[is_rapid])
        feed.append(energies[~is_rapid])
    used = np.concatenate(([0.0], np.cumsum(np.concatenate(spent))))
    return PartCycle(
        time=end,
        energy=float(used[-1]),
        peak_power=peak,
        traverse_energies=np.concatenate(traverse),
        feed_energies=np.concatenate(feed),
        profile=_profile(np.concatenate(times), used, end),
    )


def _profile(times: Floats, used: Floats, end: float) -> Floats:
    """Share of the energy used until equal parts of the time; as the time if none is used."""
    if used[-1] <= 0.0:
        return np.linspace(0.0, 1.0, PARTS + 1)
    share: Floats = np.interp(np.linspace(0.0, end, PARTS + 1), times, used) / used[-1]
    return share


def drawn_energies(
    cycle: PartCycle, deviation: PowerDeviation, rng: np.random.Generator, count: int
) -> Floats:
    """Total energies of parts whose movements deviate at random and independently.

    Exact: a run of the virtual machine with the same factors has the same energy.

    Parameters
    ----------
    cycle : PartCycle
    deviation : PowerDeviation
    rng : numpy.random.Generator
    count : int
        Number of parts.

    Returns
    -------
    (count,) array, J
    """
    widths = np.concatenate((
        deviation.traverse * cycle.traverse_energies,
        deviation.feed * cycle.feed_energies,
    ))
    energies = np.full(count, cycle.energy)
    rows = max(1, MOST_DRAWN // max(1, len(widths)))
    for first in range(0, count, rows):
        part = energies[first : first + rows]
        part += rng.uniform(-1.0, 1.0, (len(part), len(widths))) @ widths
    return energies
