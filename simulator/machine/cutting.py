"""Force, torque and power of the cut where the tool is, for all processes alike.

``P_c = k_c(h_m) · Q``: specific force times removal rate, exact for milling, drilling and
turning, so that only the section of the cut and the ratio of the mean chip need to be known.
The tangential force is the mean over a revolution. Units mm, s, N, W, rev/s; torque N·mm.

References
----------
.. [1] F. Klocke, "Manufacturing Processes 1: Cutting", 2011, ch. 3: Kienzle's law.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics.drilling import THRUST_SHARE
from simulator.removal.stations import CutKind, Stations
from simulator.spec import Kienzle


@dataclass(frozen=True, slots=True, kw_only=True)
class Edge:
    """What cuts what."""

    teeth: int
    kienzle: Kienzle
    factor: float = 1.0
    """on k_c: rake, speed, and what calibration found"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shares:
    """Force along the feed and force from the surface as shares of the cutting force."""

    feed: float
    back: float


SHARES = {
    CutKind.MILLING: Shares(feed=0.5, back=0.3),
    CutKind.DRILLING: Shares(feed=THRUST_SHARE, back=0.0),
    CutKind.TURNING: Shares(feed=0.4, back=0.3),
}
"""customary figures for a sharp edge"""


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
    """(M,) N, tangential, mean over a revolution"""
    feed_force: Floats
    """(M,) N, against the feed"""
    back_force: Floats
    """(M,) N, from the finished surface"""


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
    cuts: Bools = (stations.section[rows] > 0.0) & (speed > 0.0) & (spindle_speed > 0.0)
    rate = np.where(cuts, stations.section[rows] * speed, 0.0)
    per_tooth = np.where(cuts, speed, 1.0) / (edge.teeth * np.where(cuts, spindle_speed, 1.0))
    chip = np.where(cuts, per_tooth * stations.chip_ratio[rows], 1.0)
    specific = edge.factor * wear * edge.kienzle.k_c11 * chip**-edge.kienzle.m_c
    power = specific * rate / 1000.0
    around = pi * np.where(cuts, stations.diameter[rows] * spindle_speed, 1.0)
    force = power * 1000.0 / around
    kinds = stations.kind[rows]
    # A drill's thrust is that of its lips, which stand at the edge angle to its axis.
    lip = np.where(kinds == CutKind.DRILLING, stations.chip_ratio[rows], 1.0)
    return CuttingLoads(
        removal_rate=rate,
        chip_thickness=np.where(cuts, chip, 0.0),
        power=power,
        force=force,
        feed_force=_FEED_SHARE[kinds] * lip * force,
        back_force=_BACK_SHARE[kinds] * force,
    )


_FEED_SHARE = np.array([SHARES[kind].feed if kind in SHARES else 0.0 for kind in CutKind])
_BACK_SHARE = np.array([SHARES[kind].back if kind in SHARES else 0.0 for kind in CutKind])
