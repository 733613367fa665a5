"""Greatest loads of a path where the axes stay below the programmed feed.

Limits are checked at the programmed feed, because another control may not slow down in a
corner. A run on this machine shows less load where the hardest place is a corner, an end, or a
way down with a feed of its own. Units: mm, s.
"""

from dataclasses import dataclass, replace

import numpy as np

from optimiser.cuts.cut import CriticalPlace, Cut, CutKind, PowerPlace, ReachedLoads
from optimiser.cuts.hardest_places import KINDS, LEAST_RATIO, Bending, PathContacts
from optimiser.solver.problem import ROUNDING
from simulator.motion.passing import RunMotion
from simulator.motion.segments import Bools, Floats, Ints
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.stations import StationKind, Stations

INSIDE = np.array([1e-6, 0.01, 0.05, 0.125, 0.3, 0.5, 0.7, 0.875, 0.95, 0.99, 1.0 - 1e-6])
"""Relative places in a stretch, the first and the last just inside its ends.

They lie closer there: a slow axis brakes within micrometres before the place where most is met.
"""

FASTER = 1.01
"""Ratio of two spindle speeds from which the idling power of the drive is told apart."""

FOLLOWED = 1.1
"""Ratio of spindle speeds of neighbours up to which a spindle changes evenly between them; more
is another command, for which a feed waits."""

NOT_BENT = Bending(at=np.empty(0, dtype=np.int64), shank=np.empty(0), wall=np.empty(0))
"""Bending forces of a tool that bends nowhere."""

HARD = 0.5
"""Share of the greatest force; if a place above it keeps more, no easier place is harder."""

FIRST = 16
"""Number of stations of the greatest possible load whose speeds are worked out first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineRun:
    """Run of a path by the machine axes."""

    motion: RunMotion
    feed: float
    """Feed programmed in the technology, mm/s."""
    spindle: float
    """Spindle speed at the diameter of the cut, rev/s."""

    @property
    def run(self) -> ToolPathRun:
        """Lines and arcs of the path."""
        return self.motion.run


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Loads:
    """Relative force, power and wall force along a path."""

    rows: Ints
    """Rows of the stations that cut at a feed, (K,)."""
    programmed: Floats
    """Loads with the chip that is programmed at each station, (3, K)."""
    nominal: Floats
    """Greatest loads with the chip of the technology's feed, as the limits use them, (3,)."""


def with_power(
    cut: Cut, met: PathContacts, bent: Bending, ride: MachineRun, *, exponent: float
) -> Cut:
    """Add the place of greatest power along the path to a cut, for its limits.

    Parameters
    ----------
    met : PathContacts
        Contacts along the path.
    bent : Bending
        Bending forces at the same stations.
    exponent : float
        Kienzle exponent m_c.
    """
    loads = None if cut.kind is CutKind.MILLING else _loads(cut, met, bent, ride, exponent)
    if loads is None:
        return cut
    if cut.kind is CutKind.DRILLING:
        # The limits use the programmed chip, whatever the strategy of the hole.
        ratio = max(float(loads.programmed[0].max() / loads.nominal[0]), 1.0)
        return replace(
            cut,
            thickest=ratio ** (1.0 / (1.0 - exponent)),
            power_diameter=_power_diameter(loads, ride) / ratio,
        )
    speeds = _fastest(ride.run)[met.stations.segment[loads.rows]] / ride.spindle
    return replace(
        cut,
        power_diameter=_power_diameter(loads, ride),
        power_places=_power_places(loads.programmed[1], speeds),
        torque_diameter=float((loads.programmed[1] / speeds).max())
        / (float(loads.nominal[0]) * ride.spindle),
    )


def _power_places(power: Floats, speed: Floats) -> tuple[PowerPlace, ...]:
    """Places than which no other has more power at a spindle that is faster by a per cent."""
    found: list[PowerPlace] = []
    most = float(power.max())
    for row in np.lexsort((-speed, -power)):
        if not found or speed[row] > FASTER * found[-1].speed:
            place = PowerPlace(power=float(power[row]) / most, speed=float(speed[row]))
            found.append(place)
    return tuple(found)


def with_reached(
    cut: Cut, met: PathContacts, bent: Bending, ride: MachineRun, *, exponent: float
) -> Cut:
    """Add the loads that the axes actually reach along the path; as :func:`with_power`."""
    cut = with_power(cut, met, bent, ride, exponent=exponent)
    loads = None if cut.kind.is_turned else _loads(cut, met, bent, ride, exponent)
    if loads is None:
        return cut
    if cut.kind is CutKind.DRILLING:
        ratio = cut.thickest ** (1.0 - exponent)
        most = ratio * loads.nominal[0], loads.programmed[1].max(), 0.0
        loads = replace(loads, nominal=np.array(most))
    hard = (loads.programmed >= HARD * loads.nominal[:, None]) & (loads.programmed > 0.0)
    found = _shares(met, ride, loads, np.any(hard, axis=0), exponent)
    if found.min() < HARD:
        found = _shares(met, ride, loads, np.ones(len(loads.rows), dtype=np.bool_), exponent)
    force, power, wall = found.tolist()
    return replace(cut, reached=ReachedLoads(force=force, power=power, wall=wall))


def thickened(cut: Cut) -> Cut:
    """Let the limits of a milling cut count the places that are faster than their feed.

    No limit relies on axes that are slower, but every limit must bear those that are faster: a
    control that rounds a change of the feed speeds up before the change.
    """
    found = cut.reached
    force, wall = max(found.force, found.power), found.wall
    if max(force, wall) <= 1.0 + ROUNDING:
        return cut
    over = ReachedLoads(force=max(force, 1.0), power=max(force, 1.0), wall=max(wall, 1.0))
    return replace(
        cut,
        fill=cut.fill * over.force,
        shank=_filled_more(cut.shank, over.force),
        wall=_filled_more(cut.wall, over.wall),
        reached=ReachedLoads(
            force=found.force / over.force,
            power=found.power / over.power,
            wall=found.wall / over.wall,
        ),
    )


def _filled_more(place: CriticalPlace | None, factor: float) -> CriticalPlace | None:
    return None if place is None else replace(place, fill=place.fill * factor)


def plunge_reached(cut: Cut, met: PathContacts, ride: MachineRun, *, exponent: float) -> float:
    """Share of the loads of straight plunges of a mill that the axes reach.

    The axes may not reach the feed in a short plunge, or brake at its end where it meets most.
    """
    loads = _loads(cut.as_drill, met, NOT_BENT, ride, exponent)
    if loads is None:
        return 1.0
    loads = replace(loads, nominal=loads.programmed.max(axis=1))
    every = np.ones(len(loads.rows), dtype=np.bool_)
    return float(_shares(met, ride, loads, every, exponent)[0])


def _loads(
    cut: Cut, met: PathContacts, bent: Bending, ride: MachineRun, exponent: float
) -> _Loads | None:
    """Relative loads at the cutting stations; None if no station cuts."""
    stations, run = met.stations, ride.run
    is_cut = (stations.kind == KINDS[cut.kind]) & (stations.section > 0.0)
    is_cut &= ~run.segments.is_rapid[stations.segment] & (run.spindle[stations.segment] > 0.0)
    if not is_cut.any():
        return None
    rows = np.flatnonzero(is_cut)
    segment = stations.segment[rows]
    ratio, diameter = stations.chip_ratio[rows].clip(LEAST_RATIO), stations.diameter[rows]
    if cut.kind.is_turned:
        force = stations.axial_depth[rows] * ratio**-exponent
    else:
        force = stations.peak_section[rows] * ratio**-exponent / diameter
    wall = np.zeros(len(stations))
    wall[bent.at] = bent.wall
    spindle = ride.run.spindle[segment]
    fastest = _fastest(ride.run)[segment] if cut.kind.is_turned else spindle
    chip = ride.run.segments.speed[segment] / ride.feed * ride.spindle / spindle
    if cut.kind.is_turned:
        chip = np.ones(len(rows))
    thinned = chip ** (1.0 - exponent)
    programmed = np.stack((force, force * diameter * fastest, wall[rows])) * thinned
    most = float(force.max())
    power = most * cut.force_diameter * ride.spindle
    return _Loads(
        rows=rows,
        programmed=programmed,
        nominal=np.array([most, power, float(wall[rows].max())]),
    )


def _fastest(run: ToolPathRun) -> Floats:
    """Greatest spindle speed within each segment, (N,), rev/s.

    A spindle that follows the radius changes its speed within a segment, most where it is late
    after a retract; between the middles of two segments at a feed it changes evenly.
    """
    fastest = run.spindle.copy()
    is_fed, one, other = ~run.segments.is_rapid, run.spindle[:-1], run.spindle[1:]
    is_even = is_fed[1:] & is_fed[:-1]
    is_even &= np.maximum(one, other) <= FOLLOWED * np.minimum(one, other)
    between = np.where(is_even, 0.5 * (one + other), 0.0)
    np.maximum(fastest[1:], between, out=fastest[1:])
    np.maximum(fastest[:-1], between, out=fastest[:-1])
    return fastest


def _power_diameter(loads: _Loads, ride: MachineRun) -> float:
    """Diameter at which the greatest force takes the greatest power, mm."""
    return float(loads.programmed[1].max() / (loads.nominal[0] * ride.spindle))


def _shares(
    met: PathContacts, ride: MachineRun, loads: _Loads, at: Bools, exponent: float
) -> Floats:
    """Share of the nominal loads that the axes reach, (3,); 1 for a load of zero."""
    if not at.any():
        return np.zeros(3)
    is_some = loads.nominal > 0.0
    whole = np.where(is_some, loads.nominal, 1.0)
    return np.where(is_some, _greatest_reached(met, ride, loads, at, exponent) / whole, 1.0)


def _greatest_reached(
    met: PathContacts, ride: MachineRun, loads: _Loads, at: Bools, exponent: float
) -> Floats:
    """Greatest loads that the axes reach at some of the stations, (3,).

    No control exceeds the greatest feed of the path, so a station whose load at that feed is
    below what another station reaches needs no motion.
    """
    segments, places = ride.run.segments, np.flatnonzero(at)
    speed = segments.speed[met.stations.segment[loads.rows[places]]]
    fastest = segments.speed[~segments.is_rapid].max()
    filled = _filled(met.stations, loads.rows[places]).max(axis=1)
    most = loads.programmed[:, places] * filled * (fastest / speed) ** (1.0 - exponent)
    is_first = np.any(most >= np.sort(most, axis=1)[:, -FIRST:][:, :1], axis=0)
    found = _reached(met, ride, loads, places[is_first], exponent)
    is_next = np.any(most * (1.0 + ROUNDING) > found[:, None], axis=0) & ~is_first
    if not is_next.any():
        return found
    return np.maximum(found, _reached(met, ride, loads, places[is_next], exponent))


def _reached(
    met: PathContacts, ride: MachineRun, loads: _Loads, places: Ints, exponent: float
) -> Floats:
    """Greatest loads that the axes reach at stations at places of the loads, (3,)."""
    rows = loads.rows[places]
    programmed = ride.run.segments.speed[met.stations.segment[rows], None]
    slower = (_speeds(met, ride, rows) / programmed) ** (1.0 - exponent)
    share = (_filled(met.stations, rows) * slower).max(axis=1)
    greatest: Floats = (loads.programmed[:, places] * share).max(axis=1)
    return greatest


def _speeds(met: PathContacts, ride: MachineRun, rows: Ints) -> Floats:
    """Speeds reached at the places in K stretches, (K, P), mm/s; of a plunge along the axis."""
    places = met.stations.station[rows, None] - met.length[rows, None] * (1.0 - INSIDE)
    segments = np.repeat(met.stations.segment[rows], len(INSIDE))
    velocities = ride.motion.velocities(segments, places.ravel())
    is_drilling = (met.stations.kind[rows] == StationKind.DRILLING)[:, None]
    along = np.linalg.norm(velocities, axis=1).reshape(places.shape)
    down = np.abs(velocities[:, 2]).reshape(places.shape)
    speeds: Floats = np.where(is_drilling, down, along)
    return speeds


def _filled(stations: Stations, rows: Ints) -> Floats:
    """Section at the places over the greatest of each stretch, (K, P)."""
    section = stations.section[rows, None] + stations.growth[rows, None] * (INSIDE - 0.5)
    share: Floats = section / stations.peak_section[rows, None]
    return share
