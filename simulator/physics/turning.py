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
"""

from dataclasses import dataclass
from math import pi, sin

from simulator.physics.cutting import chip_force
from simulator.physics.domain import require_edge_angle, require_positive
from simulator.spec import Kienzle


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningCut:
    """What a single-point tool cuts."""

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
class TurningForces:
    """The three components of the force on the tool, N."""

    cutting: float
    """F_c, along the cutting speed"""
    feed: float
    """F_f, against the feed"""
    back: float
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


def turning_forces(
    cut: TurningCut, *, cutting: Kienzle, feed: Kienzle, back: Kienzle
) -> TurningForces:
    """All three components, each by its own Kienzle pair, for a sharp edge.

    ``F_i = k_i1.1 · b · h^(1−m_i)``, [2]_ eq. (8) with the chip's width.

    Parameters
    ----------
    cut : TurningCut
    cutting, feed, back : Kienzle
        Pairs (k_c1.1, m_c), (k_f1.1, m_f) and (k_p1.1, m_p).

    Returns
    -------
    TurningForces, N

    Raises
    ------
    ValueError
        If a pair is out of its range.

    Examples
    --------
    >>> cut = TurningCut(feed_per_revolution=1.0, depth=1.0)
    >>> pairs = [Kienzle(k_c11=k, m_c=0.2) for k in (1800.0, 700.0, 500.0)]
    >>> turning_forces(cut, cutting=pairs[0], feed=pairs[1], back=pairs[2])
    TurningForces(cutting=1800.0, feed=700.0, back=500.0)
    """
    return TurningForces(
        cutting=cutting_force(cutting, cut),
        feed=cutting_force(feed, cut),
        back=cutting_force(back, cut),
    )
