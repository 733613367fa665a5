"""Spindles in motion by textbooks and papers, kg·m², rev/s, N·mm, J, W."""

from math import log1p, pi

from simulator.physics.spindle import idle_power
from simulator.spec import Spindle


def running_torque(spindle: Spindle, speed: float) -> float:
    """Shin et al., 2016, Appendix 1 (14): ``T_run = η·P_idle/(2π·n)``, N·mm."""
    return 1000.0 * spindle.efficiency * idle_power(spindle, speed) / (2.0 * pi * speed)


def kinetic_energy(inertia: float, speed: float) -> float:
    """``½·J·(2πn)²``, J."""
    return 0.5 * inertia * (2.0 * pi * speed) ** 2


def petroff_torque(
    viscosity: float, speed: float, *, diameter: float, length: float, gap: float
) -> float:
    """Petroff's law, ``(π/4)·μ·D³·L·ω/gap`` with μ in N·s/mm², N·mm."""
    return pi / 4.0 * viscosity * diameter**3 * length * 2.0 * pi * speed / gap


def coast_down_time(
    inertia: float, speed: float, *, dry_torque: float, viscous: float
) -> float:
    """``t = (J/B)·ln(1 + B·ω/T_c)``, the solution of ``J·dω/dt = −T_c − B·ω``, s."""
    return 1000.0 * inertia / viscous * log1p(viscous * 2.0 * pi * speed / dry_torque)
