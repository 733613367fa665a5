"""Outlines of turning features in the half plane of the lathe: lines and arcs of z and x.

A feature reaches from its placement against its z axis; its profile lies in its x, z plane,
or where the profile is placed. The radius of a revolved feature is that of its profile's
origin. A taper reduces the diameter away from the placement. A shoulder reaches up to the
outside of the stock.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, sin, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.profiles import (
    DiameterTaper,
    GeneralProfile,
    LinearProfile,
    PartialCircularProfile,
)
from stepnc_model.entities.turning_features import (
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
from stepnc_model.toolpath.curve import Bend, Segment, segments_of
from stepnc_model.toolpath.frame import Frame, frame_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.piece import Piece, arc_pieces
from stepnc_model.toolpath.turning.sweep import groove_pieces, rounded, size_of, vee_angle
from stepnc_model.units import rad_from_deg

IN_PLANE = 1e-3
"""mm by which a profile may leave its plane through the axis"""

ALONG_AXIS = 1e-6
"""sine between the axis of a feature and that of the spindle"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outline:
    """Surface of one feature, from the front to the chuck."""

    ref: Ref[Entity]
    pieces: tuple[Piece, ...]
    """of z and x"""

    @property
    def low(self) -> float:
        """Least z, mm."""
        return min(piece.low for piece in self.pieces)

    @property
    def high(self) -> float:
        """Greatest z, mm."""
        return max(piece.high for piece in self.pieces)

    @property
    def radii(self) -> tuple[float, float]:
        """Least and greatest radius of the ends of its pieces, mm."""
        values = [x for piece in self.pieces for _, x in (piece.start, piece.end)]
        return min(values), max(values)


def outline_of(job: Job, ref: Ref[Entity], reach: float) -> Outline:
    """Outline of a feature.

    Parameters
    ----------
    job : Job
    ref : Ref
        A turning feature.
    reach : float, mm
        Radius up to which its walls go.

    Raises
    ------
    PathError, SchemaError
        When it is no outside turning feature, or does not turn about the spindle axis.
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
        raise job.fault("its profile has no length", ref)
    return Outline(ref=ref, pieces=_front_first(pieces))


def _segments(job: Job, ref: Ref[Entity], feature: Entity, frame: Frame) -> Sequence[Segment]:
    """Lines and arcs of a feature in the setup."""
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
    radius = size_of(job, profile.radius)
    turn = rad_from_deg(profile.sweep_angle)
    end = (radius * cos(turn), radius * sin(turn), 0.0)
    bend = Bend(centre=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), turn=turn)
    return (Segment(start=(radius, 0.0, 0.0), end=end, bend=bend).within(plane),)


def _cylinder(job: Job, ref: Ref[Entity], feature: OuterDiameter) -> Segment:
    """Cylinder or cone, from the placement on."""
    radius = 0.5 * size_of(job, feature.diameter_at_placement)
    length = size_of(job, feature.feature_length)
    end = radius
    if feature.reduced_size is not None:
        taper = job.program.get(feature.reduced_size)
        if isinstance(taper, DiameterTaper):
            end = 0.5 * size_of(job, taper.final_diameter)
        else:
            end = radius - length * tan(rad_from_deg(taper.angle))
    if end < 0.0:
        message = f"its taper ends at a radius of {end:.4g} mm, beyond the axis"
        raise job.fault(message, ref, "reduced_size")
    return Segment(start=(radius, 0.0, 0.0), end=(end, 0.0, -length))


def _shouldered(
    job: Job, feature: OuterDiameterToShoulder, frame: Frame, reach: float
) -> tuple[Piece, ...]:
    """Cylinder and shoulder, with the radius between them."""
    program = job.program
    vee = program.get(feature.v_shape_boundary)
    if vee.placement is None:
        raise job.fault("does not say where the shoulder is", feature.v_shape_boundary)
    start = frame.origin[2]
    end = frame.point(frame_of(program, vee.placement).origin)[2]
    radius = 0.5 * size_of(job, feature.diameter_at_placement)
    angle = vee_angle(vee.profile_angle)
    rise = max(reach - radius, 0.0)
    lean = rise / tan(angle) if abs(sin(angle)) > ALONG_AXIS else 0.0
    towards = 1.0 if start >= end else -1.0
    corners = [(start, radius), (end, radius), (end + towards * lean, radius + rise)]
    corner = size_of(job, vee.profile_radius) if vee.profile_radius is not None else 0.0
    return tuple(rounded(corners, [0.0, corner, 0.0]))


def _in_half_plane(
    job: Job, ref: Ref[Entity], segments: Sequence[Segment]
) -> tuple[Piece, ...]:
    """Segments in the setup as pieces of z and x, turned about the axis into y = 0."""
    points = [point for segment in segments for point in (segment.start, segment.end)]
    far = max(points, key=lambda point: hypot(point[0], point[1]))
    angle = atan2(far[1], far[0])
    across, along = -sin(angle), cos(angle)
    if any(abs(x * across + y * along) > IN_PLANE for x, y, _ in points):
        raise job.fault("its profile does not lie in a plane through the spindle axis", ref)
    pieces: list[Piece] = []
    for segment in segments:
        (z, x), (end_z, end_x) = (
            (p[2], p[0] * along - p[1] * across) for p in (segment.start, segment.end)
        )
        if segment.bend is None:
            pieces.append(Piece(start=(z, x), end=(end_z, end_x)))
            continue
        centre, normal = segment.bend.centre, segment.bend.normal
        beside = normal[0] * across + normal[1] * along
        if abs(abs(beside) - 1.0) > ALONG_AXIS:
            raise job.fault("an arc does not lie in a plane through the spindle axis", ref)
        turn = segment.bend.turn if beside > 0.0 else -segment.bend.turn
        middle = (centre[2], centre[0] * along - centre[1] * across)
        pieces += arc_pieces((z, x), (end_z, end_x), centre=middle, turn=turn)
    return tuple(pieces)


def _front_first(pieces: Iterable[Piece]) -> tuple[Piece, ...]:
    """The pieces from the greater z on; a face from the axis on."""
    forward = tuple(pieces)
    start, end = forward[0].start, forward[-1].end
    if (start[0], -start[1]) < (end[0], -end[1]):
        return tuple(piece.reversed() for piece in reversed(forward))
    return forward


def _check_axis(job: Job, ref: Ref[Entity], frame: Frame) -> None:
    """The axis of the feature must be that of the spindle."""
    if abs(abs(frame.z[2]) - 1.0) > ALONG_AXIS:
        raise job.fault("its axis is not that of the spindle", ref, "feature_placement")
    beside = hypot(frame.origin[0], frame.origin[1])
    if beside > IN_PLANE:
        message = f"its placement lies {beside:.4g} mm beside the spindle axis"
        raise job.fault(message, ref, "feature_placement")


def _check_side(job: Job, ref: Ref[Entity], frame: Frame, side: Ref[Direction] | None) -> None:
    """Material must lie inside, or towards the chuck."""
    if side is None:
        return
    ratios = (*job.program.get(side).direction_ratios, 0.0, 0.0, 0.0)[:3]
    outwards = ratios[0]
    away = frame.direction((float(ratios[0]), float(ratios[1]), float(ratios[2])))[2]
    if outwards > abs(away) and outwards > 0.0:
        message = "its material lies outside: turning on the inside is not supported"
        raise job.fault(message, ref, "material_side")
    if away > abs(outwards) and away > 0.0:
        message = "its material lies away from the chuck: a back face is not supported"
        raise job.fault(message, ref, "material_side")
