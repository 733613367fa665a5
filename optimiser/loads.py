"""The loads of a cut as monomials in feed per tooth, depth and spindle speed.

Every number comes from :mod:`simulator.physics`: a Kienzle force is ``c·f^(1−m_c)·a``, so its
value at one point gives c. The functions take the force factor K (rake, speed, wear).
"""

from math import pi

from optimiser.cut import Cut, CutKind, Place
from optimiser.limit import Monomial
from simulator.physics import drilling, milling, turning
from simulator.spec import Kienzle

REFERENCE_FEED = 0.1
"""mm, where the physics is asked; any would do"""


def cutting_force(cut: Cut, kienzle: Kienzle, factor: float) -> Monomial:
    """Tangential force in N; of a mill all teeth together, averaged over a revolution."""
    if cut.kind is CutKind.MILLING:
        at = _milling_cut(cut, cut.hardest)
        return _monomial(milling.mean_force(kienzle, at, factor=factor), kienzle, depth=1.0)
    if cut.kind is CutKind.DRILLING:
        moment = drilling.drilling_torque(kienzle, _drilling_cut(cut), factor=factor)
        return _monomial(2.0 * moment / cut.diameter, kienzle, depth=0.0)
    is_groove = cut.kind is CutKind.GROOVING
    force = turning.cutting_force(
        kienzle,
        turning.TurningCut(
            feed_per_revolution=REFERENCE_FEED,
            depth=cut.radial_width if is_groove else cut.depth_share,
            cutting_edge_angle=0.5 * pi if is_groove else cut.tool.cutting_edge_angle,
        ),
        factor=factor,
    )
    return _monomial(force, kienzle, depth=0.0 if is_groove else 1.0)


def bending_force(cut: Cut, kienzle: Kienzle, factor: float) -> Monomial:
    """Greatest force across the axis of an end mill within a revolution, N."""
    at = _milling_cut(cut, cut.bending or cut.hardest)
    force = milling.peak_force(kienzle, at, factor=factor)
    return _monomial(force, kienzle, depth=1.0)


def thrust(cut: Cut, kienzle: Kienzle, factor: float) -> Monomial:
    """Force along the axis of a drill, N."""
    force = drilling.drilling_thrust(kienzle, _drilling_cut(cut), factor=factor)
    return _monomial(force, kienzle, depth=0.0)


def motor_power(cut: Cut, force: Monomial, efficiency: float) -> Monomial:
    """Power that the main drive draws for the cut, W: ``F·π·D·n/(1000·η)``."""
    return _scaled(force, pi * cut.diameter / (1000.0 * efficiency), speed=1.0)


def torque(cut: Cut, force: Monomial) -> Monomial:
    """Torque at the spindle, N·mm: ``F·D/2``."""
    return _scaled(force, 0.5 * cut.diameter)


def _scaled(load: Monomial, factor: float, speed: float = 0.0) -> Monomial:
    """The same load times a factor and a power of the spindle speed."""
    return Monomial(
        coefficient=load.coefficient * factor,
        offset=load.offset * factor,
        feed_exponent=load.feed_exponent,
        depth_exponent=load.depth_exponent,
        speed_exponent=load.speed_exponent + speed,
    )


def scaled(load: Monomial, factor: float) -> Monomial:
    """The same load times a factor."""
    return _scaled(load, factor)


def _monomial(value: float, kienzle: Kienzle, *, depth: float) -> Monomial:
    """Kienzle load whose value at the reference feed and unit depth is known."""
    exponent = 1.0 - kienzle.m_c
    return Monomial(
        coefficient=value / REFERENCE_FEED**exponent,
        feed_exponent=exponent,
        depth_exponent=depth,
    )


def _milling_cut(cut: Cut, place: Place | None) -> milling.MillingCut:
    """The cut at one place, at the reference feed and unit depth of a pass."""
    if place is None:
        raise ValueError("a milling cut needs its engagement")
    return milling.MillingCut(
        feed_per_tooth=REFERENCE_FEED,
        teeth=cut.tool.teeth,
        axial_depth=place.depth_share,
        engagement=place.engagement,
        cutting_edge_angle=cut.tool.cutting_edge_angle,
    )


def _drilling_cut(cut: Cut) -> drilling.DrillingCut:
    """The hole with one lip's feed at the reference."""
    point = cut.tool.point_angle
    return drilling.DrillingCut(
        feed_per_revolution=REFERENCE_FEED * cut.tool.teeth,
        tool_diameter=cut.diameter,
        previous_diameter=cut.previous_diameter,
        teeth=cut.tool.teeth,
        cutting_edge_angle=0.5 * point if point else drilling.CUSTOMARY_EDGE_ANGLE,
    )
