"""Cutting formulas of handbooks, mm, s, N, W and rev/s."""

from math import pi, sin, sqrt

from simulator.physics.drilling import DrillingCut, chisel_thrust, lip_thrust
from simulator.physics.milling import MillingCut
from simulator.spec import Kienzle, LinearEdge

RT_PER_RA = 9.0 * sqrt(3.0) / 4.0
"""of a parabola: ``f²/(8·r)`` over ``f²/(18·√3·r)``"""


def edge_mean_force(edge: LinearEdge, cut: MillingCut, *, factor: float = 1.0) -> float:
    """Altintas, mean tangential force: ``z/2π·(K_tc·a_p·f_z·C + K_te·b·(φ_ex − φ_st))``, N."""
    arc = cut.engagement
    shear = edge.k_tc * cut.axial_depth * cut.feed_per_tooth * arc.cosine_difference
    chip_width = cut.axial_depth / sin(cut.cutting_edge_angle)
    rub = edge.k_te * chip_width * arc.contact_angle
    return factor * cut.teeth / (2.0 * pi) * (shear + rub)


def effective_diameter(tool_diameter: float, axial_depth: float, *, radius: float) -> float:
    """Sandvik: ``D − 2r + 2·√(a_p·(2r − a_p))`` for a_p < r, mm."""
    if axial_depth >= radius:
        return tool_diameter
    return tool_diameter - 2.0 * radius + 2.0 * sqrt(axial_depth * (2.0 * radius - axial_depth))


def removal_power(specific_cutting_force: float, removal_rate: float) -> float:
    """``P_c = k_c·Q``, W."""
    return specific_cutting_force * removal_rate / 1000.0


def torque_power(torque: float, spindle_speed: float) -> float:
    """``P = 2π·n·M``, W."""
    return 2.0 * pi * spindle_speed * torque / 1000.0


def power_torque(power: float, spindle_speed: float) -> float:
    """``M = P/(2π·n)``, N·mm."""
    return 1000.0 * power / (2.0 * pi * spindle_speed)


def drilling_thrust(kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0) -> float:
    """Lips and chisel edge together, as catalogues print it, N."""
    lips = lip_thrust(kienzle, cut, factor=factor)
    return lips + chisel_thrust(kienzle, cut, factor=factor)


def turning_removal_rate(feed: float, *, depth: float, cutting_speed: float) -> float:
    """``Q = f·a_p·v_c``, mm³/s."""
    return feed * depth * cutting_speed


def drilling_removal_rate(
    feed: float, *, tool_diameter: float, previous_diameter: float = 0.0
) -> float:
    """``Q = π/4·(D² − d²)·v_f``, mm³/s."""
    return pi / 4.0 * (tool_diameter**2 - previous_diameter**2) * feed


def centred_overrun(tool_diameter: float, radial_width: float) -> float:
    """Mitsubishi, face milling: approach and overrun are one diameter together, mm."""
    return tool_diameter - 0.5 * (tool_diameter - sqrt(tool_diameter**2 - radial_width**2))
