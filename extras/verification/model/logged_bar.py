"""Bar that logged positions leave, as outer and inner radii over the axis.

Positions are radius, 0 and z. Units mm and s.

Points on profiles of turned parts, and their distances from other profiles.

Profiles are lines through the middles of cells of the bar. Units mm.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.spatial import cKDTree

from extras.verification.model.logged_part import (
    LogFacts,
    LoggedSamples,
    NearestSamples,
    SampledStretch,
    SampleSteps,
    unmet,
)
from extras.verification.model.path import pieces_of
from extras.verification.model.sweep import FAR
from simulator.motion.segments import Bools, Floats, Ints, Segments, lines
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.lathe import TurningStock
from stepnc_model.programs.program import Stock

PIECE = 0.1
"""Longest piece of a line whose middle stands for it, mm."""

STEEP = 1.0
"""Slope of the profile above which a surface is a face."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfilePoints:
    """P points on a programmed profile."""

    radius: Floats
    """(P,), mm"""
    z: Floats
    """(P,), mm"""
    cell: Ints
    """Cell whose cut made the surface there, (P,)."""
    is_face: Bools
    """(P,)"""
    area: Floats
    """Area that a point stands for, (P,), mm²."""
    sign: Floats
    """Whether there is material beyond (1), less (-1) or neither (0) in the log, (P,)."""


def points_along(radius: Floats, other: Floats, bar: TurningStock) -> ProfilePoints:
    """Points in the middles of cells, where anything is left."""
    slope = np.abs(np.gradient(radius, bar.cell))
    kept = np.flatnonzero(radius > 0.0)
    area = 2.0 * pi * radius * bar.cell * np.sqrt(1.0 + np.minimum(slope, STEEP) ** 2)
    return ProfilePoints(
        radius=radius[kept],
        z=bar.z[kept],
        cell=kept,
        is_face=(slope > STEEP)[kept],
        area=area[kept],
        sign=np.sign(other - radius)[kept],
    )


def points_on_faces(radius: Floats, other: Floats, bar: TurningStock) -> ProfilePoints:
    """Points on faces, as :func:`face_places` has them."""
    cell, level, wide = _face_points(radius, bar.cell)
    low = np.minimum(other[cell], other[cell + 1])
    high = np.maximum(other[cell], other[cell + 1])
    return ProfilePoints(
        radius=level,
        z=bar.z[cell] + 0.5 * bar.cell,
        # The cell with the smaller radius was cut.
        cell=np.where(wide > 0.0, cell, cell + 1),
        is_face=np.ones(len(cell), dtype=np.bool_),
        area=2.0 * pi * level * np.abs(wide),
        sign=np.where(level < low, 1.0, np.where(level > high, -1.0, 0.0)),
    )


def face_places(radius: Floats, bar: TurningStock) -> Floats:
    """Radius and z of points on the faces of a profile, (F, 2), mm."""
    before, level, _ = _face_points(radius, bar.cell)
    return np.column_stack([level, bar.z[before] + 0.5 * bar.cell])


def _face_points(radius: Floats, cell: float) -> tuple[Ints, Floats, Floats]:
    """Points between cells whose radii differ by more than their length.

    Returns
    -------
    (F,) array of int, (F,) array, (F,) array
        Cell before each, its radius in mm, and the height in mm that it stands for.
    """
    step = np.diff(radius)
    rows = np.flatnonzero(np.abs(step) > 2.0 * STEEP * cell)
    counts = np.ceil(np.abs(step[rows]) / PIECE).astype(np.int64)
    before = np.repeat(rows, counts)
    index = np.arange(len(before)) - np.repeat(np.cumsum(counts) - counts, counts)
    wide = step[before] / np.repeat(counts, counts)
    return before, radius[before] + (index + 0.5) * wide, wide


def profile_distance(points: Floats, profile: Floats, cell: float) -> Floats:
    """Distance of points from a profile of lines, (P,), mm; at most ``FAR``."""
    return nearest_on(points, profile, cell)[0]


def nearest_on(points: Floats, profile: Floats, cell: float) -> tuple[Floats, Ints]:
    """Distance of points from a profile of lines, mm, at most ``FAR``, and the nearest line."""
    start, piece, line, _ = pieces_of(profile, cell)
    best = cKDTree(start + 0.5 * piece).query(points, k=3)[1]
    begin, along = start[best], piece[best]
    square = np.maximum(np.sum(along * along, axis=2), 1e-18)
    share = np.clip(np.sum((points[:, None] - begin) * along, axis=2) / square, 0.0, 1.0)
    near = begin + share[:, :, None] * along
    away = np.linalg.norm(points[:, None] - near, axis=2)
    chosen = away.argmin(axis=1)
    rows = np.arange(len(points))
    return np.asarray(np.minimum(away[rows, chosen], FAR)), line[best[rows, chosen]]


CHANGED = 1e-7
"""Change of a radius, mm, above which a cell was cut."""

LIMIT = 1e-3
"""Uncertainty of the comparison itself, mm."""

BOX = 5
"""Corners of a box around a line, the first one twice."""

Shape = Cutter | Insert


def raw_bar(stock: Stock, cell: float, raw: TurningStock | None) -> TurningStock:
    """Bar that fills a stock, or a copy of the raw part in it."""
    bar = TurningStock(stock, cell)
    if raw is not None:
        bar.outer[:], bar.inner[:] = raw.outer, raw.inner
    return bar


class LoggedFaces:
    """Samples that made the faces of one profile. Running state.

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
        self.raw = raw_bar(stock, reference.cell, raw)
        """Raw part."""
        self.bar = raw_bar(stock, reference.cell, raw)
        self.possible = raw_bar(stock, reference.cell, raw)
        """What is left if the tool went everywhere that it may have gone unseen."""
        self.reached = raw_bar(stock, reference.cell, raw)
        """What is left if the tool went as far between samples as its way there may be long."""
        self.doubtful = raw_bar(stock, reference.cell, raw)
        """What is left by lines between samples on which it may have gone any way."""
        self.certain = raw_bar(stock, reference.cell, raw)
        """What is left if the tool cut only where samples show it, near corners of the log."""
        self._shapes = shapes
        self._steps = SampleSteps(stock.high[2])
        self._nearest = unmet(self.bar.outer.shape)
        self._outer_faces = LoggedFaces(face_places(reference.outer, reference))
        self._bore_faces = LoggedFaces(face_places(reference.inner, reference))

    @property
    def facts(self) -> LogFacts:
        """Resolution of the log."""
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
                around = _box_around(position[end - 1], position[end], reach, reach)
                cut_bar(self.possible, lines(around, speed=1.0), shape)
            cut_bar(self.reached, _boxes_around(position, part.way), shape)
            along = lines(list(position), speed=1.0)
            cut_bar(self.doubtful, along[np.isinf(part.way[1:])], shape)
            # On straights the line between samples is as certain as they are.
            shown = position[(part.bend > LIMIT) & part.samples.measured]
            if len(shown):
                standing = lines(list(np.repeat(shown, 2, axis=0)), speed=1.0)[::2]
                cut_bar(self.certain, standing, shape)
            for block in part.blocks():
                self._cut_block(part, block, shape)

    def _cut_block(self, part: SampledStretch, block: Ints, shape: Shape | None) -> None:
        """Cut along samples of one tool without a gap."""
        points = part.samples.position[block]
        cut = cut_bar(self.bar, lines(list(points), speed=1.0), shape)
        if cut.any():
            nose = shape.nose_radius if isinstance(shape, Insert) else 0.0
            square = _squares(part.samples.position, PIECE + nose)
            step, bend = (_greatest_nearby(each, square) for each in (part.step, part.bend))
            part = replace(part, step=step, bend=bend)
            self._nearest.meet(cut, part, block[nearest_points(points, self.bar, cut, shape)])
            for faces, radius in (
                (self._outer_faces, self.bar.outer),
                (self._bore_faces, self.bar.inner),
            ):
                profile = np.column_stack([radius, self.bar.z])
                faces.meet(profile, self.bar.cell, points, block, part)


def cut_bar(bar: TurningStock, segments: Segments, shape: Shape | None) -> Bools:
    """Cut a bar, and return which cells have changed, (C,)."""
    if shape is None:
        return np.zeros(len(bar.outer), dtype=np.bool_)
    outer, inner = bar.outer.copy(), bar.inner.copy()
    bar.cut(segments, shape)
    return np.asarray((outer - bar.outer > CHANGED) | (bar.inner - inner > CHANGED))


def _boxes_around(position: Floats, way: Floats) -> Segments:
    """Boxes around the places that the tool may have reached between samples.

    Places to which the way from one sample to the other is as long form an ellipse.

    Parameters
    ----------
    position : (N, 3) array, mm
    way : (N,) array, mm
        Longest way to each sample; without a box where it is infinite.
    """
    straight = np.linalg.norm(np.diff(position, axis=0), axis=1)
    longest = np.where(np.isinf(way[1:]), straight, way[1:])
    beyond = 0.5 * (longest - straight)
    beside = 0.5 * np.sqrt(np.maximum(longest * longest - straight * straight, 0.0))
    boxes = [
        _box_around(position[row], position[row + 1], float(beyond[row]), float(beside[row]))
        for row in np.flatnonzero(beside > LIMIT).tolist()
    ]
    corners = lines([corner for box in boxes for corner in box], speed=1.0)
    # Boxes have four sides; the fifth line leads to the next box.
    return corners[np.arange(len(corners)) % BOX != BOX - 1]


def _box_around(start: Floats, end: Floats, beyond: float, half_width: float) -> list[Floats]:
    """Corners of a box around a line, (3,) each, that lie beyond its ends and beside it, mm."""
    length = float(np.linalg.norm(end - start))
    one = (end - start) / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
    along, across = beyond * one, half_width * np.array([-one[2], 0.0, one[0]])
    first = start - along + across
    return [first, end + along + across, end + along - across, start - along - across, first]


def _squares(position: Floats, reach: float) -> Ints:
    """Stretch of a length of way to which each sample belongs, (N,), ascending by one."""
    way = np.linalg.norm(np.diff(position, axis=0), axis=1)
    square = np.floor(np.append(0.0, np.cumsum(way)) / reach)
    return np.asarray(np.unique(square, return_inverse=True)[1], dtype=np.int64)


def _greatest_nearby(values: Floats, square: Ints) -> Floats:
    """Greatest value in the stretch of each sample and beside it: an insert cuts there too."""
    greatest = np.zeros(int(square.max()) + 3)
    np.maximum.at(greatest, square + 1, values)
    beside = np.maximum(np.maximum(greatest[:-2], greatest[1:-1]), greatest[2:])
    return np.asarray(beside[square])


def nearest_points(points: Floats, bar: TurningStock, cut: Bools, shape: Shape | None) -> Ints:
    """Index of the point of a path at which a tool was nearest to each of some cells.

    A blade cuts a width beside its point, so that its middle counts.
    """
    width = (shape.width if isinstance(shape, Insert) else None) or 0.0
    surface = np.column_stack([bar.outer[cut], bar.z[cut] - 0.5 * width])
    return np.asarray(cKDTree(points[:, [0, 2]]).query(surface)[1], dtype=np.int64)
