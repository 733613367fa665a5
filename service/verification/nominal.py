"""Deviations of the programmed surface from the features of the program."""

from math import ceil

import numpy as np

from service.verification.prepared import PreparedProgram
from simulator.motion.segments import Floats
from simulator.removal.lathe import TurningStock
from simulator.verification.deviation import SurfacePlaces
from simulator.verification.mesh import height_deviation, outline_at
from simulator.verification.nominal import (
    NominalOutline,
    floor_deviation,
    profile_side,
    wall_deviation,
)
from simulator.verification.profile import profile_distance
from simulator.verification.revolved import RequiredBar, profile_deviation
from simulator.verification.sweep import FAR
from stepnc_model.toolpath.milling.contour import Chain
from stepnc_model.toolpath.milling.nominal import NominalWall, nominal_walls
from stepnc_model.toolpath.turning.nominal import nominal_outlines
from stepnc_model.toolpath.turning.outline import FeatureOutline

LEVEL = 3
"""Decimals of a millimetre to which the levels of walls are rounded."""

LONGEST = 0.01
"""Greatest angle of one line of an arc, rad: 0.1 µm on a radius of 10 mm."""


def nominal_deviation(
    program: PreparedProgram, places: SurfacePlaces, normal: Floats
) -> Floats:
    """Deviation of the programmed surface from the nominal features, (N,), mm; NaN: unknown.

    Parameters
    ----------
    program : PreparedProgram
    places : SurfacePlaces
        Those on walls first.
    normal : (P, 2) array
        Direction from the air into the material at the places on walls.
    """
    found = np.full(len(places), np.nan)
    steps = {step.id: step for step in program.program.workingsteps}
    for index, name in enumerate(program.steps):
        walls = nominal_walls(program.program, steps[name.workingstep])
        own = places.workingstep == index
        floors = np.flatnonzero(own & ~places.is_wall)
        heights = places.position[floors, 2]
        found[floors] = floor_deviation(heights, sorted({wall.bottom for wall in walls}))
        rows = np.flatnonzero(own & places.is_wall)
        if len(rows):
            found[rows] = _walls(places.position[rows], normal[rows], walls)
    return found


def required_deviation(triangles: Floats, places: SurfacePlaces, normal: Floats) -> Floats:
    """Deviation of the programmed surface from a required part, (N,), mm; NaN: none near.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
        Required part in the coordinates of the setup.
    places : SurfacePlaces
        Those on walls first.
    normal : (P, 2) array
        Direction from the air into the material at the places on walls.
    """
    found = np.full(len(places), np.nan)
    floors = np.flatnonzero(~places.is_wall & (places.workingstep >= 0))
    found[floors] = height_deviation(places.position[floors], triangles)
    walls = np.flatnonzero(places.is_wall)
    levels, level = np.unique(places.position[walls, 2].round(LEVEL), return_inverse=True)
    for index, height in enumerate(levels.tolist()):
        rows = walls[level == index]
        outline = outline_at(triangles, height)
        found[rows] = wall_deviation(places.position[rows, :2], normal[rows], outline)
    return found


def turned_nominal_deviation(program: PreparedProgram, places: SurfacePlaces) -> Floats:
    """Deviation of a programmed profile from the features, (N,), mm; NaN: unknown."""
    found = np.full(len(places), np.nan)
    steps = {step.id: step for step in program.program.workingsteps}
    for index, name in enumerate(program.steps):
        own = np.flatnonzero(places.workingstep == index)
        outlines = nominal_outlines(program.program, steps[name.workingstep])
        if len(own) and outlines:
            chains = [_profile(outline) for outline in outlines]
            found[own] = profile_side(places.position[own][:, [2, 0]], chains)
    return found


def required_profile_deviation(
    part: RequiredBar, bar: TurningStock, places: SurfacePlaces
) -> Floats:
    """Deviation of a programmed profile from a required one, (N,), mm; NaN: unknown.

    Parameters
    ----------
    part : RequiredBar
    bar : TurningStock
        Programmed part.
    places : SurfacePlaces
        Places on it.
    """
    at = places.position[:, [0, 2]]
    outside, inside = (
        profile_distance(at, np.column_stack([radius, bar.z]), bar.cell)
        for radius in (bar.outer, bar.inner)
    )
    is_bore = (bar.inner > 0.0).any() & (inside < outside)
    found = profile_deviation(places, is_bore, part)
    return np.where((places.workingstep >= 0) & (np.abs(found) < FAR), found, np.nan)


def _profile(outline: FeatureOutline) -> Floats:
    """Points z and radius along an outline, (N, 2), mm."""
    points = [outline.pieces[0].start]
    for piece in outline.pieces:
        count = max(ceil(abs(piece.turn) / LONGEST), 1)
        points += [piece.point((index + 1.0) / count) for index in range(count)]
    return np.array(points)


def _walls(position: Floats, normal: Floats, walls: tuple[NominalWall, ...]) -> Floats:
    """Deviation from the nearest of some walls; NaN without any."""
    found = np.full(len(position), np.nan)
    for wall in walls:
        outline = NominalOutline(points=_points(wall.chain))
        away = wall_deviation(position[:, :2], normal, outline)
        above = np.maximum(position[:, 2] - wall.bottom, 0.0)
        heights, place = np.unique(above.round(6), return_inverse=True)
        away = away - np.array([wall.inset(height) for height in heights.tolist()])[place]
        is_nearer = np.isnan(found) | (np.abs(away) < np.abs(found))
        found = np.where(is_nearer & ~np.isnan(away), away, found)
    return found


def _points(chain: Chain) -> tuple[Floats, ...]:
    """Points of a chain, each edge by itself; none of an empty chain."""
    parts = []
    for edge in chain:
        count = max(ceil(abs(edge.turn) / LONGEST), 1)
        points = [edge.at(index / count) for index in range(count + 1)]
        parts.append(np.array([[point.real, point.imag] for point in points]))
    return tuple(parts)
