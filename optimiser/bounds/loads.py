"""Loads of a cut as functions of feed per tooth, depth and spindle speed.

Every number comes from :mod:`simulator.physics`: a Kienzle force is ``c·f^(1−m_c)·a``, so its
value at one point gives c. The functions take the force factor K (rake, speed).
"""

from dataclasses import dataclass, replace
from enum import Enum, auto
from functools import lru_cache
from math import pi

from optimiser.cuts.cut import CriticalPlace, Cut, CutKind
from optimiser.solver.problem import Monomial
from simulator.physics import cutting as power
from simulator.physics import drilling, kinematics, milling, turning
from simulator.physics.flutes import WALL, CuttingEdges, ForceLaw
from simulator.spec import Kienzle
from simulator.tool_windows import DrillPoint

LEAST = 1e-9
"""Least value of a load, mm; a straight edge without a chip at the wall would give zero."""


class ForceKind(Enum):
    """Force along the helix that a depth curve describes."""

    ACROSS = auto()
    """Greatest force across the axis within a revolution."""
    AT_WALL = auto()
    """Greatest force normal to a wall while an edge forms it."""


REFERENCE_FEED = 0.1
"""Feed at which the physics is evaluated, mm; any value would do."""


def cutting_force(
    cut: Cut, kienzle: Kienzle, factor: float, point: DrillPoint = drilling.LIPS_ONLY
) -> Monomial:
    """Tangential force, N; for a mill all teeth together, averaged over a revolution.

    For a drill, the force of all lips at their middle, as in the virtual machine.
    """
    if cut.kind is CutKind.MILLING:
        at = _milling_cut(cut, cut.hardest)
        # Use the measured chip, which may differ from that of the arc that spans all contact.
        thinner = cut.mean_chip_ratio * REFERENCE_FEED / at.mean_chip_thickness
        force = milling.mean_force(kienzle, at, factor=factor * cut.fill)
        return _monomial(force * thinner**-kienzle.m_c, kienzle, depth=1.0)
    if cut.kind is CutKind.DRILLING:
        moment = drilling.drilling_torque(kienzle, _drilling_cut(cut, point), factor=factor)
        force = cut.fill * 2.0 * moment / cut.force_diameter * _thicker(cut, kienzle)
        return _monomial(force, kienzle, depth=0.0)
    is_groove = cut.kind is CutKind.GROOVING
    force = turning.cutting_force(
        kienzle,
        turning.TurningCut(
            feed_per_revolution=REFERENCE_FEED,
            depth=cut.radial_width if is_groove else cut.depth_share,
            cutting_edge_angle=0.5 * pi if is_groove else cut.turning_edge_angle,
        ),
        factor=factor,
    )
    return _monomial(force, kienzle, depth=0.0 if is_groove else 1.0)


def shank_force(cut: Cut, kienzle: Kienzle, factor: float) -> Monomial:
    """Greatest force across the axis of an end mill within a revolution, N."""
    return _along_helix(cut, cut.shank or cut.hardest, kienzle, factor, ForceKind.ACROSS)


def wall_force(cut: Cut, kienzle: Kienzle, factor: float) -> Monomial | None:
    """Force normal to the wall while an edge forms it, N; None where no wall is touched."""
    place = cut.wall or cut.hardest
    if place is None or not _reaches_wall(place):
        return None
    return _along_helix(cut, place, kienzle, factor, ForceKind.AT_WALL)


def _reaches_wall(place: CriticalPlace) -> bool:
    arc = place.engagement
    return arc.entry_angle <= WALL or arc.exit_angle >= pi - WALL


def _along_helix(
    cut: Cut, place: CriticalPlace | None, kienzle: Kienzle, factor: float, force: ForceKind
) -> Monomial:
    """Load that is integrated along the helical edges in the cut."""
    if place is None:
        raise ValueError("the milling cut has no engagement")
    exponent = 1.0 - kienzle.m_c
    return Monomial(
        coefficient=factor * kienzle.k_c11,
        feed_exponent=exponent,
        curve=DepthCurve(
            edges=cut.edges, place=place, law=ForceLaw(exponent=exponent), force=force
        ),
    )


@dataclass(frozen=True, slots=True)
class DepthCurve:
    """Integral of the helix forces at one place as a function of the depth of a pass, mm."""

    edges: CuttingEdges
    place: CriticalPlace
    law: ForceLaw
    force: ForceKind

    def __call__(self, depth: float) -> float:
        """Evaluate the integral at a depth in mm."""
        return _integral(self, depth)


@lru_cache(maxsize=65_536)
def _integral(curve: DepthCurve, depth: float) -> float:
    from simulator.physics import tooth_forces  # noqa: PLC0415 (numpy is slow to load)

    arc = curve.place.engagement
    place = tooth_forces.one_place(
        arc.entry_angle, arc.exit_angle, axial_depth=depth * curve.place.depth_share
    )
    is_peak = curve.force is ForceKind.ACROSS
    greatest = tooth_forces.peak_resultant if is_peak else tooth_forces.wall_force
    integral = float(greatest(curve.edges, place, curve.law)[0])
    return max(curve.place.fill * integral, LEAST)


def over_mean(curve: DepthCurve, depth: float) -> float:
    """Ratio of a force along the helix to the mean tangential force at the same place."""
    mean = milling.mean_force(
        Kienzle(k_c11=1.0, m_c=1.0 - curve.law.exponent),
        milling.MillingCut(
            feed_per_tooth=1.0,
            teeth=curve.edges.teeth,
            axial_depth=depth * curve.place.depth_share,
            engagement=curve.place.engagement,
            cutting_edge_angle=curve.edges.cutting_edge_angle,
        ),
        factor=curve.place.fill,
    )
    return curve(depth) / mean


def thrust(
    cut: Cut, kienzle: Kienzle, factor: float, point: DrillPoint = drilling.LIPS_ONLY
) -> Monomial:
    """Axial force of a drill, N; the share of the chisel edge is an offset."""
    at = _drilling_cut(cut, point)
    force = cut.fill * drilling.lip_thrust(kienzle, at, factor=factor) * _thicker(cut, kienzle)
    lips = _monomial(force, kienzle, depth=0.0)
    return replace(lips, offset=drilling.chisel_thrust(kienzle, at, factor=factor))


def motor_power(cut: Cut, force: Monomial, efficiency: float) -> Monomial:
    """Power that the main drive draws for the cut, W: ``F·π·D·n/(1000·η)``."""
    velocity = kinematics.cutting_speed(cut.power_diameter or cut.force_diameter, 1.0)
    each_newton = power.motor_power(power.cutting_power(1.0, velocity), efficiency)
    return _scaled(force, each_newton, speed=1.0)


def torque(cut: Cut, force: Monomial) -> Monomial:
    """Torque at the spindle, N·mm: ``F·D/2``."""
    return _scaled(force, 0.5 * cut.force_diameter)


def _scaled(load: Monomial, factor: float, speed: float = 0.0) -> Monomial:
    """Multiply a load by a factor and a power of the spindle speed."""
    return Monomial(
        coefficient=load.coefficient * factor,
        offset=load.offset * factor,
        feed_exponent=load.feed_exponent,
        depth_exponent=load.depth_exponent,
        curve=load.curve,
        speed_exponent=load.speed_exponent + speed,
    )


def scaled(load: Monomial, factor: float) -> Monomial:
    """Multiply a load function by a factor."""
    return _scaled(load, factor)


def _monomial(value: float, kienzle: Kienzle, *, depth: float) -> Monomial:
    """Kienzle load with a known value at the reference feed and unit depth."""
    exponent = 1.0 - kienzle.m_c
    return Monomial(
        coefficient=value / REFERENCE_FEED**exponent,
        feed_exponent=exponent,
        depth_exponent=depth,
    )


def _milling_cut(cut: Cut, place: CriticalPlace | None) -> milling.MillingCut:
    """Milling cut at one place, at the reference feed and unit depth of a pass."""
    if place is None:
        raise ValueError("the milling cut has no engagement")
    return milling.MillingCut(
        feed_per_tooth=REFERENCE_FEED,
        teeth=cut.tool.teeth,
        axial_depth=place.depth_share,
        engagement=place.engagement,
        cutting_edge_angle=cut.tool.cutting_edge_angle,
    )


def _thicker(cut: Cut, kienzle: Kienzle) -> float:
    """Force of the thickest chip relative to that of the nominal feed."""
    return float(cut.thickest ** (1.0 - kienzle.m_c))


def _drilling_cut(cut: Cut, point: DrillPoint) -> drilling.DrillingCut:
    """Drilling cut of the hole at the reference feed of one lip."""
    return drilling.DrillingCut(
        feed_per_revolution=REFERENCE_FEED * cut.tool.teeth,
        tool_diameter=cut.drilled_diameter,
        previous_diameter=cut.previous_diameter,
        teeth=cut.tool.teeth,
        cutting_edge_angle=drilling.edge_angle(cut.tool_kind, cut.tool.point_angle),
        point=point,
    )
