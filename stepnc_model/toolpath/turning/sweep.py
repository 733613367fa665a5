"""Sections of grooves in the half plane of the lathe, with their rounded corners.

A groove is placed in its middle; the radius of the feature is that of its bottom. Width and
angles of a square U are those of its floor and of its walls from the upright; the first wall
is the one in front. Walls go up to the outside of the stock.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import acos, cos, dist, pi, sin, tan

from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    GeneralProfile,
    PartialCircularProfile,
    RoundedUProfile,
    SquareUProfile,
    TeeProfile,
    VeeProfile,
)
from stepnc_model.entities.turning_features import Groove
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.curve import segments_of
from stepnc_model.toolpath.frame import Frame, frame_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.piece import Piece, Spot, arc_pieces
from stepnc_model.units import rad_from_deg

STRAIGHT = 1e-9
"""rad between two lines that make no corner"""

LARGEST = 1e6
"""mm; no part is larger"""


def size_of(job: Job, ref: Ref[TolerancedLengthMeasure]) -> float:
    """Theoretical size of a length, mm; 0 for a corner without radius."""
    value = float(job.program.get(ref).theoretical_size)
    if not 0.0 <= value < LARGEST:
        raise job.fault(f"{value:g} mm is no size of a part", ref, "theoretical_size")
    return value


def vee_angle(written: float) -> float:
    """Angle of a vee in rad; some files write radians, and no vee is as sharp as 3°."""
    return written if written < pi else rad_from_deg(written)


def groove_pieces(job: Job, feature: Groove, frame: Frame, reach: float) -> tuple[Piece, ...]:
    """Section of a groove, pieces of z and x from the front wall to the one at the chuck."""
    program = job.program
    profile = program.get(feature.sweep)
    _check_face(job, feature, frame)
    placed = frame.inner(frame_of(program, profile.placement))
    middle, bottom = placed.origin[2], feature.radius
    if bottom >= reach:
        message = (
            f"its bottom at a radius of {bottom:g} mm lies outside the stock: {reach:g} mm"
        )
        raise job.fault(message, feature.sweep)
    height = reach - bottom
    if isinstance(profile, SquareUProfile):
        return tuple(_square(job, profile, (middle, bottom), height))
    if isinstance(profile, RoundedUProfile):
        radius = 0.5 * size_of(job, profile.width)
        return tuple(_round(radius, (middle, bottom), height))
    if isinstance(profile, VeeProfile):
        return tuple(_vee(job, profile, (middle, bottom), height))
    if isinstance(profile, PartialCircularProfile):
        radius, turn = size_of(job, profile.radius), rad_from_deg(profile.sweep_angle)
        return tuple(_bowl(radius, turn, (middle, bottom)))
    if isinstance(profile, GeneralProfile):
        pieces = tuple(_general(job, feature, profile, placed))
        _check_open(job, feature, pieces)
        return pieces
    if isinstance(profile, TeeProfile):
        message = "a tee groove is wider below than at its mouth: no plunge comes to it"
        raise job.fault(message, feature.sweep)
    raise job.fault("a groove of this profile cannot be turned", feature.sweep)


def _check_face(job: Job, feature: Groove, frame: Frame) -> None:
    """Material below the groove, not towards the chuck: it opens outwards."""
    side = feature.material_side
    if side is None:
        return
    ratios = (*job.program.get(side).direction_ratios, 0.0, 0.0, 0.0)[:3]
    x, y, z = map(float, ratios)
    if abs(frame.direction((x, y, z))[2]) > abs(x):
        message = "its material lies along the axis: a groove on a face is not supported"
        raise job.fault(message, side)


def _check_open(job: Job, feature: Groove, pieces: Sequence[Piece]) -> None:
    """All of the section must be seen from outside, from one wall to the other."""
    if not pieces:
        return
    towards = 1.0 if pieces[-1].end[0] > pieces[0].start[0] else -1.0
    if any((piece.end[0] - piece.start[0]) * towards < -STRAIGHT for piece in pieces):
        message = (
            "its section opens to a face or is undercut: no plunge from outside comes to it"
        )
        raise job.fault(message, feature.sweep)


def rounded(corners: Sequence[Spot], radii: Sequence[float]) -> Iterator[Piece]:
    """Lines between corners, with an arc of the given radius in each inner corner."""
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
            yield Piece(start=start, end=corner)
            start = corner
            continue
        back = radius * tan(0.5 * angle)
        sign = 1.0 if cross > 0.0 else -1.0
        foot = (corner[0] - back * p[0], corner[1] - back * p[1])
        end = (corner[0] + back * q[0], corner[1] + back * q[1])
        centre = (foot[0] - sign * radius * p[1], foot[1] + sign * radius * p[0])
        if dist(start, foot) > STRAIGHT:
            yield Piece(start=start, end=foot)
        yield from arc_pieces(foot, end, centre=centre, turn=sign * angle)
        start = end
    if dist(start, corners[-1]) > STRAIGHT:
        yield Piece(start=start, end=corners[-1])


def _square(job: Job, profile: SquareUProfile, foot: Spot, height: float) -> Iterator[Piece]:
    half = 0.5 * size_of(job, profile.width)
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
    radii = [size_of(job, profile.first_radius), size_of(job, profile.second_radius)]
    if sum(radii) > 2.0 * half + STRAIGHT:
        message = (
            f"its corners of {radii[0]:g} and {radii[1]:g} mm are wider than {2 * half:g} mm"
        )
        raise job.fault(message, profile.width)
    return rounded(corners, [0.0, *radii, 0.0])


def _round(radius: float, foot: Spot, height: float) -> Iterator[Piece]:
    z, x = foot
    centre = (z, x + radius)
    top = max(x + height, x + radius)
    if top > x + radius:
        yield Piece(start=(z + radius, top), end=(z + radius, x + radius))
    yield from arc_pieces(
        (z + radius, x + radius), (z - radius, x + radius), centre=centre, turn=-pi
    )
    if top > x + radius:
        yield Piece(start=(z - radius, x + radius), end=(z - radius, top))


def _vee(job: Job, profile: VeeProfile, foot: Spot, height: float) -> Iterator[Piece]:
    half = 0.5 * vee_angle(profile.profile_angle)
    tilt = rad_from_deg(profile.tilt_angle or 0.0)
    radius = size_of(job, profile.profile_radius) if profile.profile_radius is not None else 0.0
    # The radius is that of the bottom: the corner itself lies below it.
    apex = foot[1] - radius * (1.0 / sin(half) - 1.0)
    rise = foot[1] + height - apex
    if max(abs(tilt + half), abs(tilt - half)) >= 0.5 * pi:
        raise job.fault("a wall of its vee lies beyond the horizontal", profile.profile_radius)
    corners = [
        (foot[0] + rise * tan(half + tilt), apex + rise),
        (foot[0], apex),
        (foot[0] - rise * tan(half - tilt), apex + rise),
    ]
    return rounded(corners, [0.0, radius, 0.0])


def _bowl(radius: float, turn: float, foot: Spot) -> Iterator[Piece]:
    z, x = foot
    centre = (z, x + radius)
    half = 0.5 * turn
    ends = [(z + s * radius * sin(half), x + radius - radius * cos(half)) for s in (1.0, -1.0)]
    return arc_pieces(ends[0], ends[1], centre=centre, turn=-turn)


def _general(
    job: Job, feature: Groove, profile: GeneralProfile, frame: Frame
) -> Iterator[Piece]:
    """A curve in the x, z plane of the feature, its x from the bottom up."""
    pieces: list[Piece] = []
    for segment in segments_of(job.program, profile.its_profile):
        at = segment.within(frame)
        (z, x), (end_z, end_x) = ((p[2], feature.radius + p[0]) for p in (at.start, at.end))
        if at.bend is None:
            pieces.append(Piece(start=(z, x), end=(end_z, end_x)))
            continue
        if abs(abs(at.bend.normal[1]) - 1.0) > STRAIGHT:
            raise job.fault("an arc does not lie in a plane through the axis", feature.sweep)
        turn = at.bend.turn if at.bend.normal[1] > 0.0 else -at.bend.turn
        centre = (at.bend.centre[2], feature.radius + at.bend.centre[0])
        pieces += arc_pieces((z, x), (end_z, end_x), centre=centre, turn=turn)
    if any(a.end != b.start and dist(a.end, b.start) > 0.01 for a, b in pairwise(pieces)):
        raise job.fault("the parts of its profile do not join", feature.sweep)
    return iter(pieces)
