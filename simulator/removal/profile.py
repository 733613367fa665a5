"""Body of revolution that a rotating cutter sweeps, as a few numbers for the kernels.

The profile is the height above the tip as a function of the distance from the axis. It is
convex and never falls: a flat or a conical point, an arc of the corner radius, and a conical or
cylindrical flank. The arc ends where it touches the flank, so that a ball with a tapered neck
stays a ball at its tip. Above the edge the shank is a cylinder as wide as the edge is there.
Units mm.
"""

from math import cos, inf, pi, sin, sqrt, tan
from typing import NamedTuple

from simulator.kernels.kernel import kernel
from simulator.removal.cutter import Cutter

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
    cutter : Cutter
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
    """Whether the tool is a cylinder with a flat end and sharp corners."""
    return profile.slope == 0.0 and profile.flat == profile.radius


@kernel
def is_upright(profile: CutterProfile) -> bool:
    """Whether the tool is a cylinder with a flat end and sharp or slightly rounded corners."""
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
