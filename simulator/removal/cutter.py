"""Shape of a cutting tool: the body that its edges sweep, its holder, and a turning insert.

Units mm and rad. A rotating tool is a profile of revolution: a flat or rounded bottom, a
conical or straight flank; the tip is at height 0.
"""

from dataclasses import dataclass
from math import inf, pi

from simulator.physics.domain import (
    require_edge_angle,
    require_not_negative,
    require_positive,
)
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg


@dataclass(frozen=True, slots=True, kw_only=True)
class Holder:
    """Cylinder above the tool that must stay out of the stock."""

    diameter: float
    """Diameter, mm"""
    overhang: float
    """Overhang, mm from the tip of the tool to the holder"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    """Rotating tool: end mill, face mill, ball, bull nose, taper, drill."""

    diameter: float
    """Diameter, mm, of the cylinder, or of the cone where it begins"""
    corner_radius: float = 0.0
    """Corner radius, mm; half the diameter for a ball"""
    taper_angle: float = 0.0
    """Taper angle, rad, of the flank against the axis, positive when the tool grows upward"""
    point_angle: float = pi
    """Point angle, rad, included angle of a conical point; π: flat"""
    teeth: int = 2
    edge_length: float = inf
    """Edge length, mm of cutting edge from the tip up; above it the shank is smooth"""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle, rad, κ_r of the flank"""
    is_drill: bool = False
    """cuts with its end only, along its axis"""
    holder: Holder | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Insert:
    """Turning or grooving insert.

    Its path is that of the imaginary sharp corner, as :mod:`stepnc_model.toolpath.turning`
    programs it: of a right-hand insert the corner towards the axis and the chuck, of a
    left-hand one that towards the axis and away from the chuck, of a neutral one the point of
    the nose nearest to the axis, of a grooving blade its corner at the chuck. A boring insert
    (``is_inside``) points away from the axis.

    Raises
    ------
    ValueError
        When a length or an angle is out of its range.
    """

    nose_radius: float = 0.0
    """Nose radius, mm; of both corners of a blade"""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle, rad, κ_r of the major edge, from the feed along the axis"""
    trailing_angle: float = rad_from_deg(5.0)
    """rad, κ_r' of the minor edge from the turned surface; 5° are left by κ_r = 95° and the
    80° of the commonest insert, form C of ISO 1832"""
    width: float | None = None
    """Width, mm of a grooving blade, whose sides are upright; None: a turning insert"""
    hand: HandOfToolType = HandOfToolType.RIGHT
    """right: fed towards the chuck"""
    is_inside: bool = False
    """bores: material lies outside"""

    def __post_init__(self) -> None:
        require_not_negative(self.nose_radius, "nose radius", "mm")
        require_edge_angle(self.cutting_edge_angle)
        if not 0.0 <= self.trailing_angle < pi / 2.0:
            raise ValueError(
                f"trailing angle {self.trailing_angle:g} rad must lie between 0 and π/2 rad"
            )
        if self.width is not None:
            require_positive(self.width, "blade width", "mm")
            if 2.0 * self.nose_radius > self.width:
                raise ValueError(
                    f"corners of {self.nose_radius:g} mm must be at most half the blade's "
                    f"width, {0.5 * self.width:g} mm"
                )

    @property
    def flat(self) -> float:
        """End of a blade between the centres of its corners, mm; 0 for a turning insert."""
        return 0.0 if self.width is None else self.width - 2.0 * self.nose_radius

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the nose, or of a blade's corner at the chuck, from its tip: x, z in mm."""
        x = -self.nose_radius if self.is_inside else self.nose_radius
        if self.width is not None or self.hand is HandOfToolType.RIGHT:
            return x, self.nose_radius
        return x, -self.nose_radius if self.hand is HandOfToolType.LEFT else 0.0

    @property
    def edge_angles(self) -> tuple[float, float]:
        """Of the edge at the chuck and of the other one, each from the axis, rad."""
        if self.width is not None:
            return pi / 2.0, pi / 2.0
        if self.hand is HandOfToolType.RIGHT:
            return self.cutting_edge_angle, self.trailing_angle
        if self.hand is HandOfToolType.LEFT:
            return self.trailing_angle, self.cutting_edge_angle
        return self.cutting_edge_angle, self.cutting_edge_angle
