"""Chip and forces of a single-point tool: turning, boring, facing, grooving.

The straight edge cuts a chip of thickness ``h = f·sin κ`` and width ``b = a_p/sin κ``. For a
depth within the nose radius use κ from :func:`simulator.physics.edge.effective_edge_angle`.
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
"""Usual F_f/F_c if no source gives constants: median of the seven of [3]_ at 0.2 mm of chip;
range 0.27 to 0.80 from 0.1 to 0.4 mm."""

BACK_SHARE = 0.25
"""Usual F_p/F_c if no source gives constants; range 0.16 to 0.36, far more within the nose."""

THINNEST = 0.05
"""Chip thickness, mm, below which force shares stay constant: not measured there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningCut:
    """Cut of a single-point tool."""

    feed_per_revolution: float
    """Feed per revolution f, mm."""
    depth: float
    """Depth of cut a_p, mm; the width of the tool in grooving."""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle κ_r, rad."""

    def __post_init__(self) -> None:
        require_positive(self.feed_per_revolution, "feed per revolution", "mm")
        require_positive(self.depth, "depth of cut", "mm")
        require_edge_angle(self.cutting_edge_angle)

    @property
    def chip_thickness(self) -> float:
        """Chip thickness ``h = f · sin κ``, mm."""
        return self.feed_per_revolution * sin(self.cutting_edge_angle)

    @property
    def chip_width(self) -> float:
        """Chip width ``b = a_p / sin κ``, mm."""
        return self.depth / sin(self.cutting_edge_angle)


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningForces(Generic[Value]):
    """Three components of the force on a turning tool, N."""

    cutting: Value
    """Cutting force F_c along the cutting speed, N."""
    feed: Value
    """Feed force F_f against the feed, N."""
    back: Value
    """Back (passive) force F_p away from the work, N."""


def cutting_force(kienzle: Kienzle, cut: TurningCut, *, factor: float = 1.0) -> float:
    """Cutting force of a single-point tool along the cutting speed.

    ``F_c = K · k_c1.1 · b · h^(1−m_c)``, [1]_.

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

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
    """Constants of the feed or back force; if unknown, a usual share of the cutting force."""
    if pair is not None:
        return pair
    return Kienzle(k_c11=usual_share * cutting.k_c11, m_c=cutting.m_c)


def force_share(pair: Kienzle, cutting: Kienzle, chip_thickness: Value) -> Value:
    """Feed or back force over the cutting force, for a sharp edge.

    ``F_i/F_c = k_i1.1/k_c1.1 · h^(m_c − m_i)``. Arithmetic only.

    Parameters
    ----------
    pair : Kienzle
        Constants (k_i1.1, m_i).
    cutting : Kienzle
        Constants (k_c1.1, m_c).
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
    """All three force components of a sharp edge in turning.

    ``F_i = K · k_i1.1 · b · h^(1−m_i)``, [2]_ eq. (8) with the chip width. Influences on the
    cutting force (rake, speed, harder work) change the other two in proportion.

    Parameters
    ----------
    cutting_force : float or array, N
        Force F_c, from :func:`cutting_force` or along a path.
    chip_thickness : float or array, mm
    cutting : Kienzle
        Constants (k_c1.1, m_c).
    feed, back : Kienzle or None
        Constants (k_f1.1, m_f) and (k_p1.1, m_p); None: the usual shares.

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
