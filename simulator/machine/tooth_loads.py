"""Forces as a dynamometer would measure them: of single teeth and of the first chip.

At each time the teeth of a milling cutter are where the spindle has turned them, along their
helix and with runout. In turning the chip grows during the first revolution. All other loads
keep their mean. The module also computes the deflection of the tool. Units mm, N, rad.
"""

from dataclasses import dataclass, replace
from math import pi, sin

import numpy as np

from simulator.machine.cutting import CuttingEdge, CuttingLoads
from simulator.machine.transients import entry_share
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import flank
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.force_cache import wall_at
from simulator.physics.tooth_forces import (
    Places,
    forces,
)
from simulator.physics.uneven_teeth import Runout, eccentric_runout
from simulator.removal.stations import StationKind, Stations

LAND = ForceLaw(exponent=0.0, radial_share=flank.NORMAL / flank.CUTTING)
"""Force law of a wear land, which rubs along the engaged edges whatever the chip."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothOptions:
    """Options for forces of single teeth."""

    eccentricity: float = 0.0
    """Offset of the cutter's axis from the spindle axis, mm."""


def tooth_loads(  # noqa: PLR0913 (places, times and state of the edge are apart)
    mean: CuttingLoads,
    stations: Stations,
    rows: Ints,
    *,
    turned: Floats,
    edge: CuttingEdge,
    teeth: ToothOptions,
    flank_wear: Floats,
) -> CuttingLoads:
    """Loads with the forces of the teeth that are in the cut at each time.

    Parameters
    ----------
    mean : CuttingLoads
        Means over a revolution at M times; power, removal rate and deflection are kept.
    rows : (M,) array of int
        Index of the station that applies.
    turned : (M,) array
        Revolutions of the spindle.
    flank_wear : (M,) array, mm
    """
    at = np.flatnonzero(_has_arc(stations)[rows] & (mean.force > 0.0))
    per_tooth, scale = _scale(mean, stations, rows, edge, at)
    runout = None
    if teeth.eccentricity > 0.0:
        offsets = eccentric_runout(teeth.eccentricity, edge.teeth)
        runout = Runout(offsets=offsets, feed_per_tooth=per_tooth)
    force, feed, back = mean.force.copy(), mean.feed_force.copy(), mean.back_force.copy()
    force[at] = feed[at] = back[at] = 0.0
    for law, newtons in ((_law(edge), scale), (LAND, _land(edge, flank_wear[at]))):
        if not newtons.any():
            continue
        found = forces(
            _flutes(edge),
            _places(stations, rows[at]),
            law,
            rotation=2.0 * pi * np.abs(turned[at])[:, None],
            runout=runout,
        )
        force[at] += newtons * found.tangential[:, 0]
        feed[at] += newtons * found.feed[:, 0]
        back[at] += newtons * found.normal[:, 0]
    return replace(mean, force=force, feed_force=feed, back_force=back)


def wall_forces(stations: Stations, edge: CuttingEdge) -> Floats:
    """Normalised wall forces of each station, (2, M), mm: of a sharp edge and of a wear land.

    Each is the force normal to the wall while a tooth cuts it, divided by ``K·k_c1.1·f_z^q``
    times the filled share of the section, or by the force of a wear land 1 mm wide; see
    :func:`simulator.physics.tooth_forces.wall_force`. 0 for rigid tools and stations without an
    arc.
    """
    found = np.zeros((2, len(stations)))
    at = np.flatnonzero(_has_arc(stations))
    if edge.compliance == 0.0 or not len(at):
        return found
    arcs = stations.arcs
    columns = np.stack((arcs.entry_angle[at], arcs.exit_angle[at], arcs.depth[at]))
    for made, law in zip(found, (_law(edge), LAND), strict=True):
        made[at] = wall_at(_flutes(edge), law, columns)
    return found


def bent(
    loads: CuttingLoads,
    stations: Stations,
    rows: Ints,
    *,
    edge: CuttingEdge,
    walls: Floats,
    flank_wear: Floats,
) -> CuttingLoads:
    """Loads with the deflection of the tool.

    Parameters
    ----------
    loads : CuttingLoads
        Means over a revolution at M times.
    rows : (M,) array of int
        Index of the station that applies.
    walls : array
        Result of :func:`wall_forces`.
    flank_wear : (M,) array, mm
    """
    if edge.compliance == 0.0:
        return loads
    at = np.flatnonzero(_has_arc(stations)[rows] & (loads.force > 0.0))
    _, scale = _scale(loads, stations, rows, edge, at)
    sharp, land = walls[:, rows[at]]
    deflection = loads.deflection.copy()
    deflection[at] = edge.compliance * (scale * sharp + _land(edge, flank_wear[at]) * land)
    return replace(loads, deflection=deflection)


def entered_loads(
    mean: CuttingLoads,
    stations: Stations,
    rows: Ints,
    *,
    since_entry: Floats,
    edge: CuttingEdge,
) -> CuttingLoads:
    """Turning loads with the chip that grows in the first revolution of a cut.

    Parameters
    ----------
    mean : CuttingLoads
        Mean loads at M times.
    rows : (M,) array of int
        Index of the station that applies.
    since_entry : (M,) array
        Revolutions since the insert entered the cut.
    """
    is_turning = stations.kind[rows] == StationKind.TURNING
    share = np.where(is_turning, entry_share(since_entry) ** (1.0 - edge.kienzle.m_c), 1.0)
    return replace(
        mean,
        force=share * mean.force,
        feed_force=share * mean.feed_force,
        back_force=share * mean.back_force,
    )


def _has_arc(stations: Stations) -> Bools:
    """Mask of the stations that mill along a known arc."""
    is_milling: Bools = (stations.kind == StationKind.MILLING) & (stations.section > 0.0)
    is_milling &= stations.exit_angle > stations.entry_angle
    return is_milling


def _places(stations: Stations, rows: Ints) -> Places:
    arcs = stations.arcs
    return Places(
        entry_angle=arcs.entry_angle[rows],
        exit_angle=arcs.exit_angle[rows],
        axial_depth=arcs.depth[rows],
    )


def _flutes(edge: CuttingEdge) -> CuttingEdges:
    return edge.flutes or CuttingEdges(teeth=edge.teeth, diameter=1.0)


def _law(edge: CuttingEdge) -> ForceLaw:
    return ForceLaw(exponent=1.0 - edge.kienzle.m_c)


def _land(edge: CuttingEdge, flank_wear: Floats) -> Floats:
    """Force of the wear land per mm of axial depth, N/mm."""
    return flank.CUTTING * flank_wear * sin(_flutes(edge).cutting_edge_angle)


def _scale(
    mean: CuttingLoads, stations: Stations, rows: Ints, edge: CuttingEdge, at: Ints
) -> tuple[Floats, Floats]:
    """Feed per tooth in mm, and scale of the force integrals of a sharp edge in N/mm.

    The section tells how much of the engagement is filled.
    """
    station = rows[at]
    per_tooth = mean.chip_thickness[at] / stations.chip_ratio[station]
    fill = stations.arcs.fill[station] * mean.filled[at]
    factor = edge.factor * edge.kienzle.k_c11
    scale: Floats = factor * per_tooth ** (1.0 - edge.kienzle.m_c) * fill
    return per_tooth, scale
