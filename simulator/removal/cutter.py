"""Shape of a cutting tool: the body swept by its edges, its holder, and a turning insert.

Units mm and rad. A rotating tool is a profile of revolution with a flat or rounded bottom and a
conical or straight flank; its tip is at height 0.
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
    """Cylindrical tool holder above the tool, which must stay out of the stock."""

    diameter: float
    """Diameter of the holder, mm."""
    overhang: float
    """Distance from the tip of the tool to the holder, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    """Shape of a rotating tool: end mill, face mill, ball, bull nose, taper or drill."""

    diameter: float
    """Diameter of the cylinder, or of the cone at its lower end, mm."""
    corner_radius: float = 0.0
    """Corner radius, mm; half the diameter for a ball."""
    taper_angle: float = 0.0
    """Angle between the flank and the axis, rad, positive when the tool widens upward."""
    point_angle: float = pi
    """Included angle of a conical point, rad; π for a flat end."""
    teeth: int = 2
    edge_length: float = inf
    """Length of the cutting edge from the tip up, mm; above it the shank is smooth."""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle κ_r of the flank, rad."""
    is_drill: bool = False
    """Whether the tool cuts with its end only, along its axis."""
    holder: Holder | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Insert:
    """Shape of a turning or grooving insert.

    The programmed path is that of the imaginary sharp corner, as in
    :mod:`stepnc_model.toolpath.turning`: for a right-hand insert the corner towards the axis
    and the chuck; for a left-hand insert the corner towards the axis and away from the chuck;
    for a neutral insert the point of the nose nearest to the axis; for a grooving blade its
    corner at the chuck. A boring insert (``is_inside``) points away from the axis.

    Raises
    ------
    ValueError
        If a length or an angle is out of its range.
    """

    nose_radius: float = 0.0
    """Nose radius, mm; for a grooving blade, radius of both corners."""
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle κ_r of the major edge, rad, measured from the feed along the axis."""
    trailing_angle: float = rad_from_deg(5.0)
    """Angle κ_r' between the minor edge and the turned surface, rad; 5° remain for κ_r = 95°
    and the 80° of the most common insert, form C of ISO 1832."""
    width: float | None = None
    """Width of a grooving blade with upright sides, mm; None for a turning insert."""
    hand: HandOfToolType = HandOfToolType.RIGHT
    """Hand of the insert; a right-hand insert feeds towards the chuck."""
    is_inside: bool = False
    """Whether the insert bores, so that the material lies outside."""

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
                    f"corner radius {self.nose_radius:g} mm must be at most half the blade "
                    f"width, {0.5 * self.width:g} mm"
                )

    @property
    def flat(self) -> float:
        """Length of a blade's end between the centres of its corners, mm; 0 if not a blade."""
        return 0.0 if self.width is None else self.width - 2.0 * self.nose_radius

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the nose, or of a blade's corner at the chuck, from the tip: x, z, mm."""
        x = -self.nose_radius if self.is_inside else self.nose_radius
        if self.width is not None or self.hand is HandOfToolType.RIGHT:
            return x, self.nose_radius
        return x, -self.nose_radius if self.hand is HandOfToolType.LEFT else 0.0

    @property
    def edge_angles(self) -> tuple[float, float]:
        """Angles of the edge at the chuck and of the other edge, each from the axis, rad."""
        if self.width is not None:
            return pi / 2.0, pi / 2.0
        if self.hand is HandOfToolType.RIGHT:
            return self.cutting_edge_angle, self.trailing_angle
        if self.hand is HandOfToolType.LEFT:
            return self.trailing_angle, self.cutting_edge_angle
        return self.cutting_edge_angle, self.cutting_edge_angle
