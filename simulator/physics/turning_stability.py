"""Regenerative chatter in turning: the depth of cut that is stable at any speed.

The speed of a turned bar is low compared with the modes of the machine, so its lobes lie so
close together that only their minimum counts. The nose of the insert is neglected. Units mm, N,
rad.

References
----------
.. [1] J. Tlusty and M. Polacek, "The stability of machine tools against self-excited
   vibrations in machining", ASME Int. Research in Production Eng., 1963; Y. Altintas,
   "Manufacturing Automation", Cambridge, 2012, ch. 4.
"""

from collections.abc import Sequence
from math import cos, pi, sin

from simulator.physics.domain import require_edge_angle, require_positive
from simulator.physics.stability import MOST_DEPTH, chatter_frequencies, receptance
from simulator.spec import VibrationMode


def orthogonal_limit(
    radial: Sequence[VibrationMode],
    axial: Sequence[VibrationMode],
    *,
    stiffness: float,
    cutting_edge_angle: float = pi / 2.0,
) -> float:
    """Depth of cut in turning that is stable at any speed.

    ``b_lim = −1/(2·K_f·min Re G)`` with ``G = cos²κ·G_x + sin²κ·G_z`` along the chip thickness,
    [1]_; for one mode ``2·k·ζ·(1 + ζ)/K_f``. The depth is ``a_p = b·sin κ``. Forces across the
    chip thickness are neglected (no mode coupling).

    Parameters
    ----------
    radial, axial : sequence of VibrationMode
        Modes of tool or workpiece across and along the axis of the workpiece.
    stiffness : float, N/mm²
        Stiffness K_f: force along the chip thickness per mm of width and mm of chip.
    cutting_edge_angle : float, rad
        Angle κ; at π/2 the feed along the axis is in the direction of the chip thickness.

    Returns
    -------
    float, mm
        :data:`MOST_DEPTH` if the structure is rigid in that direction.

    Raises
    ------
    ValueError
        If the stiffness is not positive or the edge angle is outside (0, π).
    """
    require_positive(stiffness, "cutting stiffness", "N/mm²")
    require_edge_angle(cutting_edge_angle)
    modes = (*radial, *axial)
    if not modes:
        return MOST_DEPTH
    frequency = chatter_frequencies(modes)
    sine, cosine = sin(cutting_edge_angle), cos(cutting_edge_angle)
    oriented = cosine**2 * receptance(radial, frequency) + sine**2 * receptance(
        axial, frequency
    )
    lowest = float(oriented.real.min())
    if lowest >= 0.0:
        return MOST_DEPTH
    return min(-sine / (2.0 * stiffness * lowest), MOST_DEPTH)
