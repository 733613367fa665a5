"""Shape of a cutting tool: the body that its edges sweep, its holder, and a turning insert.

Units mm and rad. A rotating tool is a profile of revolution: a flat or rounded bottom, a
conical or straight flank; the tip is at height 0.
"""

from dataclasses import dataclass
from math import inf, pi


@dataclass(frozen=True, slots=True, kw_only=True)
class Holder:
    """Cylinder above the tool that must stay out of the stock."""

    diameter: float
    """mm"""
    overhang: float
    """mm from the tip of the tool to the holder"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    """Rotating tool: end mill, face mill, ball, bull nose, taper, drill."""

    diameter: float
    """mm, of the cylinder, or of the cone where it begins"""
    corner_radius: float = 0.0
    """mm; half the diameter for a ball"""
    taper_angle: float = 0.0
    """rad, of the flank against the axis, positive when the tool grows upward"""
    point_angle: float = pi
    """rad, included angle of a conical point; π: flat"""
    teeth: int = 2
    edge_length: float = inf
    """mm of cutting edge from the tip up; above it the shank is smooth"""
    cutting_edge_angle: float = pi / 2.0
    """rad, κ_r of the flank"""
    is_drill: bool = False
    """cuts with its end only, along its axis"""
    holder: Holder | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Insert:
    """Turning or grooving insert.

    Its path is that of the imaginary sharp corner towards the axis and the chuck.
    """

    nose_radius: float = 0.0
    """mm"""
    cutting_edge_angle: float = pi / 2.0
    """rad, κ_r"""
    width: float | None = None
    """mm of a grooving blade; None: a turning insert"""
