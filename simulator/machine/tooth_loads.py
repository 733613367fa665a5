"""Forces as a dynamometer would show them: of the teeth of a milling cutter, of a first chip.

At each time the teeth stand where the spindle has turned them; straight edges, with runout.
In turning the chip grows in the first revolution. What is neither keeps its mean. Units mm, N,
rad.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from simulator.machine.cutting import NMM_S_PER_WATT, CuttingLoads, Edge
from simulator.machine.tooth_forces import arcs_of, chip_thickness, tooth_angles
from simulator.machine.transients import eccentric_runout, entry_share
from simulator.motion.segments import Floats, Ints
from simulator.physics.milling_forces import RADIAL_SHARE
from simulator.removal.stations import CutKind, Stations


@dataclass(frozen=True, slots=True, kw_only=True)
class Teeth:
    """How forces of single teeth are shown."""

    eccentricity: float = 0.0
    """mm, of the cutter's axis off the spindle's"""


def tooth_loads(
    mean: CuttingLoads,
    stations: Stations,
    rows: Ints,
    *,
    turned: Floats,
    edge: Edge,
    teeth: Teeth,
) -> CuttingLoads:
    """Loads with the forces of the teeth that are in the cut at each time.

    Parameters
    ----------
    mean : CuttingLoads
        Means over a revolution at M times; power and removal rate stay means.
    stations : Stations
    rows : (M,) array of int
        Which station holds.
    turned : (M,) array
        Revolutions of the spindle.
    edge : Edge
    teeth : Teeth
    """
    has_arc = (stations.kind == CutKind.MILLING) & (stations.exit_angle > stations.entry_angle)
    is_milling = has_arc[rows] & (mean.force > 0.0)
    at = np.flatnonzero(is_milling)
    station, runout = rows[at], eccentric_runout(teeth.eccentricity, edge.teeth)
    entry, exit_ = stations.entry_angle[station], stations.exit_angle[station]
    arc = arcs_of(entry, exit_)
    # Of the edge that really cuts: sin κ, and the width that removes what the map says.
    slope = stations.chip_ratio[station] * arc.contact / arc.sine
    width = 2.0 * stations.section[station] / (stations.diameter[station] * arc.sine * slope)
    per_tooth = mean.chip_thickness[at] / stations.chip_ratio[station]
    angle = tooth_angles(2.0 * pi * np.abs(turned[at]), edge.teeth)
    whole = chip_thickness(angle, feed_per_tooth=per_tooth[:, None], runout=runout)
    chip = slope[:, None] * whole
    in_cut = (chip > 0.0) & (angle >= entry[:, None]) & (angle <= exit_[:, None])
    chip_force = np.where(in_cut, chip, 1.0) ** (1.0 - edge.kienzle.m_c) * in_cut
    # Means take k_c at the mean chip; what wear and edge add to them, teeth get too.
    tangential = (width * _factor(mean, edge, at))[:, None] * chip_force
    sine, cosine = np.sin(angle), np.cos(angle)
    force, feed, back = mean.force.copy(), mean.feed_force.copy(), mean.back_force.copy()
    force[at] = tangential.sum(axis=1)
    feed[at] = (tangential * (cosine + RADIAL_SHARE * sine)).sum(axis=1)
    back[at] = (tangential * (sine - RADIAL_SHARE * cosine)).sum(axis=1)
    return replace(mean, force=force, feed_force=feed, back_force=back)


def entered_loads(
    mean: CuttingLoads, stations: Stations, rows: Ints, *, since_entry: Floats, edge: Edge
) -> CuttingLoads:
    """Loads of turning with the chip that grows in the first revolution of a cut.

    Parameters
    ----------
    mean : CuttingLoads
        At M times.
    stations : Stations
    rows : (M,) array of int
        Which station holds.
    since_entry : (M,) array
        Revolutions since the insert met the work.
    edge : Edge
    """
    is_turning = stations.kind[rows] == CutKind.TURNING
    share = np.where(is_turning, entry_share(since_entry) ** (1.0 - edge.kienzle.m_c), 1.0)
    return replace(
        mean,
        force=share * mean.force,
        feed_force=share * mean.feed_force,
        back_force=share * mean.back_force,
    )


def _factor(mean: CuttingLoads, edge: Edge, at: Ints) -> Floats:
    """K · k_c1.1 of each sample, N/mm², back from the mean power."""
    specific = mean.power[at] * NMM_S_PER_WATT / mean.removal_rate[at]
    factor: Floats = specific * mean.chip_thickness[at] ** edge.kienzle.m_c
    return factor
