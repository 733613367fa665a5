"""Forces of a milling cutter along the feed and across it: of one tooth, and their mean.

The angle φ of a tooth counts from the normal to the feed, as in
:mod:`simulator.physics.engagement`. A tooth pushes the tool by F_t against its own motion and
by F_r towards the axis, which gives

- the feed force ``F_t·cos φ + F_r·sin φ``, positive against the feed, and
- the normal force ``F_t·sin φ − F_r·cos φ``, positive towards φ = 0: to the left of the feed
  for a spindle that turns clockwise.

Straight edges: the axial force of a helix is left out. Units mm, N, rad. The means are
arithmetic of :class:`ArcIntegrals` and serve floats and arrays alike.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: forces of one tooth and their
   mean over a revolution.
.. [2] "Milling force model for aviation aluminum alloy: academic insight and perspective
   analysis", Chin. J. Mech. Eng., 2021, Table 5, doi:10.1186/s10033-021-00536-9.
"""

from dataclasses import dataclass
from math import cos, pi, sin
from typing import Generic

from simulator.physics.drive import Quantity, Value
from simulator.physics.engagement import Engagement
from simulator.spec import Kienzle, LinearEdge

RADIAL_SHARE = 0.3
"""F_r/F_t where only k_c is known: the median of K_rc/K_tc of the seven measurements on
aluminium in [2]_, which lie between 0.16 and 0.60"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothLaw:
    """Forces of one tooth: ``F_t = b·(K_tc·h^(1−m_c) + K_te)`` and likewise F_r."""

    k_tc: float
    """N/mm², at h = 1 mm"""
    k_te: float = 0.0
    """N/mm"""
    k_rc: float = 0.0
    """N/mm²"""
    k_re: float = 0.0
    """N/mm"""
    m_c: float = 0.0
    """0: linear in the chip"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcIntegrals(Generic[Value]):
    """Integrals over the arc of contact, which all mean forces are made of."""

    contact: Value
    """∫dφ, rad"""
    sine: Value
    """∫sin φ dφ = C"""
    cosine: Value
    """∫cos φ dφ"""
    sine_squared: Value
    """∫sin² φ dφ"""
    sine_cosine: Value
    """∫sin φ·cos φ dφ"""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeanForces(Generic[Value]):
    """Sum over all teeth, averaged over a revolution, N."""

    tangential: Value
    """times the cutting speed it is the cutting power"""
    feed: Value
    """against the feed"""
    normal: Value
    """towards φ = 0"""


def kienzle_law(kienzle: Kienzle, *, radial_share: float = RADIAL_SHARE) -> ToothLaw:
    """Kienzle's law with a radial force that is a share of the tangential one."""
    return ToothLaw(k_tc=kienzle.k_c11, k_rc=radial_share * kienzle.k_c11, m_c=kienzle.m_c)


def edge_law(edge: LinearEdge) -> ToothLaw:
    """The linear-edge law, both components as measured."""
    return ToothLaw(k_tc=edge.k_tc, k_te=edge.k_te, k_rc=edge.k_rc, k_re=edge.k_re)


def arc_integrals(engagement: Engagement) -> ArcIntegrals[float]:
    """Integrals over one arc of contact in closed form.

    Examples
    --------
    >>> from simulator.physics.engagement import full_immersion
    >>> slot = arc_integrals(full_immersion())
    >>> round(slot.sine, 6), round(slot.sine_squared / pi, 6), abs(round(slot.cosine, 6))
    (2.0, 0.5, 0.0)
    """
    contact = engagement.contact_angle
    both = engagement.entry_angle + engagement.exit_angle
    # Products keep their digits on a narrow arc, where differences of sines lose them.
    return ArcIntegrals(
        contact=contact,
        sine=engagement.cosine_difference,
        cosine=2.0 * cos(0.5 * both) * sin(0.5 * contact),
        sine_squared=0.5 * (contact - cos(both) * sin(contact)),
        sine_cosine=0.5 * sin(both) * sin(contact),
    )


def mean_forces(
    law: ToothLaw,
    arc: ArcIntegrals[Value],
    *,
    feed_per_tooth: Quantity,
    axial_depth: Quantity,
    teeth: int,
    cutting_edge_angle: float = pi / 2.0,
) -> MeanForces[Value]:
    """Mean forces of a cutter over a revolution.

    ``z/2π`` times the integrals of the forces of one tooth over its arc, [1]_; exact for the
    linear edge. With Kienzle's law k_c is taken at the mean chip, as the handbooks do, so that
    the tangential force is that of :func:`simulator.physics.milling.mean_force`. A factor for
    wear multiplies the result.

    Parameters
    ----------
    law : ToothLaw
    arc : ArcIntegrals
        Of contact; an arc of no length has no mean chip.
    feed_per_tooth, axial_depth : float or array, mm
    teeth : int
    cutting_edge_angle : float, rad
        κ_r: the radial force of an inclined edge acts in the plane by its sine.

    Returns
    -------
    MeanForces, N
    """
    sine = sin(cutting_edge_angle)
    width = axial_depth / sine
    mean_chip = feed_per_tooth * sine * arc.sine / arc.contact
    shear = teeth / (2.0 * pi) * axial_depth * feed_per_tooth * mean_chip ** (-law.m_c)
    rub = teeth / (2.0 * pi) * width
    t_c, t_e = law.k_tc * shear, law.k_te * rub
    r_c, r_e = sine * law.k_rc * shear, sine * law.k_re * rub
    return MeanForces(
        tangential=t_c * arc.sine + t_e * arc.contact,
        feed=t_c * arc.sine_cosine + t_e * arc.cosine + r_c * arc.sine_squared + r_e * arc.sine,
        normal=t_c * arc.sine_squared
        + t_e * arc.sine
        - r_c * arc.sine_cosine
        - r_e * arc.cosine,
    )
