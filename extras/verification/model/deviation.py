"""Deviations of the logged part from the programmed one, with the uncertainty of each.

On walls a deviation is the difference of the two signed distances in the plane; on floors it
is the difference of heights, along the normal of the surface. Excess is positive, a gouge
negative. A log knows the path only at its samples; normal to the surface this leaves, for the
way s that the tool goes between samples,

* on straights, the rounding of positions;
* on arcs of radius R, ``s²/8R``;
* at corners that turn by α, ``s/2 · sin(α/2)``: ``s/(2·√2)`` at square corners, and ``s/2``
  where the tool turns back, as at the bottom of a hole.

A bound counts wherever the programmed path turns within s of the place. At the samples
themselves the tool was: a gouge that one of them makes on a turned part is certain, whatever
the tool did in between. Units mm, s and rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from math import pi, sqrt

import numpy as np
from scipy import ndimage

from extras.verification.model.logged_part import LogFacts, LoggedPart, ReferencePart
from extras.verification.model.path import SAGITTA, ProgrammedPath
from extras.verification.model.surface import EXACT, ProgrammedPart
from extras.verification.model.sweep import FAR
from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.zmap import OUTSIDE, HeightGrid

WALL_STRIP = 0.5
"""Width of the strip along walls where floors are not compared, mm: there a height says
nothing about where the wall is."""

SHIFT = 0.5
"""Distance, mm, by which an error may have moved the corners of a log along a surface."""

MOST_SEGMENTS = 12
"""Most segments within a step whose radii are looked at."""

EQUAL = 1e-6
"""Difference of heights that counts as none, mm."""


class SurfaceKind(StrEnum):
    """Kind of a place on the surface."""

    WALL = "wall"
    FLOOR = "floor"
    FACE = "face"
    """Surface of a turned part across its axis, or steeper than 45°."""
    DIAMETER = "diameter"
    """Surface of a turned part along its axis."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfacePlaces:
    """N places on the surface of the programmed part."""

    is_wall: Bools
    """Whether a place is on a wall, (N,), or else on a floor."""
    position: Floats
    """(N, 3), mm."""
    deviation: Floats
    """Deviation along the normal, (N,), mm: excess positive, gouge negative."""
    uncertainty: Floats
    """Uncertainty of the deviation, (N,), mm."""
    certain: Floats
    """Size that it has at least, by the samples alone, (N,), mm; 0 where they tell none."""
    area: Floats
    """Area that a place stands for, (N,), mm²."""
    workingstep: Ints
    """Index of the workingstep whose surface it is, (N,); -1 for the raw part."""
    block: Ints
    """Block of the program that makes the surface, (N,); 0 for the raw part."""
    time: Floats
    """Time of the sample that came nearest, (N,), s; NaN for none."""
    cut_by: Ints
    """Index of the workingstep that the log shows then, (N,); -1 where it is unknown."""

    def __len__(self) -> int:
        return len(self.deviation)

    def __getitem__(self, rows: Bools | Ints) -> "SurfacePlaces":
        return SurfacePlaces(**{
            each.name: getattr(self, each.name)[rows] for each in fields(SurfacePlaces)
        })

    @staticmethod
    def joined(parts: "Sequence[SurfacePlaces]") -> "SurfacePlaces":
        """Places of several parts in one."""
        return SurfacePlaces(**{
            each.name: np.concatenate([getattr(part, each.name) for part in parts])
            for each in fields(SurfacePlaces)
        })

    @property
    def least(self) -> Floats:
        """Size that a deviation has at least, (N,), mm; not positive where it may be none."""
        beyond = np.abs(self.deviation) - self.uncertainty
        return np.where(self.certain > 0.0, np.maximum(beyond, self.certain), beyond)

    @property
    def is_beyond(self) -> Bools:
        """True if a deviation is greater than its uncertainty, or certain, (N,)."""
        return self.least > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedVolumes:
    """Volumes of the two parts, mm³."""

    programmed: float
    """Volume removed by the programmed path."""
    logged: float
    """Volume removed by the logged positions."""
    gouge: float
    """Volume that only the logged positions remove."""
    excess: float
    """Volume that only the programmed path removes."""


def surface_places(part: ProgrammedPart, logged: LoggedPart) -> SurfacePlaces:
    """Compare the logged part with the programmed one at walls and floors."""
    return SurfacePlaces.joined([_wall_places(part, logged), _floor_places(part, logged)])


def compared_volumes(part: ReferencePart, logged: LoggedPart) -> ComparedVolumes:
    """Compare the volumes that the two paths remove, by the height maps."""
    grid = part.map.grid
    cell = grid.dx * grid.dy
    more = (logged.map.grid.heights - grid.heights) * cell
    return ComparedVolumes(
        programmed=logged.raw_volume - part.map.volume,
        logged=logged.raw_volume - logged.map.volume,
        gouge=float(np.maximum(-more, 0.0).sum()),
        excess=float(np.maximum(more, 0.0).sum()),
    )


def smallest_arc(path: ProgrammedPath) -> float:
    """Radius of the smallest arc of a programmed path, mm; infinite without an arc."""
    return float(path.radius.min())


def arc_uncertainty(step: float, radius: float) -> float:
    """Greatest distance of an arc from its chord, mm: ``s²/8R``, at most half the step."""
    return min(step * step / (8.0 * radius), 0.5 * step)


def corner_uncertainty(step: float, turn: float = 0.5 * pi) -> float:
    """Greatest distance of a corner from the line that cuts it, mm: ``s/2 · sin(α/2)``."""
    return float(0.5 * step * np.sin(0.5 * turn))


def rounding_uncertainty(facts: LogFacts) -> float:
    """Greatest error normal to a surface by the rounding of both coordinates, mm."""
    return facts.rounding / sqrt(2.0)


def wall_uncertainty(logged: LoggedPart, uncertainty: Floats) -> Floats:
    """Uncertainty of walls, (P,), mm, that also counts what the tool may have cut unseen."""
    away = logged.targets.away
    unknown = np.where(away > 0.0, away - logged.possible.away, 0.0)
    return np.asarray(uncertainty + np.clip(unknown, 0.0, np.maximum(away, 0.0)))


def _wall_places(part: ProgrammedPart, logged: LoggedPart) -> SurfacePlaces:
    path, walls = part.path, part.walls
    position = np.column_stack([walls.targets.x, walls.targets.y, walls.targets.z])
    segment = path.segment[walls.chord]
    start = path.chord_station[walls.chord]
    station = start + np.hypot(*(walls.foot - walls.chord_start).T)
    bend = np.where(
        path.is_plunge[segment], 0.0, path_uncertainty(path, station, logged.walls.step)
    )
    steps = path.workingstep[segment]
    return SurfacePlaces(
        is_wall=np.ones(len(position), dtype=np.bool_),
        position=position,
        deviation=logged.targets.away - walls.rest,
        uncertainty=wall_uncertainty(logged, bend + rounding_uncertainty(logged.facts) + EXACT),
        certain=np.zeros(len(position)),
        area=walls.area,
        workingstep=steps,
        block=path.block[segment],
        time=logged.walls.time,
        cut_by=logged.walls.workingstep,
    )


def path_uncertainty(
    path: ProgrammedPath, station: Floats, step: Floats, *, reach: float = 0.0
) -> Floats:
    """Return the uncertainty by the way between samples at stations of a path, mm.

    Corners and arcs count within a step, ``SHIFT`` and a further reach in mm, before and
    behind.
    """
    reach += SHIFT
    low, high = station - step - reach, station + step + reach
    turned = np.concatenate(([0.0], np.cumsum(path.turn)))
    first, last = path.station.searchsorted(low), path.station.searchsorted(high, "right")
    turn = np.minimum(turned[last] - turned[first], pi)
    tightest = path.radius[np.maximum(last - 1, 0)].copy()
    for back in range(2, MOST_SEGMENTS + 1):
        row = np.maximum(last - back, 0)
        is_near = row >= first - 1
        tightest = np.where(is_near, np.minimum(tightest, path.radius[row]), tightest)
    arc = np.minimum(step * step / (8.0 * tightest), 0.5 * step)
    return np.asarray(0.5 * step * np.sin(0.5 * turn) + arc)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloorCells:
    """N cells of a height map that are compared by height."""

    cells: tuple[Ints, Ints]
    """Columns and rows."""
    position: Floats
    """Middle of each at its height, (N, 3), mm."""
    deviation: Floats
    """Deviation along the normal, (N,), mm."""
    uncertainty: Floats
    """Uncertainty by rounding and by slivers, (N,), mm."""
    area: Floats
    """(N,), mm²"""


def floor_cells(
    grid: HeightGrid, is_compared: Bools, is_wall: Bools, logged: LoggedPart
) -> FloorCells:
    """Compare heights away from walls.

    Parameters
    ----------
    grid : HeightGrid
        Heights of the part that is compared with.
    is_compared : (X, Y) array of bool
        Cells that count.
    is_wall : (X, Y) array of bool
        Cells beside a wall.
    """
    distance = ndimage.distance_transform_edt(~is_wall, sampling=(grid.dx, grid.dy))
    column, row = np.nonzero(is_compared & (distance > WALL_STRIP))
    lean = _lean(grid.heights, grid.dx, grid.dy)[column, row]
    deviation, is_lateral = _floor_deviation(grid, logged)
    width = max(grid.dx, grid.dy) + 0.5 * logged.facts.step
    beside = np.where(is_lateral[column, row], width, 0.0)
    # Of material that the tool may have cut unseen it is not known whether it is there.
    unseen = logged.map.grid.heights - logged.possible_heights
    unknown = np.clip(unseen[column, row], 0.0, np.maximum(deviation[column, row], 0.0))
    return FloorCells(
        cells=(column, row),
        position=np.column_stack([
            grid.x + (column + 0.5) * grid.dx,
            grid.y + (row + 0.5) * grid.dy,
            grid.heights[column, row],
        ]),
        deviation=deviation[column, row] * lean,
        uncertainty=beside + rounding_uncertainty(logged.facts) + 10.0 * SAGITTA + unknown,
        area=grid.dx * grid.dy / lean,
    )


def _floor_places(part: ProgrammedPart, logged: LoggedPart) -> SurfacePlaces:
    grid, path = part.map.grid, part.path
    floors = floor_cells(grid, grid.owner != OUTSIDE, part.is_wall, logged)
    owner = grid.owner[floors.cells]
    segment = path.segment[np.maximum(owner, 0)]
    is_cut = owner >= 0
    step = logged.floors.step[floors.cells]
    # A height is as certain as the positions; the bottom of a plunge may lie between samples.
    height = np.where(path.is_plunge[segment] & is_cut, 0.5 * step, 0.0)
    return SurfacePlaces(
        is_wall=np.zeros(len(owner), dtype=np.bool_),
        position=floors.position,
        deviation=floors.deviation,
        uncertainty=height + floors.uncertainty,
        certain=np.zeros(len(owner)),
        area=floors.area,
        workingstep=np.where(is_cut, path.workingstep[segment], -1),
        block=np.where(is_cut, path.block[segment], 0),
        time=logged.floors.time[floors.cells],
        cut_by=logged.floors.workingstep[floors.cells],
    )


def _floor_deviation(grid: HeightGrid, logged: LoggedPart) -> tuple[Floats, Bools]:
    """Differences of heights, (X, Y), mm, and where the way to the side is shorter.

    A sliver that is high but narrow deviates by its width, not by its height.
    """
    more = logged.map.grid.heights - grid.heights
    is_other = np.abs(more) > EQUAL
    if is_other.all():
        return np.clip(more, -FAR, FAR), np.zeros_like(is_other)
    beside = ndimage.distance_transform_edt(is_other, sampling=(grid.dx, grid.dy))
    size = np.minimum(np.minimum(np.abs(more), beside), FAR)
    is_lateral = is_other & (beside < np.abs(more))
    return np.asarray(np.sign(more) * size), np.asarray(is_lateral)


def _lean(heights: Floats, dx: float, dy: float) -> Floats:
    """Cosine of the angle between the normal of a surface and the axis of the tool, (X, Y)."""
    along, across = np.gradient(heights, dx, dy)
    return np.asarray(1.0 / np.sqrt(1.0 + along * along + across * across))
