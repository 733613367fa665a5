"""Force and power of the cut where the tool is, for all processes alike.

``P_c = k_c(h_m) · Q``: specific force times removal rate, exact for milling, drilling and
turning, so that only the section of the cut and the ratio of the mean chip need to be known.
Forces are means over a revolution; those of single teeth are in
:mod:`simulator.machine.tooth_loads`. Units mm, s, N, W, rev/s.

References
----------
.. [1] F. Klocke, "Manufacturing Processes 1: Cutting", 2011, ch. 3: Kienzle's law.
.. [2] Y. Altintas, "Manufacturing Automation", Cambridge, 2012, ch. 2: mean milling forces.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from simulator.machine.tooth_forces import arcs_of
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics.drilling import THRUST_SHARE
from simulator.physics.milling_forces import RADIAL_SHARE
from simulator.removal.stations import CutKind, Stations
from simulator.spec import Kienzle

TURNING_FEED_SHARE, TURNING_BACK_SHARE = 0.4, 0.3
"""of the cutting force, sharp edge: customary"""

NMM_S_PER_WATT = 1000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Edge:
    """What cuts what."""

    teeth: int
    kienzle: Kienzle
    factor: float = 1.0
    """on k_c: rake, speed, and what calibration found"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CuttingLoads:
    """What the cut takes at M times."""

    removal_rate: Floats
    """(M,) mm³/s"""
    chip_thickness: Floats
    """(M,) mm, mean over the contact"""
    power: Floats
    """(M,) W at the edge"""
    force: Floats
    """(M,) N, tangential"""
    feed_force: Floats
    """(M,) N, against the feed"""
    back_force: Floats
    """(M,) N, across the feed, from the surface"""


def no_loads(count: int) -> CuttingLoads:
    """Nothing is cut."""
    nothing = np.zeros(count)
    return CuttingLoads(
        removal_rate=nothing,
        chip_thickness=nothing,
        power=nothing,
        force=nothing,
        feed_force=nothing,
        back_force=nothing,
    )


def cutting_loads(
    stations: Stations,
    rows: Ints,
    *,
    speed: Floats,
    spindle_speed: Floats,
    edge: Edge,
    wear: Floats | float = 1.0,
) -> CuttingLoads:
    """Loads at M places of a path.

    Parameters
    ----------
    stations : Stations
    rows : (M,) array of int
        Which station holds.
    speed : (M,) array, mm/s
        Along the path.
    spindle_speed : (M,) array, rev/s
        Magnitude; a cut with a standing spindle has no model: its force is 0.
    edge : Edge
    wear : (M,) array or float
        Factor on the force of a worn edge.
    """
    is_met = stations.section * stations.chip_ratio * stations.diameter > 0.0
    cuts: Bools = is_met[rows] & (speed > 0.0) & (spindle_speed > 0.0)
    rate = np.where(cuts, stations.section[rows] * speed, 0.0)
    per_tooth = np.where(cuts, speed, 1.0) / (edge.teeth * np.where(cuts, spindle_speed, 1.0))
    chip = np.where(cuts, per_tooth * stations.chip_ratio[rows], 1.0)
    specific = edge.factor * wear * edge.kienzle.k_c11 * chip**-edge.kienzle.m_c
    power = specific * rate / NMM_S_PER_WATT
    around = pi * np.where(cuts, stations.diameter[rows] * spindle_speed, 1.0)
    force = power * NMM_S_PER_WATT / around
    feed_share, back_share = shares(stations)
    return CuttingLoads(
        removal_rate=rate,
        chip_thickness=np.where(cuts, chip, 0.0),
        power=power,
        force=force,
        feed_force=feed_share[rows] * force,
        back_force=back_share[rows] * force,
    )


def shares(stations: Stations) -> tuple[Floats, Floats]:
    """Force against and across the feed over the tangential one, at each station.

    Milling: means over a revolution of one tooth on its arc, [2]_; a radial force that is a
    share of the tangential one. A drill's thrust is that of its lips.
    """
    kind = stations.kind
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    feed = (arc.sine_cosine + RADIAL_SHARE * arc.sine_squared) / whole
    back = (arc.sine_squared - RADIAL_SHARE * arc.sine_cosine) / whole
    is_drilling, is_turning = kind == CutKind.DRILLING, kind == CutKind.TURNING
    feed = np.where(is_drilling, THRUST_SHARE * stations.chip_ratio, feed)
    return (
        np.where(is_turning, TURNING_FEED_SHARE, feed),
        np.where(is_turning, TURNING_BACK_SHARE, np.where(is_drilling, 0.0, back)),
    )
