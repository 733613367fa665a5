"""Edges of a milling cutter along its helix, and how their force follows from the chip.

What :mod:`simulator.physics.tooth_forces` integrates along; apart from it, so that who only
speaks of edges loads no arrays. Units mm, rad.
"""

from dataclasses import dataclass
from math import pi, tan

from simulator.physics.domain import require_edge_angle, require_positive, require_teeth
from simulator.physics.milling import RADIAL_SHARE

WALL = 0.1
"""rad from φ = 0 or π within which an arc of contact reaches the wall: 0.5 % of the radius"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingEdges:
    """Edges of a milling cutter: how many, how far they are twisted, how they end."""

    teeth: int
    """z"""
    diameter: float
    """D, mm"""
    helix_angle: float = 0.0
    """λ_s, rad"""
    corner_radius: float = 0.0
    """Corner radius, mm; half the diameter for a ball"""
    cutting_edge_angle: float = pi / 2.0
    """κ_r of the flank, rad"""

    def __post_init__(self) -> None:
        require_teeth(self.teeth)
        require_positive(self.diameter, "tool diameter", "mm")
        require_edge_angle(self.cutting_edge_angle)
        if not 0.0 <= self.helix_angle < 0.5 * pi:
            raise ValueError(f"helix angle {self.helix_angle:g} rad must lie in [0, π/2) rad")

    @property
    def pitch(self) -> float:
        """Angle between two teeth, rad."""
        return 2.0 * pi / self.teeth

    @property
    def lag(self) -> float:
        """ψ of each mm of height, rad/mm."""
        return 2.0 * tan(self.helix_angle) / self.diameter


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceLaw:
    """Law of the force of an edge over its chip."""

    exponent: float
    """q = 1 − m_c"""
    radial_share: float = RADIAL_SHARE
    """F_r/F_t"""
