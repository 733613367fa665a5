"""Outlines of turning features in the half plane of the lathe: lines and arcs of z and x.

A feature extends from its placement in the negative z direction; its profile lies in its
x-z plane, or where the profile is placed. The radius of a revolved feature is measured to the
origin of its profile. A taper reduces the diameter away from the placement. A shoulder reaches
up to the outside of the stock.

A groove is placed at its middle; the radius of the feature is the radius of the groove bottom.
The width of a square U profile is measured at its floor, its wall angles from the perpendicular
to the axis; the first wall is the front one. Walls extend to the outside of the stock.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import acos, atan2, cos, dist, hypot, pi, sin, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.profiles import (
    DiameterTaper,
    GeneralProfile,
    LinearProfile,
    PartialCircularProfile,
    RoundedUProfile,
    SquareUProfile,
    TeeProfile,
    VeeProfile,
)
from stepnc_model.entities.turning import (
    GeneralRevolution,
    Groove,
    Knurl,
    OuterDiameter,
    OuterDiameterToShoulder,
    RevolvedFeature,
    RevolvedFlat,
    RevolvedRound,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import size_or_zero, vee_angle
from stepnc_model.toolpath.curve import Bend, Segment, segments_of
from stepnc_model.toolpath.frame import Frame, frame_of
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.profile import ProfilePiece, Spot, arc_pieces
from stepnc_model.units import rad_from_deg

STRAIGHT = 1e-9
"""Smallest angle between two lines that counts as a corner, rad."""


def groove_pieces(
    job: ToolPathTask, feature: Groove, frame: Frame, reach: float
) -> tuple[ProfilePiece, ...]:
    """Section of a groove: pieces in z and x from the front wall to the wall at the chuck."""
    program = job.program
    profile = program.get(feature.sweep)
    _check_face(job, feature, frame)
    placed = frame.inner(frame_of(program, profile.placement))
    middle, bottom = placed.origin[2], feature.radius
    if bottom >= reach:
        message = (
            f"groove bottom at radius {bottom:g} mm: outside the stock radius {reach:g} mm"
        )
        raise job.fault(message, feature.sweep)
    height = reach - bottom
    if isinstance(profile, SquareUProfile):
        return tuple(_square(job, profile, (middle, bottom), height))
    if isinstance(profile, RoundedUProfile):
        radius = 0.5 * size_or_zero(job.program, profile.width)
        return tuple(_round(radius, (middle, bottom), height))
    if isinstance(profile, VeeProfile):
        return tuple(_vee(job, profile, (middle, bottom), height))
    if isinstance(profile, PartialCircularProfile):
        radius, turn = (
            size_or_zero(job.program, profile.radius),
            rad_from_deg(profile.sweep_angle),
        )
        return tuple(_bowl(radius, turn, (middle, bottom)))
    if isinstance(profile, GeneralProfile):
        pieces = tuple(_general(job, feature, profile, placed))
        _check_open(job, feature, pieces)
        return pieces
    if isinstance(profile, TeeProfile):
        message = "a tee groove is wider below than at its mouth: plunging cannot reach it"
        raise job.fault(message, feature.sweep)
    raise job.fault("a groove with this kind of profile cannot be turned", feature.sweep)


def _check_face(job: ToolPathTask, feature: Groove, frame: Frame) -> None:
    """Check that the groove opens outwards: its material must lie below it, not along z."""
    side = feature.material_side
    if side is None:
        return
    ratios = (*job.program.get(side).direction_ratios, 0.0, 0.0, 0.0)[:3]
    x, y, z = map(float, ratios)
    if abs(frame.direction((x, y, z))[2]) > abs(x):
        message = (
            "the groove's material side points along the axis: face grooves are not supported"
        )
        raise job.fault(message, side)


def _check_open(job: ToolPathTask, feature: Groove, pieces: Sequence[ProfilePiece]) -> None:
    """Check that the whole groove section is visible from outside, from wall to wall."""
    if not pieces:
        return
    towards = 1.0 if pieces[-1].end[0] > pieces[0].start[0] else -1.0
    if any((piece.end[0] - piece.start[0]) * towards < -STRAIGHT for piece in pieces):
        message = (
            "the groove opens to a face or is undercut: a plunge from outside cannot reach it"
        )
        raise job.fault(message, feature.sweep)


def rounded(corners: Sequence[Spot], radii: Sequence[float]) -> Iterator[ProfilePiece]:
    """Lines between corners, with an arc of the given radius at each inner corner."""
    start = corners[0]
    for index in range(1, len(corners) - 1):
        before, corner, after = corners[index - 1], corners[index], corners[index + 1]
        first, second = dist(before, corner), dist(corner, after)
        p = ((corner[0] - before[0]) / first, (corner[1] - before[1]) / first)
        q = ((after[0] - corner[0]) / second, (after[1] - corner[1]) / second)
        cross = p[0] * q[1] - p[1] * q[0]
        angle = acos(max(-1.0, min(1.0, p[0] * q[0] + p[1] * q[1])))
        radius = radii[index]
        if radius <= 0.0 or angle < STRAIGHT:
            yield ProfilePiece(start=start, end=corner)
            start = corner
            continue
        back = radius * tan(0.5 * angle)
        sign = 1.0 if cross > 0.0 else -1.0
        foot = (corner[0] - back * p[0], corner[1] - back * p[1])
        end = (corner[0] + back * q[0], corner[1] + back * q[1])
        centre = (foot[0] - sign * radius * p[1], foot[1] + sign * radius * p[0])
        if dist(start, foot) > STRAIGHT:
            yield ProfilePiece(start=start, end=foot)
        yield from arc_pieces(foot, end, centre=centre, turn=sign * angle)
        start = end
    if dist(start, corners[-1]) > STRAIGHT:
        yield ProfilePiece(start=start, end=corners[-1])


def _square(
    job: ToolPathTask, profile: SquareUProfile, foot: Spot, height: float
) -> Iterator[ProfilePiece]:
    half = 0.5 * size_or_zero(job.program, profile.width)
    z, x = foot
    first, second = (
        height * tan(rad_from_deg(angle))
        for angle in (profile.first_angle, profile.second_angle)
    )
    corners = [
        (z + half + first, x + height),
        (z + half, x),
        (z - half, x),
        (z - half - second, x + height),
    ]
    radii = [
        size_or_zero(job.program, profile.first_radius),
        size_or_zero(job.program, profile.second_radius),
    ]
    if sum(radii) > 2.0 * half + STRAIGHT:
        message = (
            f"corners of {radii[0]:g} and {radii[1]:g} mm exceed the width {2 * half:g} mm"
        )
        raise job.fault(message, profile.width)
    return rounded(corners, [0.0, *radii, 0.0])


def _round(radius: float, foot: Spot, height: float) -> Iterator[ProfilePiece]:
    z, x = foot
    centre = (z, x + radius)
    top = max(x + height, x + radius)
    if top > x + radius:
        yield ProfilePiece(start=(z + radius, top), end=(z + radius, x + radius))
    yield from arc_pieces(
        (z + radius, x + radius), (z - radius, x + radius), centre=centre, turn=-pi
    )
    if top > x + radius:
        yield ProfilePiece(start=(z - radius, x + radius), end=(z - radius, top))


def _vee(
    job: ToolPathTask, profile: VeeProfile, foot: Spot, height: float
) -> Iterator[ProfilePiece]:
    half = 0.5 * vee_angle(profile.profile_angle)
    tilt = rad_from_deg(profile.tilt_angle or 0.0)
    radius = size_or_zero(job.program, profile.profile_radius)
    # The radius is measured to the rounded bottom: the sharp corner lies below it.
    apex = foot[1] - radius * (1.0 / sin(half) - 1.0)
    rise = foot[1] + height - apex
    if max(abs(tilt + half), abs(tilt - half)) >= 0.5 * pi:
        raise job.fault(
            "a wall of the vee is tilted beyond the horizontal", profile.profile_radius
        )
    corners = [
        (foot[0] + rise * tan(half + tilt), apex + rise),
        (foot[0], apex),
        (foot[0] - rise * tan(half - tilt), apex + rise),
    ]
    return rounded(corners, [0.0, radius, 0.0])


def _bowl(radius: float, turn: float, foot: Spot) -> Iterator[ProfilePiece]:
    z, x = foot
    centre = (z, x + radius)
    half = 0.5 * turn
    ends = [(z + s * radius * sin(half), x + radius - radius * cos(half)) for s in (1.0, -1.0)]
    return arc_pieces(ends[0], ends[1], centre=centre, turn=-turn)


def _general(
    job: ToolPathTask, feature: Groove, profile: GeneralProfile, frame: Frame
) -> Iterator[ProfilePiece]:
    """Pieces of a groove whose profile is a general curve in the feature's x-z plane."""
    pieces: list[ProfilePiece] = []
    for segment in segments_of(job.program, profile.its_profile):
        at = segment.within(frame)
        (z, x), (end_z, end_x) = ((p[2], feature.radius + p[0]) for p in (at.start, at.end))
        if at.bend is None:
            pieces.append(ProfilePiece(start=(z, x), end=(end_z, end_x)))
            continue
        if abs(abs(at.bend.normal[1]) - 1.0) > STRAIGHT:
            raise job.fault("an arc does not lie in a plane through the axis", feature.sweep)
        turn = at.bend.turn if at.bend.normal[1] > 0.0 else -at.bend.turn
        centre = (at.bend.centre[2], feature.radius + at.bend.centre[0])
        pieces += arc_pieces((z, x), (end_z, end_x), centre=centre, turn=turn)
    if any(a.end != b.start and dist(a.end, b.start) > 0.01 for a, b in pairwise(pieces)):
        raise job.fault("the profile segments do not join", feature.sweep)
    return iter(pieces)


IN_PLANE = 1e-3
"""Greatest distance by which a profile may leave its plane through the axis, mm."""

ALONG_AXIS = 1e-6
"""Greatest sine of the angle between a feature's axis and the spindle axis."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureOutline:
    """Surface of a turning feature, ordered from the front to the chuck."""

    ref: Ref[Entity]
    pieces: tuple[ProfilePiece, ...]
    """Lines and arcs in z and x, front first."""

    @property
    def low(self) -> float:
        """Least z coordinate of the feature's surface, mm."""
        return min(piece.low for piece in self.pieces)

    @property
    def high(self) -> float:
        """Greatest z coordinate of the feature's surface, mm."""
        return max(piece.high for piece in self.pieces)

    @property
    def radii(self) -> tuple[float, float]:
        """Least and greatest radius among the end points of the pieces, mm."""
        values = [x for piece in self.pieces for _, x in (piece.start, piece.end)]
        return min(values), max(values)


def outline_of(job: ToolPathTask, ref: Ref[Entity], reach: float) -> FeatureOutline:
    """Outline of a turning feature in the half plane of the lathe.

    Parameters
    ----------
    ref : Ref
        A turning feature.
    reach : float, mm
        Radius to which the walls of grooves and shoulders extend.

    Raises
    ------
    PathError, SchemaError
        If it is not an outside turning feature, or its axis is not the spindle axis.
    """
    program = job.program
    with program.using(ref):
        feature = program.get(ref)
        frame = job.frame(ref)
        _check_axis(job, ref, frame)
        if isinstance(feature, Knurl):
            return outline_of(job, feature.base_feature, reach)
        if isinstance(feature, RevolvedFeature):
            _check_side(job, ref, frame, feature.material_side)
        if isinstance(feature, Groove):
            pieces = groove_pieces(job, feature, frame, reach)
        elif isinstance(feature, OuterDiameterToShoulder):
            pieces = _shouldered(job, feature, frame, reach)
        else:
            pieces = _in_half_plane(job, ref, _segments(job, ref, feature, frame))
    if not pieces:
        raise job.fault("the feature's profile has no length", ref)
    return FeatureOutline(ref=ref, pieces=_front_first(pieces))


def _segments(
    job: ToolPathTask, ref: Ref[Entity], feature: Entity, frame: Frame
) -> Sequence[Segment]:
    """Lines and arcs of a feature in setup coordinates."""
    program = job.program
    if isinstance(feature, OuterDiameter):
        return (_cylinder(job, ref, feature).within(frame),)
    if not isinstance(feature, (RevolvedFlat, RevolvedRound, GeneralRevolution)):
        raise job.fault("a feature of this kind cannot be turned", ref)
    at_radius = Frame(origin=(feature.radius, 0.0, 0.0))
    if isinstance(feature, GeneralRevolution):
        profile: GeneralProfile | LinearProfile | PartialCircularProfile = program.get(
            feature.outer_edge_profile
        )
    elif isinstance(feature, RevolvedFlat):
        profile = program.get(feature.flat_edge_shape)
    else:
        profile = program.get(feature.rounded_edge_shape)
    plane = frame.inner(at_radius)
    if profile.placement is not None:
        plane = plane.inner(frame_of(program, profile.placement))
    elif isinstance(profile, PartialCircularProfile):
        # Without a placement the arc turns in the half plane, from x towards z.
        plane = plane.inner(Frame(y=(0.0, 0.0, 1.0), z=(0.0, -1.0, 0.0)))
    if isinstance(profile, GeneralProfile):
        return [s.within(plane) for s in segments_of(program, profile.its_profile)]
    if isinstance(profile, LinearProfile):
        length = float(program.get(profile.profile_length).its_parameter_value)
        return (Segment(start=(0.0, 0.0, 0.0), end=(length, 0.0, 0.0)).within(plane),)
    radius = size_or_zero(job.program, profile.radius)
    turn = rad_from_deg(profile.sweep_angle)
    end = (radius * cos(turn), radius * sin(turn), 0.0)
    bend = Bend(centre=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), turn=turn)
    return (Segment(start=(radius, 0.0, 0.0), end=end, bend=bend).within(plane),)


def _cylinder(job: ToolPathTask, ref: Ref[Entity], feature: OuterDiameter) -> Segment:
    """Generating line of a cylinder or cone, starting at the feature's placement."""
    radius = 0.5 * size_or_zero(job.program, feature.diameter_at_placement)
    length = size_or_zero(job.program, feature.feature_length)
    end = radius
    if feature.reduced_size is not None:
        taper = job.program.get(feature.reduced_size)
        if isinstance(taper, DiameterTaper):
            end = 0.5 * size_or_zero(job.program, taper.final_diameter)
        else:
            end = radius - length * tan(rad_from_deg(taper.angle))
    if end < 0.0:
        message = f"the taper ends at radius {end:.4g} mm, beyond the axis"
        raise job.fault(message, ref, "reduced_size")
    return Segment(start=(radius, 0.0, 0.0), end=(end, 0.0, -length))


def _shouldered(
    job: ToolPathTask, feature: OuterDiameterToShoulder, frame: Frame, reach: float
) -> tuple[ProfilePiece, ...]:
    """Cylinder and shoulder with the corner radius between them."""
    program = job.program
    vee = program.get(feature.v_shape_boundary)
    if vee.placement is None:
        raise job.fault("the shoulder profile has no placement", feature.v_shape_boundary)
    start = frame.origin[2]
    end = frame.point(frame_of(program, vee.placement).origin)[2]
    radius = 0.5 * size_or_zero(job.program, feature.diameter_at_placement)
    angle = vee_angle(vee.profile_angle)
    rise = max(reach - radius, 0.0)
    lean = rise / tan(angle) if abs(sin(angle)) > ALONG_AXIS else 0.0
    towards = 1.0 if start >= end else -1.0
    corners = [(start, radius), (end, radius), (end + towards * lean, radius + rise)]
    corner = size_or_zero(job.program, vee.profile_radius)
    return tuple(rounded(corners, [0.0, corner, 0.0]))


def _in_half_plane(
    job: ToolPathTask, ref: Ref[Entity], segments: Sequence[Segment]
) -> tuple[ProfilePiece, ...]:
    """Convert segments in the setup to pieces in z and x, rotated about the axis into y = 0."""
    points = [point for segment in segments for point in (segment.start, segment.end)]
    far = max(points, key=lambda point: hypot(point[0], point[1]))
    angle = atan2(far[1], far[0])
    across, along = -sin(angle), cos(angle)
    if any(abs(x * across + y * along) > IN_PLANE for x, y, _ in points):
        raise job.fault("the profile does not lie in a plane through the spindle axis", ref)
    pieces: list[ProfilePiece] = []
    for segment in segments:
        (z, x), (end_z, end_x) = (
            (p[2], p[0] * along - p[1] * across) for p in (segment.start, segment.end)
        )
        if segment.bend is None:
            pieces.append(ProfilePiece(start=(z, x), end=(end_z, end_x)))
            continue
        centre, normal = segment.bend.centre, segment.bend.normal
        beside = normal[0] * across + normal[1] * along
        if abs(abs(beside) - 1.0) > ALONG_AXIS:
            raise job.fault("an arc does not lie in a plane through the spindle axis", ref)
        turn = segment.bend.turn if beside > 0.0 else -segment.bend.turn
        middle = (centre[2], centre[0] * along - centre[1] * across)
        pieces += arc_pieces((z, x), (end_z, end_x), centre=middle, turn=turn)
    return tuple(pieces)


def _front_first(pieces: Iterable[ProfilePiece]) -> tuple[ProfilePiece, ...]:
    """Order the pieces by falling z; a face starts at the axis."""
    forward = tuple(pieces)
    start, end = forward[0].start, forward[-1].end
    if (start[0], -start[1]) < (end[0], -end[1]):
        return tuple(piece.reversed() for piece in reversed(forward))
    return forward


def _check_axis(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> None:
    """Check that the feature's axis coincides with the spindle axis."""
    if abs(abs(frame.z[2]) - 1.0) > ALONG_AXIS:
        raise job.fault(
            "the feature's axis is not parallel to the spindle axis", ref, "feature_placement"
        )
    beside = hypot(frame.origin[0], frame.origin[1])
    if beside > IN_PLANE:
        message = f"the feature's placement lies {beside:.4g} mm off the spindle axis"
        raise job.fault(message, ref, "feature_placement")


def _check_side(
    job: ToolPathTask, ref: Ref[Entity], frame: Frame, side: Ref[Direction] | None
) -> None:
    """Check that the material lies inside the surface or towards the chuck."""
    if side is None:
        return
    ratios = (*job.program.get(side).direction_ratios, 0.0, 0.0, 0.0)[:3]
    outwards = ratios[0]
    away = frame.direction((float(ratios[0]), float(ratios[1]), float(ratios[2])))[2]
    if outwards > abs(away) and outwards > 0.0:
        message = "the material lies outside the surface: internal turning is not supported"
        raise job.fault(message, ref, "material_side")
    if away > abs(outwards) and away > 0.0:
        message = "the material lies away from the chuck: back facing is not supported"
        raise job.fault(message, ref, "material_side")
