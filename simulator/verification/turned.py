"""Verification of turned parts: outer and inner radii over the axis, r(z).

The programmed path and the logged positions cut the same bar. A deviation is the distance of a
point of the programmed profile from the logged profile. Profiles are lines through the middles
of cells, so that on cylinders, cones and arcs the size of cells has no effect; faces are known
to a cell. Positions are radius, 0 and z. Units mm and s.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Bools, Floats, Ints, Segments, lines
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.lathe import TurningStock
from simulator.verification.deviation import (
    ComparedVolumes,
    SurfacePlaces,
    path_uncertainty,
    rounding_uncertainty,
)
from simulator.verification.logged import (
    LogFacts,
    LoggedSamples,
    NearestSamples,
    SampledStretch,
    SampleSteps,
    unmet,
)
from simulator.verification.path import ProgrammedPath, pieces_of
from simulator.verification.profile import (
    PIECE,
    ProfilePoints,
    face_places,
    nearest_on,
    points_along,
    points_on_faces,
    profile_distance,
)
from stepnc_model.program import Stock

CELL = 0.01
"""Length of a cell along the axis, mm."""

CHANGED = 1e-7
"""Change of a radius, mm, above which a cell was cut."""

LIMIT = 1e-3
"""Uncertainty of the comparison itself, mm."""

LEAST_GOUGE = 0.01
"""Least depth of a gouge that samples alone make certain, mm."""

Shape = Cutter | Insert


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
    path : ProgrammedPath
    stock : Stock
    cell : float, mm
        Length of a cell along the axis.
    raw : TurningStock
        Raw part in the stock, with cells of that length; without it a bar fills the stock.

    Raises
    ------
    ValueError
        If the stock has no radius, or needs too many cells.
    """
    bar = _raw_bar(stock, CELL if cell is None else cell, raw)
    chord = np.full(len(bar.outer), -1, dtype=np.int64)
    station = np.zeros(len(bar.outer))
    first = 0
    for run, points in zip(path.runs, path.chords, strict=True):
        cut = _cut(bar, run.segments, run.cutter)
        if cut.any():
            starts, pieces, rows, along = pieces_of(points, PIECE)
            nearest = _nearest(starts + 0.5 * pieces, bar, cut)
            chord[cut] = first + rows[nearest]
            station[cut] = path.chord_station[chord[cut]] + along[nearest]
        first += len(points) - 1
    return TurnedPart(path=path, bar=bar, chord=chord, station=station)


def _raw_bar(stock: Stock, cell: float, raw: TurningStock | None) -> TurningStock:
    """Bar that fills a stock, or a copy of the raw part in it."""
    bar = TurningStock(stock, cell)
    if raw is not None:
        bar.outer[:], bar.inner[:] = raw.outer, raw.inner
    return bar


class LoggedFaces:
    """Which samples made the faces of one profile. Running state.

    A face is made by many samples but lies in one cell, so that its points are kept by
    themselves: the samples that change the distance of the profile from a point made it.

    Parameters
    ----------
    place : (F, 2) array, mm
        Radius and z of points on the faces of the part that is compared with.
    """

    def __init__(self, place: Floats) -> None:
        self.nearest = unmet(place.shape[:1])
        self._place = place
        self._away = np.full(len(place), np.nan)

    def meet(
        self, profile: Floats, cell: float, points: Floats, block: Ints, part: SampledStretch
    ) -> None:
        """Note that samples of a stretch have cut a profile.

        Parameters
        ----------
        profile : (C, 2) array, mm
            Radius and z of the profile after the cut.
        cell : float, mm
        points : (N, 3) array, mm
            Positions of the samples.
        block : (N,) array of int
            Samples of the stretch.
        part : SampledStretch
        """
        if not len(self._place):
            return
        away = profile_distance(self._place, profile, cell)
        # A face is known to a cell.
        is_new = ~(np.abs(away - self._away) <= cell)
        if is_new.any():
            self._away[is_new] = away[is_new]
            near = cKDTree(points[:, [0, 2]]).query(self._place[is_new])[1]
            self.nearest.meet(is_new, part, block[near])


class LoggedBar:
    """Bar that logged positions leave. Running state.

    Parameters
    ----------
    reference : TurningStock
        Bar that it is compared with.
    stock : Stock
    shapes : mapping
        Shapes of tools by number; other tools remove nothing.
    raw : TurningStock
        Raw part in the stock, with the cells of the bar; without it a bar fills the stock.
    """

    def __init__(
        self,
        reference: TurningStock,
        stock: Stock,
        shapes: Mapping[int, Shape | None],
        *,
        raw: TurningStock | None = None,
    ) -> None:
        self.raw = _raw_bar(stock, reference.cell, raw)
        """Raw part."""
        self.bar = _raw_bar(stock, reference.cell, raw)
        self.possible = _raw_bar(stock, reference.cell, raw)
        """What is left if the tool went everywhere that it may have gone unseen."""
        self.certain = _raw_bar(stock, reference.cell, raw)
        """What is left if the tool cut only where samples show it, near corners of the log."""
        self._shapes = shapes
        self._steps = SampleSteps(stock.high[2])
        self._nearest = unmet(self.bar.outer.shape)
        self._outer_faces = LoggedFaces(face_places(reference.outer, reference))
        self._bore_faces = LoggedFaces(face_places(reference.inner, reference))

    @property
    def facts(self) -> LogFacts:
        """What the log can resolve."""
        return self._steps.facts

    @property
    def nearest(self) -> NearestSamples:
        """Samples nearest to the surface of each cell."""
        return self._nearest

    def nearest_faces(self, *, is_bore: bool) -> NearestSamples:
        """Samples that made the points of :func:`face_places`."""
        return (self._bore_faces if is_bore else self._outer_faces).nearest

    def add(self, samples: LoggedSamples) -> None:
        """Cut along more samples, which are later than those before."""
        for part in self._steps.pieces(samples):
            shape = self._shapes.get(int(part.samples.tool[0]))
            position = part.samples.position
            is_wide = part.is_gap | (part.unseen > self.bar.cell)
            for end in np.flatnonzero(is_wide).tolist():
                reach = max(float(part.unseen[end]), self.bar.cell)
                around = _box_around(position[end - 1], position[end], reach)
                _cut(self.possible, lines(around, speed=1.0), shape)
            # On straights the line between samples is as certain as they are.
            shown = position[(part.bend > LIMIT) & part.samples.measured]
            if len(shown):
                standing = lines(list(np.repeat(shown, 2, axis=0)), speed=1.0)[::2]
                _cut(self.certain, standing, shape)
            for block in part.blocks():
                self._cut_block(part, block, shape)

    def _cut_block(self, part: SampledStretch, block: Ints, shape: Shape | None) -> None:
        """Cut along samples of one tool without a gap."""
        points = part.samples.position[block]
        cut = _cut(self.bar, lines(list(points), speed=1.0), shape)
        if cut.any():
            nose = shape.nose_radius if isinstance(shape, Insert) else 0.0
            square = _squares(part.samples.position, PIECE + nose)
            step, bend = (_greatest_beside(each, square) for each in (part.step, part.bend))
            part = replace(part, step=step, bend=bend)
            self._nearest.meet(cut, part, block[_nearest(points, self.bar, cut)])
            for faces, radius in (
                (self._outer_faces, self.bar.outer),
                (self._bore_faces, self.bar.inner),
            ):
                profile = np.column_stack([radius, self.bar.z])
                faces.meet(profile, self.bar.cell, points, block, part)


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
    bar : TurningStock
    logged : LoggedBar
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


def _cut(bar: TurningStock, segments: Segments, shape: Shape | None) -> Bools:
    """Cut a bar, and return which cells have changed, (C,)."""
    if shape is None:
        return np.zeros(len(bar.outer), dtype=np.bool_)
    outer, inner = bar.outer.copy(), bar.inner.copy()
    bar.cut(segments, shape)
    return np.asarray((outer - bar.outer > CHANGED) | (bar.inner - inner > CHANGED))


def _box_around(start: Floats, end: Floats, reach: float) -> list[Floats]:
    """Corners of a box around a line, (3,) each, that lie a distance beside it, mm."""
    way = float(np.linalg.norm(end - start))
    along = (end - start) * (reach / way)
    across = np.array([-along[2], 0.0, along[0]])
    corners = (start - along + across, end + along + across, end + along - across)
    return [start, *corners, start - along - across, start]


def _squares(position: Floats, reach: float) -> Ints:
    """Stretch of a length of way to which each sample belongs, (N,), ascending by one."""
    way = np.linalg.norm(np.diff(position, axis=0), axis=1)
    square = np.floor(np.append(0.0, np.cumsum(way)) / reach)
    return np.asarray(np.unique(square, return_inverse=True)[1], dtype=np.int64)


def _greatest_beside(values: Floats, square: Ints) -> Floats:
    """Greatest value in the stretch of each sample and beside it: an insert cuts there too."""
    greatest = np.zeros(int(square.max()) + 3)
    np.maximum.at(greatest, square + 1, values)
    beside = np.maximum(np.maximum(greatest[:-2], greatest[1:-1]), greatest[2:])
    return np.asarray(beside[square])


def _nearest(points: Floats, bar: TurningStock, cut: Bools) -> Ints:
    """Index of the point of a path nearest to the surface of each of some cells."""
    surface = np.column_stack([bar.outer[cut], bar.z[cut]])
    return np.asarray(cKDTree(points[:, [0, 2]]).query(surface)[1], dtype=np.int64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfileComparison:
    """P points on a profile, with the distance of another profile from each."""

    points: ProfilePoints
    position: Floats
    """Radius, 0 and z, (P, 3), mm."""
    deviation: Floats
    """(P,), mm: excess positive, gouge negative."""
    uncertainty: Floats
    """Uncertainty by rounding and cells, (P,), mm."""
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
    unknown = _unknown(bar, logged, points, deviation, is_bore=is_bore)
    return ProfileComparison(
        points=points,
        position=np.column_stack([points.radius, np.zeros(len(place)), points.z]),
        deviation=deviation,
        uncertainty=np.asarray(limit + unknown),
        gouge=_least_gouge(radius, place, limit, bar, logged, is_bore=is_bore),
        nearest=_made_by(logged, points.cell, line, is_bore=is_bore),
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


def _unknown(
    bar: TurningStock,
    logged: LoggedBar,
    points: ProfilePoints,
    deviation: Floats,
    *,
    is_bore: bool,
) -> Floats:
    """How much of an excess the tool may have cut while samples were missing, (P,), mm."""
    left, possible = logged.bar, logged.possible
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
    least = np.where(is_left, away, 0.0)
    return np.asarray(np.clip(deviation - least, 0.0, np.maximum(deviation, 0.0)))


def has_bore(bar: TurningStock, logged: LoggedBar) -> bool:
    """Whether one of two parts has a bore."""
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


def _stations(part: TurnedPart, found: ProfileComparison, chord: Ints) -> Floats:
    """Way along the path to places on one profile, (P,), mm.

    A face lies in one cell but along many chords, of those of the run that made it.
    """
    path, station = part.path, part.station[found.points.cell].copy()
    first = 0
    for points in path.chords:
        last = first + len(points) - 1
        own = np.flatnonzero(found.points.is_face & (chord >= first) & (chord < last))
        if len(own):
            starts, pieces, rows, along = pieces_of(points, PIECE)
            middle = starts + 0.5 * pieces
            near = cKDTree(middle[:, [0, 2]]).query(found.position[own][:, [0, 2]])[1]
            station[own] = path.chord_station[first + rows[near]] + along[near]
        first = last
    return station
