"""Holding capacity of a chuck, a vice or clamps by friction.

Centrifugal force acts on the jaws of a chuck, so its clamping force falls with the square of
the speed. The remaining force holds the bar against slipping (torque and axial force share the
friction) and against tilting. Units mm, N, N·mm, rev/s, kg.

Not modelled: a stop or a step of the jaws that takes axial force, clamping from inside (where
speed adds force), bars that yield under the jaws, the weight of the bar.

References
----------
.. [1] VDI 3106, "Ermittlung der zulässigen Drehzahl von Drehfuttern (Backenfuttern)"; its
   formulas as printed by Röhm, KFD-N operating manual, 2004, p. 13, and Schunk, ROTA NCX
   operating manual 03.00, pp. 23-25.
.. [2] Forkardt, 3QLC-LM operating manual, 04/2014, p. 28: tilting out of three jaws.
.. [3] Röhm, norm RN-1391, pp. 39-51: clamping coefficients, safety factors, and the resultant
   of circumferential and feed force that slips in the jaws.
.. [4] S. Timoshenko, "Strength of Materials", part I: eccentric pressure on a rectangle stays
   pressure all over while its resultant is in the middle third.
"""

from dataclasses import dataclass
from math import cos, hypot, inf, pi, sqrt, tan

from simulator.physics.domain import require_positive
from simulator.work_holding import (
    Chuck,
    Clamp,
)

NEWTONS = 1e-3
"""Newtons per kg·mm/s²."""

KERN = 1.0 / 6.0
"""Core of the grip on either side of its middle, as a share of the grip length, [4]_."""

LEAST_LEFT = 0.1
"""Least share of the clamping force at rest that must remain: no chuck turns faster. EN 1550
permits a chuck to lose two thirds of its force, which at S_sp = 1.5 is the whole counted
force."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GripSize:
    """Size of the contact between jaws and bar."""

    diameter: float
    """Diameter of the gripped bar, mm."""
    length: float
    """Length of the grip along the axis, mm."""

    def __post_init__(self) -> None:
        require_positive(self.diameter, "grip diameter", "mm")
        require_positive(self.length, "grip length", "mm")


def clamping_force(chuck: Chuck, speed: float) -> float:
    """Total force of all jaws on the bar at a spindle speed.

    ``F_sp = F_sp0/S_sp − F_c`` with ``F_c = Σ m·r_s · (2π·n)²``, [1]_; a loss given by the
    maker at one speed is also scaled with the square of the speed.

    Parameters
    ----------
    speed : float, rev/s

    Returns
    -------
    float, N
        0 from the speed at which no force remains.

    Examples
    --------
    Three jaws of 1.2 kg at 72 mm, 3000 rpm:

    >>> chuck = Chuck(
    ...     clamping_force=60_000.0, friction=0.2, source="", jaw_mass=1.2, jaw_radius=72.0
    ... )
    >>> round(clamping_force(chuck, 50.0))
    14418
    """
    return max(
        0.0, chuck.clamping_force / chuck.clamping_safety_factor - loss(chuck) * speed**2
    )


def loss(chuck: Chuck) -> float:
    """Clamping force that a chuck loses, over the square of its speed, N per (rev/s)²."""
    of_jaws = NEWTONS * chuck.jaws * chuck.jaw_mass * chuck.jaw_radius * (2.0 * pi) ** 2
    told = chuck.lost_force / chuck.lost_at**2 if chuck.lost_at > 0.0 else 0.0
    return of_jaws + told


def permitted_speed(chuck: Chuck, held: float = 0.0) -> float:
    """Speed up to which a chuck maintains a required clamping force.

    ``n = √((F_sp0/S_sp − F_spz·S_z)/Σ M_c)/2π``, [1]_.

    Parameters
    ----------
    held : float, N
        Clamping force F_spz that the cut requires; 0: up to the loss of all force.

    Returns
    -------
    float, rev/s
        0 if the force is too low at rest, infinite if the force does not depend on speed.
    """
    rest = chuck.clamping_force / chuck.clamping_safety_factor - held * chuck.safety_factor
    if rest <= 0.0:
        return 0.0
    per_square = loss(chuck)
    return sqrt(rest / per_square) if per_square > 0.0 else inf


def usable_speed(chuck: Chuck) -> float:
    """Speed at which a chuck has the share :data:`LEAST_LEFT` of its force left, rev/s."""
    return sqrt(1.0 - LEAST_LEFT) * permitted_speed(chuck)


def greatest_torque(chuck: Chuck, grip: GripSize, speed: float) -> float:
    """Torque at which a bar slips in the jaws: ``M = µ·F_sp·d/(2·S_z)``, N·mm, [3]_."""
    return 0.5 * chuck.friction * grip.diameter * _counted(chuck, speed)


def slipping_torque(torque: float, axial_force: float, grip: GripSize) -> float:
    """Equivalent torque of a torque and an axial force for slipping in the jaws, N·mm.

    The same friction holds both, so it is ``√(M² + (F_a·d/2)²)``, [3]_.
    """
    return hypot(torque, 0.5 * grip.diameter * axial_force)


def greatest_moment(chuck: Chuck, grip: GripSize, speed: float) -> float:
    """Moment across the axis at which a bar tilts out of the jaws, N·mm.

    It has two parts: axial friction of one jaw about the others, ``µ·F_sp/z · a`` with a =
    0.75·d for three jaws, [2]_; and the jaw forces, which shift by a sixth of the grip length
    before the contact opens, [4]_: ``F_sp/z · l/6 · Σ|cos|`` in the least favourable direction
    of tilting.
    """
    force = _counted(chuck, speed) / chuck.jaws
    friction = chuck.friction * grip.diameter * _arm(chuck.jaws)
    return force * (friction + KERN * grip.length * _jaws_across(chuck.jaws))


def _counted(chuck: Chuck, speed: float) -> float:
    """Clamping force over the safety factor of the cut, N."""
    return clamping_force(chuck, speed) / chuck.safety_factor


def _arm(jaws: int) -> float:
    """Distance of one jaw from the tilting axis through the others, over the diameter."""
    return 1.0 if jaws % 2 == 0 else 0.5 * (1.0 + cos(pi / jaws))


def _jaws_across(jaws: int) -> float:
    """Least Σ|cos| of equally spaced jaws over all directions."""
    return 2.0 / tan(pi / jaws) if jaws % 2 == 0 else 1.0 / tan(0.5 * pi / jaws)


def holding_force(clamp: Clamp) -> float:
    """Cutting force that a vice or clamps can hold by friction: ``µ·F/S``, N."""
    return clamp.friction * clamp.holding_force / clamp.safety_factor
