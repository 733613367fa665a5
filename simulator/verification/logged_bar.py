"""Bar that logged positions leave, as outer and inner radii over the axis.

Positions are radius, 0 and z. Units mm and s.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Bools, Floats, Ints, Segments, lines
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.lathe import TurningStock
from simulator.verification.logged import (
    LogFacts,
    LoggedSamples,
    NearestSamples,
    SampledStretch,
    SampleSteps,
    unmet,
)
from simulator.verification.profile import PIECE, face_places, profile_distance
from stepnc_model.program import Stock

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
            step, bend = (_greatest_beside(each, square) for each in (part.step, part.bend))
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


def _box_around(start: Floats, end: Floats, beyond: float, beside: float) -> list[Floats]:
    """Corners of a box around a line, (3,) each, that lie beyond its ends and beside it, mm."""
    length = float(np.linalg.norm(end - start))
    one = (end - start) / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
    along, across = beyond * one, beside * np.array([-one[2], 0.0, one[0]])
    first = start - along + across
    return [first, end + along + across, end + along - across, start - along - across, first]


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


def nearest_points(points: Floats, bar: TurningStock, cut: Bools, shape: Shape | None) -> Ints:
    """Index of the point of a path at which a tool was nearest to each of some cells.

    A blade cuts a width beside its point, so that its middle counts.
    """
    width = (shape.width if isinstance(shape, Insert) else None) or 0.0
    surface = np.column_stack([bar.outer[cut], bar.z[cut] - 0.5 * width])
    return np.asarray(cKDTree(points[:, [0, 2]]).query(surface)[1], dtype=np.int64)
