"""Chip and forces of a single-point tool: turning, boring, facing, grooving.

The straight edge cuts a chip of thickness ``h = f·sin κ`` and width ``b = a_p/sin κ``. For a
depth within the nose radius take κ from :func:`simulator.physics.edge.effective_edge_angle`.
Scalars in mm, N and rad.

References
----------
.. [1] O. Kienzle, "Die Bestimmung von Kräften und Leistungen an spanenden Werkzeugen und
   Werkzeugmaschinen", VDI-Z, 1952.
.. [2] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1,
   doi:10.1080/00207543.2015.1064182. It prints ``F = k·h^(1−m)`` without the chip's width and
   calls the depth of cut its thickness; the form here has both.
.. [3] W. König and K. Essel, after F. Klocke, "Manufacturing Processes 1: Cutting", 2011: pairs
   (k_i1.1, 1 − m_i) of all three forces for seven steels and cast irons of the library.
"""

from dataclasses import dataclass
from math import pi, sin
from typing import Generic

from simulator.physics.cutting import chip_force
from simulator.physics.domain import require_edge_angle, require_positive
from simulator.physics.drive import FloatOrArray, Value, positive_part
from simulator.spec import Kienzle

FEED_SHARE = 0.45
"""F_f/F_c where no source gives a pair: median of the seven of [3]_ at 0.2 mm of chip; between
0.27 and 0.80 from 0.1 to 0.4 mm"""

BACK_SHARE = 0.25
"""F_p/F_c likewise; between 0.16 and 0.36. Within the nose of the tool it is far more"""

THINNEST = 0.05
"""mm, chip below which a share stays: no pair was measured there"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningCut:
    """Cut of a single-point tool."""

    feed_per_revolution: float
    """f, mm"""
    depth: float
    """a_p, mm; the width of the tool in grooving"""
    cutting_edge_angle: float = pi / 2.0
    """κ_r, rad"""

    def __post_init__(self) -> None:
        require_positive(self.feed_per_revolution, "feed per revolution", "mm")
        require_positive(self.depth, "depth of cut", "mm")
        require_edge_angle(self.cutting_edge_angle)

    @property
    def chip_thickness(self) -> float:
        """``h = f · sin κ`` in mm."""
        return self.feed_per_revolution * sin(self.cutting_edge_angle)

    @property
    def chip_width(self) -> float:
        """``b = a_p / sin κ`` in mm."""
        return self.depth / sin(self.cutting_edge_angle)


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningForces(Generic[Value]):
    """The three components of the force on the tool, N."""

    cutting: Value
    """F_c, along the cutting speed"""
    feed: Value
    """F_f, against the feed"""
    back: Value
    """F_p, passive, out of the work"""


def cutting_force(kienzle: Kienzle, cut: TurningCut, *, factor: float = 1.0) -> float:
    """Force along the cutting speed.

    ``F_c = K · k_c1.1 · b · h^(1−m_c)``, [1]_.

    Parameters
    ----------
    kienzle : Kienzle
    cut : TurningCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the factor is not positive.

    Examples
    --------
    >>> from stepnc_model.units import rad_from_deg
    >>> kappa = rad_from_deg(95.0)
    >>> cut = TurningCut(feed_per_revolution=0.25, depth=2.5, cutting_edge_angle=kappa)
    >>> round(cutting_force(Kienzle(k_c11=1500.0, m_c=0.22), cut), 1)
    1272.9
    """
    return chip_force(
        kienzle,
        chip_thickness=cut.chip_thickness,
        chip_width=cut.chip_width,
        factor=factor,
    )


def side_force(pair: Kienzle | None, cutting: Kienzle, *, usual_share: float) -> Kienzle:
    """Pair of the feed or the back force; where no source gives one, a share of the cutting."""
    if pair is not None:
        return pair
    return Kienzle(k_c11=usual_share * cutting.k_c11, m_c=cutting.m_c)


def force_share(pair: Kienzle, cutting: Kienzle, chip_thickness: Value) -> Value:
    """Feed or back force over the cutting force, for a sharp edge.

    ``F_i/F_c = k_i1.1/k_c1.1 · h^(m_c − m_i)``. Arithmetic only.

    Parameters
    ----------
    pair : Kienzle
        (k_i1.1, m_i).
    cutting : Kienzle
        (k_c1.1, m_c).
    chip_thickness : float or array, mm
        Positive.

    Returns
    -------
    float or array

    Examples
    --------
    >>> steel = Kienzle(k_c11=1659.0, m_c=0.21)
    >>> round(force_share(Kienzle(k_c11=521.0, m_c=0.49), steel, 0.2), 2)
    0.49
    """
    ratio = pair.k_c11 / cutting.k_c11
    chip = THINNEST + positive_part(chip_thickness - THINNEST)
    share: Value = ratio * chip ** (cutting.m_c - pair.m_c)
    return share


def turning_forces(
    cutting_force: Value,
    chip_thickness: FloatOrArray,
    *,
    cutting: Kienzle,
    feed: Kienzle | None,
    back: Kienzle | None,
) -> TurningForces[Value]:
    """All three components of the force of a sharp edge.

    ``F_i = K · k_i1.1 · b · h^(1−m_i)``, [2]_ eq. (8) with the chip's width. What changes the
    cutting force (rake, speed, harder work) changes the other two in proportion.

    Parameters
    ----------
    cutting_force : float or array, N
        F_c, of :func:`cutting_force` or along a path.
    chip_thickness : float or array, mm
    cutting : Kienzle
        (k_c1.1, m_c).
    feed, back : Kienzle or None
        (k_f1.1, m_f) and (k_p1.1, m_p); None: the usual shares.

    Returns
    -------
    TurningForces, N

    Examples
    --------
    >>> pairs = [Kienzle(k_c11=k, m_c=0.2) for k in (1800.0, 700.0, 500.0)]
    >>> turning_forces(1800.0, 1.0, cutting=pairs[0], feed=pairs[1], back=pairs[2])
    TurningForces(cutting=1800.0, feed=700.0, back=500.0)
    """
    sides = [
        force_share(side_force(pair, cutting, usual_share=usual), cutting, chip_thickness)
        for pair, usual in ((feed, FEED_SHARE), (back, BACK_SHARE))
    ]
    return TurningForces(
        cutting=cutting_force, feed=sides[0] * cutting_force, back=sides[1] * cutting_force
    )
