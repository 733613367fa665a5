"""Which edge of a turning insert cuts in a direction, and the chip that it takes.

An edge leads when the tool moves towards its outside; of two that lead the one that leads most
is taken, and of a blade its flat end is a third. The nose is in the effective angle of
:mod:`simulator.physics.edge`. mm and rad.
"""

from math import cos, pi, sin

import numpy as np

from simulator.motion.segments import Floats
from simulator.physics.edge import effective_edge_angle
from simulator.removal.cutter import Insert
from stepnc_model.units import rad_from_deg

LEAST_ANGLE = rad_from_deg(5.0)
"""an edge nearer to the feed than this wipes: the chip would be thin and wide without end"""

LEAST_DEPTH = 1e-6
"""mm; shallower cuts take the chip of this one"""


def edge_angles(insert: Insert, direction: Floats) -> Floats:
    """Angle κ_r between the leading edge and the feed.

    Parameters
    ----------
    insert : Insert
    direction : (M, 3) array
        Unit vectors of the feed.

    Returns
    -------
    (M,) array, rad
        π/2 where there is no feed.
    """
    mirror = -1.0 if insert.is_inside else 1.0
    z, x = direction[:, 2], mirror * direction[:, 0]
    back, front = insert.edge_angles
    # Edges as unit vectors away from the nose, and their outsides.
    edges = [(-cos(back), sin(back)), (cos(front), sin(front))]
    outsides = [(-sin(back), -cos(back)), (sin(front), -cos(front))]
    if insert.width is not None:
        edges.append((1.0, 0.0))
        outsides.append((0.0, -1.0))
    along = np.array([u * z + v * x for u, v in edges])
    leads = np.array([u * z + v * x for u, v in outsides])
    chosen: Floats = along[leads.argmax(axis=0), np.arange(len(z))]
    angle: Floats = np.arccos(np.clip(chosen, -1.0, 1.0))
    return np.clip(angle, LEAST_ANGLE, pi - LEAST_ANGLE)


def chip_ratios(insert: Insert, depth: Floats, angle: Floats) -> Floats:
    """Chip thickness over feed, ``h/f = sin κ`` of the edge that really cuts.

    Parameters
    ----------
    insert : Insert
    depth : (M,) array, mm
        a_p.
    angle : (M,) array, rad
        κ_r of the leading edge.

    Returns
    -------
    (M,) array
    """
    # The corners of a blade are small beside its width: its chip is as thick as the feed.
    nose = insert.nose_radius if insert.width is None else 0.0
    bounded = np.maximum(depth, LEAST_DEPTH)
    return np.array(
        [
            sin(effective_edge_angle(nose, one, cutting_edge_angle=kappa))
            for one, kappa in zip(bounded.tolist(), angle.tolist(), strict=True)
        ],
        dtype=np.float64,
    )
