"""Verification of turned parts: outer and inner radii over the axis, r(z).

The programmed path and the logged positions cut the same bar. A deviation is the distance of a
point of the programmed profile from the logged profile. Profiles are lines through the middles
of cells, so that on cylinders, cones and arcs the size of cells has no effect; faces are known
to a cell. Positions are radius, 0 and z. Units mm and s.
"""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from extras.verification.model.deviation import (
    ComparedVolumes,
    SurfacePlaces,
    path_uncertainty,
    rounding_uncertainty,
)
from extras.verification.model.logged_bar import (
    CHANGED,
    LIMIT,
    PIECE,
    LoggedBar,
    ProfilePoints,
    cut_bar,
    nearest_on,
    nearest_points,
    points_along,
    points_on_faces,
    profile_distance,
    raw_bar,
)
from extras.verification.model.logged_part import NearestSamples
from extras.verification.model.path import ProgrammedPath, pieces_of
from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.cutter import Insert
from simulator.removal.lathe import TurningStock
from simulator.removal.mesh_stock import CELL
from stepnc_model.programs.program import Stock

LEAST_GOUGE = 0.01
"""Least depth of a gouge that samples alone make certain, mm."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TurnedPart:
    """Bar of C cells that the programmed path leaves."""

    path: ProgrammedPath
    bar: TurningStock
    chord: Ints
    """Chord of the path nearest to the surface of each cell, (C,); -1 for the raw bar."""
    station: Floats
    """Way along the path to that place, (C,), mm."""


def turned_part(
    path: ProgrammedPath,
    stock: Stock,
    *,
    cell: float | None = None,
    raw: TurningStock | None = None,
) -> TurnedPart:
    """Cut a bar along a programmed path.

    Parameters
    ----------
    cell : float, mm
        Length of a cell along the axis.
    raw : TurningStock
        Raw part in the stock, with cells of that length; without it a bar fills the stock.

    Raises
    ------
    ValueError
        If the stock has no radius, or needs too many cells.
    """
    bar = raw_bar(stock, CELL if cell is None else cell, raw)
    chord = np.full(len(bar.outer), -1, dtype=np.int64)
    station = np.zeros(len(bar.outer))
    first = 0
    for run, points in zip(path.runs, path.chords, strict=True):
        cut = cut_bar(bar, run.segments, run.cutter)
        if cut.any():
            starts, pieces, rows, along = pieces_of(points, PIECE)
            nearest = nearest_points(starts + 0.5 * pieces, bar, cut, run.cutter)
            chord[cut] = first + rows[nearest]
            station[cut] = path.chord_station[chord[cut]] + along[nearest]
        first += len(points) - 1
    return TurnedPart(path=path, bar=bar, chord=chord, station=station)


def turned_places(part: TurnedPart, logged: LoggedBar) -> SurfacePlaces:
    """Compare the profiles of outside and bore."""
    sides = [_side(part, logged, is_bore=False)]
    if has_bore(part.bar, logged):
        sides.append(_side(part, logged, is_bore=True))
    return SurfacePlaces.joined(sides)


def turned_volumes(
    bar: TurningStock, logged: LoggedBar, *, low: float = -inf
) -> ComparedVolumes:
    """Compare the volumes that are removed from the raw part, in the log and in the other one.

    Parameters
    ----------
    low : float, mm
        Only what lies before this z counts.
    """
    is_before = bar.z > low
    raw, area, other = (
        np.maximum(each.outer**2 - each.inner**2, 0.0)[is_before]
        for each in (logged.raw, bar, logged.bar)
    )
    disc = pi * bar.cell
    more = disc * (other - area)
    return ComparedVolumes(
        programmed=disc * float((raw - area).sum()),
        logged=disc * float((raw - other).sum()),
        gouge=float(np.maximum(-more, 0.0).sum()),
        excess=float(np.maximum(more, 0.0).sum()),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfileComparison:
    """P points on a profile, with the distance of another profile from each."""

    points: ProfilePoints
    position: Floats
    """Radius, 0 and z, (P, 3), mm."""
    deviation: Floats
    """(P,), mm: excess positive, gouge negative."""
    uncertainty: Floats
    """Uncertainty by rounding, cells and missing samples, (P,), mm."""
    reached: Floats
    """How much of an excess the tool may have cut between samples, (P,), mm, by the length of
    its way; infinite where that is not known, and without an excess."""
    gouge: Floats
    """Depth that a gouge has at least, by the samples alone, (P,), mm; 0 without one."""
    nearest: NearestSamples
    """Samples that made what is nearest to each place, (P,)."""


def compared_profiles(
    bar: TurningStock, logged: LoggedBar, *, is_bore: bool
) -> ProfileComparison:
    """Compare the profiles of outside or bore; in a bore material lies outside."""
    radius = bar.inner if is_bore else bar.outer
    other = logged.bar.inner if is_bore else logged.bar.outer
    parts = (points_along(radius, other, bar), points_on_faces(radius, other, bar))
    points = ProfilePoints(**{
        name: np.concatenate([getattr(each, name) for each in parts])
        for name in ProfilePoints.__slots__
    })
    place = np.column_stack([points.radius, points.z])
    away, line = nearest_on(place, np.column_stack([other, bar.z]), bar.cell)
    deviation = (-points.sign if is_bore else points.sign) * away
    limit = np.where(points.is_face, bar.cell, 0.0) + rounding_uncertainty(logged.facts) + LIMIT
    nearest = _made_by(logged, points.cell, line, is_bore=is_bore)
    missing = _unknown(bar, logged.bar, logged.possible, points, deviation, is_bore=is_bore)
    is_made = _is_made_by(logged.doubtful, logged.bar, is_bore=is_bore)
    # Deeper cuts beside a place would lie nearer to it than what the log shows.
    around = distance_transform_edt(~is_made, sampling=bar.cell)
    is_doubtful = is_made.any() & (around[points.cell] <= np.abs(deviation) + 2.0 * bar.cell)
    reached = _unknown(bar, logged.bar, logged.reached, points, deviation, is_bore=is_bore)
    return ProfileComparison(
        points=points,
        position=np.column_stack([points.radius, np.zeros(len(place)), points.z]),
        deviation=deviation,
        uncertainty=np.asarray(limit + np.minimum(missing, np.maximum(deviation, 0.0))),
        reached=np.where((deviation > 0.0) & ~is_doubtful, reached, np.inf),
        gouge=_least_gouge(radius, place, limit, bar, logged, is_bore=is_bore),
        nearest=nearest,
    )


def _least_gouge(
    radius: Floats,
    place: Floats,
    limit: Floats,
    bar: TurningStock,
    logged: LoggedBar,
    *,
    is_bore: bool,
) -> Floats:
    """Depth of the gouge that samples alone make at places of a profile, (P,), mm."""
    other = logged.certain.inner if is_bore else logged.certain.outer
    parts = (points_along(radius, other, bar), points_on_faces(radius, other, bar))
    sign = np.concatenate([each.sign for each in parts])
    is_less = sign > 0.0 if is_bore else sign < 0.0
    found = np.zeros(len(place))
    if is_less.any():
        profile = np.column_stack([other, bar.z])
        away = profile_distance(place[is_less], profile, bar.cell) - limit[is_less]
        found[is_less] = np.where(away >= LEAST_GOUGE, away, 0.0)
    return found


def _made_by(logged: LoggedBar, cell: Ints, line: Ints, *, is_bore: bool) -> NearestSamples:
    """Samples that made places of cells, and then of faces, (P,).

    The way between samples is the greatest of the cell of a place and of those whose line is
    nearest to it.
    """
    cells, faces = logged.nearest, logged.nearest_faces(is_bore=is_bore)
    count = len(cell) - len(faces.step)
    beside = np.column_stack([cell, line, line + 1])[:count]
    along = NearestSamples(
        time=cells.time[cell[:count]],
        step=cells.step[beside].max(axis=1),
        bend=cells.bend[beside].max(axis=1),
        rise=cells.rise[beside].max(axis=1),
        workingstep=cells.workingstep[cell[:count]],
    )
    return along.followed_by(faces)


def _is_made_by(part: TurningStock, whole: TurningStock, *, is_bore: bool) -> Bools:
    """True if a part of the sweep made the profile in each cell, (C,)."""
    if is_bore:
        return np.asarray(part.inner > whole.inner - CHANGED)
    return np.asarray(part.outer < whole.outer + CHANGED)


def _unknown(
    bar: TurningStock,
    left: TurningStock,
    possible: TurningStock,
    points: ProfilePoints,
    deviation: Floats,
    *,
    is_bore: bool,
) -> Floats:
    """Depth that the tool may have cut unseen beyond a profile, (P,), mm; 0 in a gouge."""
    if is_bore:
        profile, radius = np.maximum(left.inner, possible.inner), bar.inner
        is_less = (profile > left.inner + CHANGED).any()
    else:
        profile, radius = np.minimum(left.outer, possible.outer), bar.outer
        is_less = (profile < left.outer - CHANGED).any()
    if not is_less:
        return np.zeros(len(deviation))
    place = np.column_stack([points.radius, points.z])
    away = profile_distance(place, np.column_stack([profile, bar.z]), bar.cell)
    after = np.minimum(points.cell + 1, len(radius) - 1)
    beside = (profile[points.cell], profile[after])
    if is_bore:
        is_left = np.maximum(*beside) < points.radius - CHANGED
    else:
        is_left = np.minimum(*beside) > points.radius + CHANGED
    more = deviation - np.where(is_left, away, -away)
    return np.where(deviation > 0.0, np.maximum(more, 0.0), 0.0)


def has_bore(bar: TurningStock, logged: LoggedBar) -> bool:
    """True if one of two parts has a bore."""
    return bool((bar.inner > 0.0).any() or (logged.bar.inner > 0.0).any())


def _side(part: TurnedPart, logged: LoggedBar, *, is_bore: bool) -> SurfacePlaces:
    """Compare one profile with that of the programmed path."""
    path = part.path
    found = compared_profiles(part.bar, logged, is_bore=is_bore)
    points = found.points
    chord = part.chord[points.cell]
    segment, is_cut = path.segment[np.maximum(chord, 0)], chord >= 0
    noses = [run.cutter.nose_radius for run in path.runs if isinstance(run.cutter, Insert)]
    reach = PIECE + max(noses, default=0.0)
    station = _stations(part, found, chord)
    bend = path_uncertainty(path, station, found.nearest.step, reach=reach)
    bend = np.minimum(bend, found.reached)
    return SurfacePlaces(
        is_wall=points.is_face,
        position=found.position,
        deviation=found.deviation,
        uncertainty=np.where(is_cut, bend, 0.0) + found.uncertainty,
        certain=found.gouge,
        area=points.area,
        workingstep=np.where(is_cut, path.workingstep[segment], -1),
        block=np.where(is_cut, path.block[segment], 0),
        time=found.nearest.time,
        cut_by=found.nearest.workingstep,
    )


def _stations(part: TurnedPart, comparison: ProfileComparison, chord: Ints) -> Floats:
    """Way along the path to places on one profile, (P,), mm.

    A face lies in one cell but along many chords, of those of the run that made it.
    """
    path, station = part.path, part.station[comparison.points.cell].copy()
    first = 0
    for points in path.chords:
        last = first + len(points) - 1
        own = np.flatnonzero(comparison.points.is_face & (chord >= first) & (chord < last))
        if len(own):
            starts, pieces, rows, along = pieces_of(points, PIECE)
            middle = starts + 0.5 * pieces
            near = cKDTree(middle[:, [0, 2]]).query(comparison.position[own][:, [0, 2]])[1]
            station[own] = path.chord_station[first + rows[near]] + along[near]
        first = last
    return station
