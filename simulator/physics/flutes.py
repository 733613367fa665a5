"""Geometry of the cutting edges of a milling cutter, and the law of their force.

:mod:`simulator.physics.tooth_forces` integrates along these edges; this module is separate so
that importing it does not load numpy. Units mm, rad.
"""

from dataclasses import dataclass
from math import pi, tan

from simulator.physics.domain import require_edge_angle, require_positive, require_teeth
from simulator.physics.milling import RADIAL_SHARE

WALL = 0.1
"""Angle, rad, from φ = 0 or π within which a contact arc counts as reaching the wall; this is
0.5 % of the radius."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingEdges:
    """Cutting edges of a milling cutter: number, helix and corner shape."""

    teeth: int
    """Number of teeth z."""
    diameter: float
    """Diameter D, mm."""
    helix_angle: float = 0.0
    """Helix angle λ_s, rad."""
    corner_radius: float = 0.0
    """Corner radius, mm; half the diameter for a ball."""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle κ_r of the flank, rad."""

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
        """Lag angle ψ of the edge per mm of height, rad/mm."""
        return 2.0 * tan(self.helix_angle) / self.diameter


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceLaw:
    """Law of the force of an edge as a function of its chip thickness."""

    exponent: float
    """Exponent q = 1 − m_c."""
    radial_share: float = RADIAL_SHARE
    """Radial over tangential force, F_r/F_t."""
