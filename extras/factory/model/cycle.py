"""Machining cycle of one part on one machine: time, energy, and energy of each movement.

The energy with a random deviation of motor powers (:mod:`simulator.machine.deviation`) is exact
without another run: it is a sum over the movements, each times one uniform factor. Units s, J,
W.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from simulator.machine.deviation import movement_of
from simulator.machine.samples import Episode, Samples
from simulator.machine.sensing import sensed
from simulator.machine.totals import Quadrature, quadrature
from simulator.motion.segments import Floats, Segments
from simulator.spec import Machine, PowerDeviation

PARTS = 100
"""Number K of equal parts of the time at which the energy profile is known."""

MOST_DRAWN = 1 << 20
"""Greatest number of random numbers drawn at once, 8 MB."""


class Factors(NamedTuple):
    """Factors on the motor powers of the movements of one part."""

    traverse: Floats
    """Of each rapid movement, in order, (T,)."""
    feed: Floats
    """Of each feed movement, in order, (F,)."""


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
    cutting_energy: float | None = None
    """Energy of the main drive that goes into the cut, over its efficiency, J; None: not known,
    as of interpolated cycles."""


def cycle_of(episodes: Iterable[Episode], machine: Machine) -> PartCycle:
    """Cycle of a part from the episodes of a run without deviation.

    Parameters
    ----------
    episodes : iterable of Episode
        All episodes of the run, in order.
    """
    end, peak, cut = 0.0, 0.0, 0.0
    times, spent, drawn = [np.zeros(1)], [np.zeros(0)], [MovementEnergies()]
    for episode in episodes:
        end = episode.end
        places = quadrature(episode)
        if not len(places.times):
            continue
        samples = sensed(episode, machine, places.times.ravel())
        watts = samples.total_power.reshape(places.times.shape)
        peak = max(peak, float(watts.max()))
        edge = samples.cutting_power.reshape(places.times.shape)
        cut += float((places.weights * edge).sum()) / machine.spindle.efficiency
        times.append(places.nodes[1:])
        spent.append((places.weights * watts).sum(axis=1))
        if episode.course is not None:
            drawn.append(_drawn(episode, episode.course.segments, places, samples))
    used = np.concatenate(([0.0], np.cumsum(np.concatenate(spent))))
    return PartCycle(
        time=end,
        energy=float(used[-1]),
        peak_power=peak,
        traverse_energies=np.concatenate([each.traverse for each in drawn]),
        feed_energies=np.concatenate([each.feed for each in drawn]),
        profile=_profile(np.concatenate(times), used, end),
        cutting_energy=cut,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MovementEnergies:
    """Energy drawn by the motors in the movements of a stretch, J."""

    traverse: Floats = field(default_factory=lambda: np.zeros(0))
    feed: Floats = field(default_factory=lambda: np.zeros(0))


def _drawn(
    episode: Episode, segments: Segments, places: Quadrature, samples: Samples
) -> MovementEnergies:
    """Energies of the movements of one stretch."""
    motors = samples.axis_power.sum(axis=1) + samples.spindle_power
    spans = (places.weights * motors.reshape(places.times.shape)).sum(axis=1)
    movement = movement_of(segments)
    middle = 0.5 * (places.nodes[:-1] + places.nodes[1:])
    at = movement[episode.kinematics(middle).segment]
    count = int(movement[-1]) + 1
    energies = np.bincount(at, weights=spans, minlength=count).astype(np.float64)
    is_rapid = segments.is_rapid[np.searchsorted(movement, np.arange(count))]
    return MovementEnergies(traverse=energies[is_rapid], feed=energies[~is_rapid])


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


def drawn_factors(
    cycle: PartCycle, deviation: PowerDeviation, rng: np.random.Generator
) -> Iterator[Factors]:
    """Factors of the movements of one part after another, without end.

    A generator in the same state gives :func:`drawn_energies` the same factors.
    """
    traverse, feed = len(cycle.traverse_energies), len(cycle.feed_energies)
    while True:
        drawn = rng.uniform(-1.0, 1.0, traverse + feed)
        yield Factors(
            traverse=1.0 + deviation.traverse * drawn[:traverse],
            feed=1.0 + deviation.feed * drawn[traverse:],
        )
