"""Stock on a lathe as radii along the spindle axis, cut by turning, grooving and drilling.

The bar is a map: each cell along z holds an outer radius and the radius of a bore. An insert
lowers the former or widens the latter in closed form (:mod:`simulator.removal.lathe_carve`); a
drill on the axis widens the bore. The radius is known in the middle of each cell: smooth
surfaces are accurate to the square of the cell, a wall across the axis to half a cell.

An edge leads when the tool moves towards its outer side. Of two leading edges, the one that
faces the feed most is taken; the flat end of a blade counts as a third edge. The nose is
included in the effective angle of :mod:`simulator.physics.edge`.

Not modelled: overhangs (an edge beyond 90° counts as upright, a groove in a face goes through
to the front), the cusps left by the feed, threads (the workpiece stays a body of revolution),
the ends of the edges and the shank, a part that is cut off (it stays in the map), and tools
beside the axis. A box counts as the cylinder around it: no contact is missed, and the volume
is too large until the part is round.

Units mm and rad. x is the radius; z is the spindle axis, pointing away from the chuck.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, cos, hypot, inf, pi, sin, tan

import numpy as np

from simulator.errors import SimulationError
from simulator.motion.segments import Floats, Segments
from simulator.physics.domain import require_positive
from simulator.physics.edge import effective_edge_angle
from simulator.removal.collision import MOST, Collision
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.lathe_carve import AxialGrid, InsertOutline, bore, carve
from simulator.removal.lathe_windows import Removed, Windows, grouped, windows_of
from simulator.removal.stations import StationKind, Stations
from stepnc_model.programs.program import Stock
from stepnc_model.units import rad_from_deg

LEAST_ANGLE = rad_from_deg(5.0)
"""Smallest angle, rad, between edge and feed; below it the edge rubs and the chip would be
infinitely thin and wide."""

LEAST_DEPTH = 1e-6
"""Smallest depth of cut, mm; shallower cuts use the chip thickness of this depth."""


def edge_angles(insert: Insert, direction: Floats) -> Floats:
    """Angle κ_r between the leading edge and the feed, rad.

    Parameters
    ----------
    direction : (M, 3) array
        Unit vectors of the feed.

    Returns
    -------
    (M,) array, rad
        π/2 where there is no feed.
    """
    mirror = -1.0 if insert.is_inside else 1.0
    z, x = direction[:, 2], mirror * direction[:, 0]
    back, front = insert.edge_angles
    # Edges as unit vectors away from the nose, and their outward normals.
    edges = [(-cos(back), sin(back)), (cos(front), sin(front))]
    outsides = [(-sin(back), -cos(back)), (sin(front), -cos(front))]
    if insert.width is not None:
        edges.append((1.0, 0.0))
        outsides.append((0.0, -1.0))
    along = np.array([u * z + v * x for u, v in edges])
    leads = np.array([u * z + v * x for u, v in outsides])
    chosen: Floats = along[leads.argmax(axis=0), np.arange(len(z))]
    angle: Floats = np.arccos(np.clip(chosen, -1.0, 1.0))
    return np.clip(angle, LEAST_ANGLE, pi - LEAST_ANGLE)


def chip_ratios(insert: Insert, depth: Floats, angle: Floats) -> Floats:
    """Chip thickness over feed, ``h/f = sin κ``, of the edge that is actually cutting.

    Parameters
    ----------
    depth : (M,) array, mm
        Depth of cut a_p.
    angle : (M,) array, rad
        Angle κ_r of the leading edge.

    Returns
    -------
    (M,) array
    """
    # The corners of a blade are small beside its width: its chip is as thick as the feed.
    nose = insert.nose_radius if insert.width is None else 0.0
    bounded = np.maximum(depth, LEAST_DEPTH)
    return np.array(
        [
            sin(effective_edge_angle(nose, one, cutting_edge_angle=kappa))
            for one, kappa in zip(bounded.tolist(), angle.tolist(), strict=True)
        ],
        dtype=np.float64,
    )


ZX_NORMAL = 1
"""Index of the axis normal to the ZX plane of the lathe."""

UPRIGHT = 0.5 * pi - 1e-9
"""Edge angle, rad, from which an edge counts as upright; steeper edges would overhang."""


def body_of(insert: Insert) -> InsertOutline:
    """Outline of an insert for the cutting kernels."""
    back, front = (_edge(insert.nose_radius, angle) for angle in insert.edge_angles)
    return InsertOutline(insert.nose_radius, insert.flat, *back, *front)


def _edge(nose: float, angle: float) -> tuple[float, float]:
    """Slope of an edge, and the distance from the centre at which it leaves the nose, mm."""
    return (inf, nose) if angle >= UPRIGHT else (tan(angle), nose * sin(angle))


def ways_of(segments: Segments, windows: Windows, insert: Insert) -> Floats:
    """Paths of the centre of the nose, one per stretch; mirrored for a bore.

    Parameters
    ----------
    segments : Segments
        Path of the programmed point.

    Returns
    -------
    (M, 9) array
        Rows of :class:`~simulator.removal.lathe_carve.NosePath`.

    Raises
    ------
    SimulationError
        If an arc does not lie in the ZX plane.
    """
    _require_plane(segments)
    rows = windows.segment
    mirror = -1.0 if insert.is_inside else 1.0
    shift_x, shift_z = insert.centre
    start = segments.position(rows, windows.start)
    end = segments.position(rows, windows.end)
    centre = segments.centre[rows]
    arm = start - centre
    begin = np.arctan2(mirror * arm[:, 0], arm[:, 2])
    length = segments.length[rows]
    part = np.divide(windows.length, length, out=np.zeros(len(rows)), where=length > 0.0)
    turn = mirror * segments.turn[rows] * part
    return np.column_stack((
        start[:, 2] + shift_z,
        mirror * (start[:, 0] + shift_x),
        end[:, 2] + shift_z,
        mirror * (end[:, 0] + shift_x),
        centre[:, 2] + shift_z,
        mirror * (centre[:, 0] + shift_x),
        segments.radius[rows],
        np.minimum(begin, begin + turn),
        np.abs(turn),
    ))


def _require_plane(segments: Segments) -> None:
    """Require that all arcs lie in the ZX plane."""
    wrong = np.flatnonzero((segments.turn != 0.0) & (segments.normal != ZX_NORMAL))
    if len(wrong):
        block = segments.block[wrong[0]]
        raise SimulationError(f"block {block}: an arc of a turning tool must lie in plane ZX")


DEFAULT_CELL = 0.01
"""Default length of a cell, mm; longer for long bars, with at most MOST_CELLS."""

MOST_CELLS = 1_000_000

ON_AXIS = 1e-3
"""Greatest distance, mm, between a drill and the axis at which it counts as centred."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BarRadii:
    """Outer and inner radii of a bar over the cells."""

    outer: Floats
    """Outer radius over each cell, (C,), mm."""
    inner: Floats
    """Radius of the bore over each cell, (C,), mm."""


class TurningStock:
    """Remaining shape of a turned bar; a mutable object.

    Parameters
    ----------
    stock : Stock
        Bar or box about the axis x = y = 0.
    cell : float, mm
        Length of a cell along the axis; None: 0.01 mm, with at most a million cells.

    Raises
    ------
    ValueError
        If the stock has no length or radius, or would need more than a million cells.
    """

    def __init__(self, stock: Stock, cell: float | None = None) -> None:
        length = stock.high[2] - stock.low[2]
        require_positive(length, "length of the bar", "mm")
        radius = stock.radius if stock.radius is not None else _around(stock)
        require_positive(radius, "radius of the bar", "mm")
        wanted = max(DEFAULT_CELL, length / MOST_CELLS) if cell is None else cell
        require_positive(wanted, "cell", "mm")
        count = max(1, ceil(length / wanted - 1e-6))
        if count > MOST_CELLS:
            raise ValueError(
                f"cell {wanted:g} mm must be at least {length / MOST_CELLS:g} mm: "
                f"the bar is {length:g} mm long"
            )
        self._grid = AxialGrid(float(stock.low[2]), length / count)
        self.outer: Floats = np.full(count, float(radius))
        """Outer radius over each cell, (C,), mm."""
        self.inner: Floats = np.zeros(count)
        """Radius of the bore over each cell, (C,), mm; empty where it equals ``outer``."""
        self.collisions: list[Collision] = []
        """Rapid moves that hit material, and tools that stood in material, in order."""
        self.holder_collisions: list[Collision] = []
        self.shank_collisions: list[Collision] = []
        """Always empty: holder and shank collisions are not modelled on a lathe."""

    @property
    def cell(self) -> float:
        """Length of a cell, mm."""
        return self._grid.cell

    @property
    def z(self) -> Floats:
        """Middles of the cells along the axis, (C,), mm."""
        middles: Floats = np.arange(len(self.outer), dtype=np.float64) + 0.5
        return self._grid.start + middles * self.cell

    @property
    def volume(self) -> float:
        """Remaining volume, mm³."""
        return float(pi * self.cell * (self.outer**2 - self.inner**2).sum())

    def cut(
        self, segments: Segments, shape: Cutter | Insert, *, is_clockwise: bool = True
    ) -> Stations:
        """Turn, face, groove or bore with an insert, or drill on the axis with a rotating tool.

        Parameters
        ----------
        segments : Segments
            Path of the programmed point of the insert, or of the tip of the tool.
        shape : Insert or Cutter
        is_clockwise : bool
            Direction of rotation of the spindle; the cut is the same in both.

        Returns
        -------
        Stations
            ``section = π · diameter · axial_depth``. For an insert, ``axial_depth`` is a_p
            across the feed, ``chip_ratio`` is sin κ of the edge that is actually cutting, and
            ``radial_width`` is the width of the chip, a_p/sin κ. For a drill, they describe one
            lip, and the depth is half the difference between its diameter and the hole's.

        Raises
        ------
        SimulationError
            If an arc of an insert does not lie in the ZX plane, or a rotating tool hits the
            bar beside its axis.
        """
        windows = windows_of(segments, self.cell)
        if isinstance(shape, Insert):
            removed = self._turned(segments, windows, shape)
            ratio = _ratios(segments, removed, shape)
            return _stations(removed, StationKind.TURNING, ratio)
        removed = self._drilled(segments, windows, shape)
        ratio = np.full(len(removed.area), sin(0.5 * shape.point_angle))
        return _stations(removed, StationKind.DRILLING, ratio)

    def tried(
        self, segments: Segments, shape: Cutter | Insert, *, is_clockwise: bool = True
    ) -> tuple[Stations, BarRadii]:
        """Cut like :meth:`cut` but keep the bar; also return the resulting radii."""
        before, count = (
            BarRadii(outer=self.outer.copy(), inner=self.inner.copy()),
            len(self.collisions),
        )
        stations = self.cut(segments, shape, is_clockwise=is_clockwise)
        after = BarRadii(outer=self.outer.copy(), inner=self.inner.copy())
        self.take(before)
        del self.collisions[count:]
        return stations, after

    def take(self, bar: BarRadii) -> None:
        """Apply the result of a trial cut of this bar."""
        self.outer[:], self.inner[:] = bar.outer, bar.inner

    def _turned(self, segments: Segments, windows: Windows, insert: Insert) -> Removed:
        """Remove the material that an insert cuts."""
        body, ways = body_of(insert), ways_of(segments, windows, insert)
        if insert.is_inside:
            taken = self._in_bore(lambda s, bed: carve(s, bed, self._grid, body, ways))
        else:
            taken = carve(self.outer, self.inner, self._grid, body, ways)
        return self._counted(segments, windows, taken)

    def _drilled(self, segments: Segments, windows: Windows, cutter: Cutter) -> Removed:
        """Remove the material that a rotating tool on the axis cuts."""
        self._require_axis(segments, cutter)
        start = segments.position(windows.segment, windows.start)
        end = segments.position(windows.segment, windows.end)
        is_beside = np.maximum(np.abs(start[:, 0]), np.abs(end[:, 0])) > ON_AXIS
        tips = np.where(is_beside, inf, np.minimum(start[:, 2], end[:, 2]))
        half = 0.5 * cutter.point_angle
        cotangent = 1.0 / tan(half) if half < UPRIGHT else 0.0
        profile = np.array([0.5 * cutter.diameter, cotangent, cutter.corner_radius])
        taken = self._in_bore(lambda s, bed: bore(s, bed, self._grid, profile, tips))
        return self._counted(segments, windows, taken)

    def _in_bore(
        self, cut: Callable[[Floats, Floats], tuple[Floats, Floats]]
    ) -> tuple[Floats, Floats]:
        """Cut the mirrored bar, in which a bore widens as its negative radius falls."""
        surface = -self.inner
        taken = cut(surface, -self.outer)
        self.inner[:] = -surface
        return taken

    def _counted(
        self, segments: Segments, windows: Windows, taken: tuple[Floats, Floats]
    ) -> Removed:
        """Group the removed amounts by stretch; record removal by rapids as collisions."""
        area, volume = taken
        is_wrong = segments.is_rapid[windows.segment]
        is_wrong[:1] = True
        wrong = np.flatnonzero(is_wrong & (volume > 0.0))
        for row in wrong[: MOST - len(self.collisions)]:
            x, y, z = segments.position(windows.segment, windows.end)[row].tolist()
            self.collisions.append(
                Collision(
                    block=int(segments.block[windows.segment[row]]),
                    volume=float(volume[row]),
                    position=(x, y, z),
                )
            )
        rest = Windows(
            segment=windows.segment[1:], start=windows.start[1:], end=windows.end[1:]
        )
        return grouped(Removed(windows=rest, area=area[1:], volume=volume[1:]), self.cell)

    def _require_axis(self, segments: Segments, cutter: Cutter) -> None:
        """Require that a rotating tool beside the axis stays out of the bar."""
        beside = np.maximum(np.abs(segments.start[:, 0]), np.abs(segments.end[:, 0])) > ON_AXIS
        inward = np.minimum(segments.start[:, 0], segments.end[:, 0]) - 0.5 * cutter.diameter
        deep = np.minimum(segments.start[:, 2], segments.end[:, 2])
        front = self.z[self.outer > self.inner].max(initial=-inf) + 0.5 * self.cell
        wrong = np.flatnonzero(beside & (inward < self.outer.max()) & (deep < front))
        if len(wrong):
            x, _, z = segments.end[wrong[0]].tolist()
            raise SimulationError(
                f"block {segments.block[wrong[0]]}: a rotating tool meets the bar beside its "
                f"axis, at x = {x:g} mm, z = {z:g} mm: only holes on the axis are modelled"
            )


def _around(stock: Stock) -> float:
    """Radius of the cylinder that encloses a box, mm."""
    x = max(abs(stock.low[0]), abs(stock.high[0]))
    y = max(abs(stock.low[1]), abs(stock.high[1]))
    return hypot(x, y)


def _ratios(segments: Segments, removed: Removed, insert: Insert) -> Floats:
    """Chip thickness over feed of each stretch."""
    windows = removed.windows
    middle = 0.5 * (windows.start + windows.end)
    angle = edge_angles(insert, segments.direction(windows.segment, middle))
    return chip_ratios(insert, _per_length(removed.area, windows.length), angle)


def _per_length(amount: Floats, length: Floats) -> Floats:
    """Amount per mm of path; 0 where the path has no length."""
    return np.divide(amount, length, out=np.zeros(len(length)), where=length > 0.0)


def _stations(removed: Removed, kind: StationKind, chip_ratio: Floats) -> Stations:
    """Stations of the removed amounts; air where nothing was removed."""
    windows = removed.windows
    section = _per_length(removed.volume, windows.length)
    is_cut = section > 0.0
    depth = np.where(is_cut, _per_length(removed.area, windows.length), 0.0)
    nothing = np.zeros(len(depth))
    return Stations(
        segment=windows.segment,
        station=windows.end,
        kind=np.where(is_cut, int(kind), int(StationKind.AIR)),
        section=section,
        growth=nothing,
        axial_depth=depth,
        radial_width=depth / np.where(is_cut, chip_ratio, 1.0),
        entry_angle=nothing,
        exit_angle=nothing,
        contact_angle=nothing,
        chip_ratio=np.where(is_cut, chip_ratio, 0.0),
        diameter=section / (pi * np.where(is_cut, depth, 1.0)),
    )
