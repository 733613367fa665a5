"""Shape of a cutting tool: the body swept by its edges, its holder, and a turning insert.

Units mm and rad. A rotating tool is a profile of revolution with a flat or rounded bottom and a
conical or straight flank; its tip is at height 0.

Body of revolution that a rotating cutter sweeps, as a few numbers for the kernels.

The profile is the height above the tip as a function of the distance from the axis. It is
convex and never falls: a flat or a conical point, an arc of the corner radius, and a conical or
cylindrical flank. The arc ends where it touches the flank, so that a ball with a tapered neck
stays a ball at its tip. Above the edge the shank is a cylinder as wide as the edge is there.
Units mm.

The shape of a tool is made from what a program says of it.
"""

from dataclasses import dataclass
from math import cos, inf, pi, sin, sqrt, tan
from typing import NamedTuple

from simulator.kernels.kernel import kernel
from simulator.physics.domain import (
    require_edge_angle,
    require_not_negative,
    require_positive,
)
from simulator.physics.drilling import edge_angle
from simulator.spec import ToolKind
from simulator.tool_kind import tool_kind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.tools import CuttingTool, MillingCuttingTool, TaperedEndmill
from stepnc_model.entities.turning_tools import (
    GroovingTool,
    KnurlingTool,
    TurningMachineCuttingTool,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import Tool, tool_of, user_tool_for
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

    @property
    def overhang(self) -> float | None:
        """Distance from the tip to the holder, mm; None if no holder is known."""
        return None if self.holder is None else self.holder.overhang


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


SMALL_CORNER = 0.25
"""Largest corner radius over tool radius for which outlines count as exact; with rounder ends
the section depends on how the end is sliced."""

_STRAIGHT = 1e-9  # rad; a smaller taper counts as zero


class CutterProfile(NamedTuple):
    """Profile of revolution of a rotating tool."""

    slope: float
    """Rise of the point per mm of radius; 0 for a flat end."""
    flat: float
    """Distance from the axis to where the point or flat ends and the corner begins, mm."""
    corner: float
    """Corner radius, mm."""
    tangent: float
    """Distance from the axis to where the corner ends and the flank begins, mm."""
    shoulder: float
    """Height above the tip at which the corner ends and the flank begins, mm."""
    flank: float
    """Rise of the flank per mm of radius; 0 for a cylinder, whose flank is vertical."""
    radius: float
    """Greatest radius, mm."""


def profile_of(cutter: Cutter, *, reach: float) -> CutterProfile:
    """Profile of revolution of a cutter.

    Parameters
    ----------
    reach : float, mm
        Height above the tip up to which a tapered flank of unlimited length is followed.

    Raises
    ------
    ValueError
        If the diameter is not positive, the corner does not fit, or the tool is wider at its
        tip than above, which a height map cannot represent.
    """
    radius, corner = 0.5 * cutter.diameter, cutter.corner_radius
    if not 0.0 < radius < inf:
        raise ValueError(f"diameter {cutter.diameter:g} mm must be positive and finite")
    if not 0.0 <= corner <= radius * (1.0 + 1e-9):
        raise ValueError(f"corner radius {corner:g} mm must lie between 0 and {radius:g} mm")
    if not 0.0 <= cutter.taper_angle < 0.5 * pi:
        raise ValueError(f"taper {cutter.taper_angle:g} rad must lie between 0 and π/2 rad")
    if not 0.0 < cutter.point_angle <= pi:
        raise ValueError(f"point angle {cutter.point_angle:g} rad must lie in (0, π] rad")
    if cutter.point_angle < pi:
        slope = 1.0 / tan(0.5 * cutter.point_angle)
        return CutterProfile(slope, radius, 0.0, radius, slope * radius, 0.0, radius)
    flat = max(radius - corner, 0.0)
    if cutter.taper_angle < _STRAIGHT:
        return CutterProfile(0.0, flat, corner, radius, corner, 0.0, radius)
    tangent = flat + corner * cos(cutter.taper_angle)
    shoulder = corner * (1.0 - sin(cutter.taper_angle))
    flank = 1.0 / tan(cutter.taper_angle)
    top = max(min(cutter.edge_length, reach), shoulder)
    widest = tangent + (top - shoulder) / flank
    return CutterProfile(0.0, flat, corner, tangent, shoulder, flank, widest)


def cylinder(radius: float) -> CutterProfile:
    """Profile of a plain cylinder."""
    return CutterProfile(0.0, radius, 0.0, radius, 0.0, 0.0, radius)


@kernel
def is_plain(profile: CutterProfile) -> bool:
    """True if the tool is a cylinder with a flat end and sharp corners."""
    return profile.slope == 0.0 and profile.flat == profile.radius


@kernel
def is_upright(profile: CutterProfile) -> bool:
    """True if the tool is a cylinder with a flat end and sharp or slightly rounded corners."""
    has_small_corner = profile.corner <= SMALL_CORNER * profile.radius
    return profile.slope == 0.0 and profile.flank == 0.0 and has_small_corner


@kernel
def rise(profile: CutterProfile, distance: float) -> float:
    """Height of the profile above the tip at a distance from the axis, mm."""
    if distance <= profile.flat:
        return profile.slope * distance
    if distance <= profile.tangent:
        beyond = distance - profile.flat
        return profile.corner - sqrt(max(profile.corner**2 - beyond**2, 0.0))
    return profile.shoulder + profile.flank * (distance - profile.tangent)


@kernel
def steepness(profile: CutterProfile, distance: float) -> float:
    """Slope of the profile at a distance from the axis: the derivative of :func:`rise`."""
    if distance <= profile.flat:
        return profile.slope
    if distance <= profile.tangent:
        beyond = distance - profile.flat
        return beyond / sqrt(max(profile.corner**2 - beyond**2, 1e-24))
    return profile.flank


@kernel
def radius_at(profile: CutterProfile, height: float) -> float:
    """Distance from the axis to the surface at a height above the tip, mm."""
    if profile.slope > 0.0:
        return min(height / profile.slope, profile.radius)
    if height < profile.shoulder:
        return profile.flat + sqrt(max(height * (2.0 * profile.corner - height), 0.0))
    if profile.flank > 0.0:
        beyond = (height - profile.shoulder) / profile.flank
        return min(profile.tangent + beyond, profile.radius)
    return profile.radius


HOLDER_SHARE = 2.0
"""Diameter of a holder over that of its tool if the program gives none, as for a collet
chuck."""


STEEPEST_DEG = 80.0
"""Largest angle between the flank of a tapered tool and its axis, degrees."""

ENDS = {ToolKind.DRILL, ToolKind.CENTER_DRILL, ToolKind.REAMER, ToolKind.COUNTERSINK}
"""Kinds of tools that cut with their end only."""

THREADS = {ToolKind.TAP, ToolKind.THREADING}
"""Kinds of tools that cut threads, which the map of a stock cannot represent."""


def shape_of(program: Program, ref: Ref[Entity]) -> Cutter | Insert | None:
    """Shape of a tool; None if the map cannot represent its cut (threads, knurls).

    Raises
    ------
    SchemaError
        If the tool cannot be used.
    """
    tool, entity = tool_of(program, ref), program.get(ref)
    if tool_kind(tool) in THREADS or isinstance(entity, KnurlingTool):
        return None
    given = user_tool_for(program, ref)
    if given is not None and given.insert is not None:
        return Insert(
            nose_radius=given.corner_radius,
            cutting_edge_angle=given.insert.cutting_edge_angle,
            trailing_angle=given.insert.trailing_angle,
            width=given.insert.width,
            hand=given.insert.hand,
        )
    try:
        if isinstance(entity, TurningMachineCuttingTool):
            return _insert(program, tool, entity)
        shape = _cutter(program, tool, entity)
        profile_of(shape, reach=shape.diameter)
    except ValueError as error:
        raise program.error(str(error), ref) from error
    return shape


def _insert(program: Program, tool: Tool, entity: TurningMachineCuttingTool) -> Insert:
    width, radius = tool.width, tool.corner_radius or 0.0
    if isinstance(entity, GroovingTool) and entity.corner_radius is not None:
        radius = entity.corner_radius
    shape = Insert(
        nose_radius=radius if width is None else min(radius, 0.5 * width),
        cutting_edge_angle=tool.cutting_edge_angle,
        width=width,
        hand=entity.hand_of_tool or HandOfToolType.RIGHT,
    )
    included = program.get(entity.cutting_edge).tool_included_angle
    if not included or width is not None:
        return shape
    trailing = pi - tool.cutting_edge_angle - rad_from_deg(included)
    return Insert(
        nose_radius=shape.nose_radius,
        cutting_edge_angle=shape.cutting_edge_angle,
        trailing_angle=min(max(trailing, 0.0), 0.49 * pi),
        hand=shape.hand,
    )


def _cutter(program: Program, tool: Tool, entity: Entity) -> Cutter:
    kind = tool_kind(tool)
    is_end = kind in ENDS
    return Cutter(
        diameter=tool.diameter,
        corner_radius=0.0 if is_end else min(tool.corner_radius or 0.0, 0.5 * tool.diameter),
        taper_angle=_taper(program, entity),
        point_angle=2.0 * edge_angle(kind, tool.point_angle) if is_end else pi,
        teeth=tool.teeth,
        edge_length=tool.cutting_edge_length or inf,
        cutting_edge_angle=tool.cutting_edge_angle,
        is_drill=is_end,
        holder=_holder(tool, entity),
    )


def _taper(program: Program, entity: Entity) -> float:
    if not isinstance(entity, MillingCuttingTool) or entity.its_tool_body is None:
        return 0.0
    body = program.get(entity.its_tool_body)
    angle = body.taper_angle if isinstance(body, TaperedEndmill) else None
    if angle is not None and not 0.0 <= angle <= STEEPEST_DEG:
        message = f"taper angle {angle:g}° is out of range; allowed: 0 to {STEEPEST_DEG:g}°"
        raise program.error(message, entity.its_tool_body, "taper_angle")
    return rad_from_deg(angle) if angle else 0.0


def _holder(tool: Tool, entity: Entity) -> Holder | None:
    """Collet chuck at the tool's assembly length; None if no length is given."""
    length = entity.overall_assembly_length if isinstance(entity, CuttingTool) else None
    if not length:
        return None
    return Holder(diameter=HOLDER_SHARE * tool.diameter, overhang=length)
