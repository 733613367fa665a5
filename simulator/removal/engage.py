"""Milling and drilling of one stock: removal and engagement along a program, move by move.

On level moves of a flat cutter the section comes from exact arcs wherever every arc is known
exactly; its volume then agrees with the map to within the resolution of the cells. Everywhere
else the section comes from the volume that the map loses, over windows of at least ten cells,
because shorter windows are noisy, and is shared among the stations in proportion to the section
seen at the rim. Units mm and rad.
"""

from math import inf, pi, sin

import numpy as np

from simulator.motion.segments import Floats, Segments
from simulator.removal.collision import MOST, Collision
from simulator.removal.cutter import Cutter, CutterProfile, cylinder, profile_of
from simulator.removal.march import (
    AXIAL,
    CHIP,
    COLUMNS,
    CONTACT,
    DEPTH,
    DIAMETER,
    ENTRY,
    EXACT,
    EXIT,
    FINDINGS,
    GROWTH,
    HOLDER,
    HOLDER_X,
    HOLDER_Y,
    KIND,
    LENGTH,
    MOST_TURNS,
    ROOM_FOR_ROW,
    ROW,
    SECTION,
    SHANK,
    SPOT_X,
    SPOT_Y,
    SPOT_Z,
    STATION,
    VOLUME,
    marched,
)
from simulator.removal.march_cache import KeptMarches
from simulator.removal.rim import past
from simulator.removal.ring import RimTool
from simulator.removal.stations import StationKind, Stations
from simulator.removal.trial import (
    MarchSettings,
    PathTrial,
    RemovalTask,
    StockPatch,
    box_of,
    desk_for,
    moves_of,
    patch_of,
    put_back,
    rows_of,
)
from simulator.removal.zmap import ZMap, cell_size, zmap_of
from stepnc_model.programs.program import Stock

WINDOW = 10.0
"""Number of cells of path over which the volume lost by the map is a reliable measure."""

STEP_SHARE = 0.25
"""Longest stretch between two stations, as a share of the tool radius."""

LEAST_SHARE = 0.05
"""Shortest stretch between two stations, as a share of the tool radius."""

_CHUNK = 16_384  # rows that are marched in one call
_LINES = 4 * ROOM_FOR_ROW


class MillingStock:
    """Stock that milling and drilling cut away; a mutable object.

    Parameters
    ----------
    stock : Stock or ZMap
        Raw part, or the map of a stock that has a shape already.
    cell : float, mm
        Size of the map's cells; by default chosen from the stock and the smallest tool.
    smallest_diameter : float, mm
        Smallest diameter of the tools that will be used.
    """

    def __init__(
        self,
        stock: Stock | ZMap,
        *,
        cell: float | None = None,
        smallest_diameter: float = inf,
    ) -> None:
        self.map: ZMap
        if isinstance(stock, ZMap):
            self.map = stock
        else:
            usual = cell_size(stock, smallest_diameter=smallest_diameter)
            self.map = zmap_of(stock, cell=usual if cell is None else cell)
        self.volume = 0.0
        """Volume removed so far according to the map, mm³."""
        self.collisions: list[Collision] = []
        """Rapid moves that removed material."""
        self.holder_collisions: list[Collision] = []
        """Places where the holder would hit material, with the depth of the holder there."""
        self.shank_collisions: list[Collision] = []
        """Material above the cutting edge, with its height over the end of the edge."""
        self.marches: KeptMarches | None = None
        """Marches of other runs, from which what was met before is read again."""
        self._past = past()

    def cut(self, segments: Segments, cutter: Cutter, *, is_clockwise: bool = True) -> Stations:
        """Cut along segments, in order, and return the engagement of the tool.

        Parameters
        ----------
        segments : Segments
            Path of the tip of the tool.
        is_clockwise : bool
            Direction of rotation of the spindle, seen from above.

        Returns
        -------
        Stations
            At least one row per segment.

        Raises
        ------
        ValueError
            If the cutter's shape is impossible, or an arc has more than 100 turns.
        """
        turns = np.abs(segments.turn).max(initial=0.0) / (2.0 * pi)
        if turns > MOST_TURNS:
            raise ValueError(f"an arc has {turns:g} turns; the limit is {MOST_TURNS:g}")
        grid = self.map.grid
        profile = profile_of(cutter, reach=grid.top - grid.bottom)
        flank = sin(cutter.cutting_edge_angle)
        tool = RimTool(profile, flank, 1.0 if is_clockwise else -1.0)
        how = _how(cutter, profile, self.map.cell)
        self._past.last[:] = np.nan
        parts: list[Floats] = []
        for first in range(0, len(segments), _CHUNK):
            parts += self._chunk(segments[first : first + _CHUNK], tool, how, first)
        lines = np.concatenate(parts) if parts else np.empty((0, COLUMNS))
        _windowed(lines, WINDOW * self.map.cell)
        return _stations(lines, cutter)

    def tried(
        self, segments: Segments, cutter: Cutter, *, is_clockwise: bool = True
    ) -> tuple[Stations, PathTrial]:
        """Cut like :meth:`cut` but keep the stock; also return the resulting change."""
        radius = profile_of(cutter, reach=self.map.grid.top - self.map.grid.bottom).radius
        where = box_of(self.map.grid, segments, radius), moves_of(self._past, segments)
        before, volume = patch_of(self.map.grid, self._past, *where), self.volume
        kept = [self.collisions, self.holder_collisions, self.shank_collisions]
        counts = list(map(len, kept))
        stations = self.cut(segments, cutter, is_clockwise=is_clockwise)
        after = patch_of(self.map.grid, self._past, *where)
        put_back(before, self.map.grid, self._past)
        self.volume = volume
        for each, count in zip(kept, counts, strict=True):
            del each[count:]
        return stations, PathTrial(before=before, after=after)

    @property
    def next_move(self) -> int:
        """Number of the next move that cuts."""
        return int(self._past.next[0])

    def take(self, patch: StockPatch) -> None:
        """Apply the result of a trial cut of this stock."""
        put_back(patch, self.map.grid, self._past)

    def _chunk(
        self, segments: Segments, tool: RimTool, how: MarchSettings, first: int
    ) -> list[Floats]:
        """Cut along a chunk of rows and return the lines written for its stations."""
        task = RemovalTask(self.map.grid, self._past, tool, how, desk_for(tool))
        rows = rows_of(segments)
        out = np.empty((_LINES, COLUMNS))
        found = np.zeros((len(segments), FINDINGS))
        if self.marches is None:
            parts = [marched(task, rows, segments.length, out, found)]
        else:
            parts = self.marches.marched(task, segments, rows, out, found)
        for part in parts:
            part[:, ROW] += first
        self.volume += float(found[:, VOLUME].sum())
        self._note(segments, found, first)
        return parts

    def _note(self, segments: Segments, findings: Floats, first: int) -> None:
        """Record the collisions found in a chunk of rows."""
        rapids = np.flatnonzero((findings[:, VOLUME] > 0.0) & segments.is_rapid)
        for row in rapids[: MOST - len(self.collisions)]:
            spot = tuple(findings[row, [SPOT_X, SPOT_Y, SPOT_Z]].tolist())
            self.collisions.append(
                Collision(
                    segment=first + int(row),
                    block=int(segments.block[row]),
                    depth=float(findings[row, DEPTH]),
                    position=spot,
                    volume=float(findings[row, VOLUME]),
                )
            )
        for column, kept in ((HOLDER, self.holder_collisions), (SHANK, self.shank_collisions)):
            for row in np.flatnonzero(findings[:, column] > 0.0)[: MOST - len(kept)]:
                where = [HOLDER_X, HOLDER_Y] if column == HOLDER else [SPOT_X, SPOT_Y]
                x, y = findings[row, where].tolist()
                kept.append(
                    Collision(
                        segment=first + int(row),
                        block=int(segments.block[row]),
                        depth=float(findings[row, column]),
                        position=(x, y, float(segments.end[row, 2])),
                    )
                )


def _how(cutter: Cutter, profile: CutterProfile, cell: float) -> MarchSettings:
    """Settings for marching a cutter over a map with a given cell size."""
    holder = cutter.holder
    return MarchSettings(
        step=STEP_SHARE * profile.radius,
        least=LEAST_SHARE * profile.radius,
        coarse=5.0 * cell,
        shape=np.array(profile),
        neck=cylinder(profile.radius),
        shank=cutter.edge_length,
        holder=cylinder(0.5 * holder.diameter if holder else 1.0),
        overhang=holder.overhang if holder else inf,
        tip_sine=sin(0.5 * cutter.point_angle),
    )


def _windowed(lines: Floats, window: float) -> None:
    """Redistribute the volume lost by the map over windows of neighbouring stretches."""
    is_shared = (lines[:, KIND] == StationKind.MILLING) & (lines[:, EXACT] == 0.0)
    rows = np.flatnonzero(is_shared)
    if not len(rows):
        return
    length = lines[rows, LENGTH]
    is_break = np.diff(rows, prepend=-2) != 1
    run = np.cumsum(is_break)
    before = np.cumsum(length) - length
    start = before[is_break][run - 1]
    bins = run * 1e9 + np.floor((before - start) / window)
    edges = np.flatnonzero(np.diff(bins, prepend=-1.0) != 0.0)
    volume = np.add.reduceat(lines[rows, SECTION] * length, edges)
    whole = np.add.reduceat(length, edges)
    counts = np.diff(np.append(edges, len(rows)))
    lines[rows, SECTION] = np.repeat(volume / whole, counts)


def _stations(lines: Floats, cutter: Cutter) -> Stations:
    """Convert the lines written by the march to stations."""
    axial, section = lines[:, AXIAL].copy(), lines[:, SECTION]
    diameter = lines[:, DIAMETER].copy()
    kind = lines[:, KIND].astype(np.int64)
    if cutter.is_drill and cutter.point_angle == pi:
        # A reamer cuts a ring thinner than a cell: its section gives the old hole's diameter.
        rows = np.flatnonzero((kind == StationKind.DRILLING) & (section > 0.0))
        bored = np.sqrt(np.maximum(cutter.diameter**2 - 4.0 * section[rows] / pi, 0.0))
        axial[rows] = 0.5 * (cutter.diameter - bored)
        diameter[rows] = 0.5 * (cutter.diameter + bored)
    width = np.divide(section, axial, out=np.zeros(len(lines)), where=axial > 0.0)
    return Stations(
        segment=lines[:, ROW].astype(np.int64),
        station=lines[:, STATION].copy(),
        kind=kind,
        section=section.copy(),
        growth=lines[:, GROWTH].copy(),
        axial_depth=axial,
        radial_width=np.where(kind == StationKind.DRILLING, axial, width),
        entry_angle=lines[:, ENTRY].copy(),
        exit_angle=lines[:, EXIT].copy(),
        contact_angle=lines[:, CONTACT].copy(),
        chip_ratio=lines[:, CHIP].copy(),
        diameter=diameter,
    )
