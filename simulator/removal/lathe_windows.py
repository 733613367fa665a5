"""Stretches of a path over which removal on a lathe is measured.

The map resolves whole cells only: measured over fewer than tens of cells, a wall that moves
along the axis advances in jumps. So a stretch spans at least :data:`WINDOW` cells, on a line a
whole number of them, and what short segments remove is spread over their neighbours. The total
volume is preserved: section times length adds up to what left the map. Units mm.
"""

from dataclasses import dataclass

import numpy as np

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats, Ints, Segments

WINDOW = 50
"""Length of the shortest stretch, in cells; keeps jumps of one cell below 2 %."""

ALIKE = 0.01
"""Relative difference of section or depth below which stretches are merged."""

_ROUNDING = 1e-6  # share of a stretch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Windows:
    """M stretches of a path, in order, each within one segment."""

    segment: Ints
    """Index of the segment of each stretch, (M,)."""
    start: Floats
    """Start of each stretch along its segment, (M,), mm."""
    end: Floats
    """End of each stretch along its segment, (M,), mm."""

    @property
    def length(self) -> Floats:
        """Length of each stretch, (M,), mm."""
        return self.end - self.start


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Removed:
    """Material removed over each stretch."""

    windows: Windows
    area: Floats
    """Area removed in the ZX half plane, (M,), mm²."""
    volume: Floats
    """Removed volume, (M,), mm³."""


def windows_of(segments: Segments, cell: float) -> Windows:
    """Divide segments into stretches; a rapid is a single stretch.

    The first stretch has no length and stands for the initial position of the tool.

    Parameters
    ----------
    cell : float, mm

    Returns
    -------
    Windows
    """
    length = segments.length
    along = np.abs(segments.end[:, 2] - segments.start[:, 2])
    share = np.divide(along, length, out=np.zeros(len(length)), where=length > 0.0)
    step = np.full(len(length), WINDOW * cell)
    lines = (segments.turn == 0.0) & (share * WINDOW >= 1.0)
    step[lines] = np.ceil(share[lines] * WINDOW - _ROUNDING) * cell / share[lines]
    count = np.maximum(1, (length / step + _ROUNDING).astype(np.int64))
    count[segments.is_rapid] = 1
    segment = np.repeat(np.arange(len(length)), count)
    rank = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)
    # Counted from the end of a segment, where the walls of shoulders are met.
    left = count[segment] - 1 - rank
    end = length[segment] - left * step[segment]
    start = np.where(rank == 0, 0.0, np.roll(end, 1))
    return Windows(
        segment=np.insert(segment, 0, segment[:1]),
        start=np.insert(start, 0, start[:1]),
        end=np.insert(end, 0, start[:1]),
    )


def grouped(removed: Removed, cell: float) -> Removed:
    """Merge stretches with similar removal; short stretches take the mean of their group.

    Parameters
    ----------
    cell : float, mm

    Returns
    -------
    Removed
        At least one stretch per segment, the last one ending at the segment's end.
    """
    windows, length = removed.windows, removed.windows.length
    if len(length) == 0:
        return removed
    group = np.zeros(len(length), dtype=np.int64)
    least = WINDOW * cell * (1.0 - _ROUNDING)
    _number_groups(removed.area, removed.volume, length, least, group)
    first = np.flatnonzero(np.diff(group, prepend=-1))
    whole = np.add.reduceat(length, first)
    whole = np.where(whole > 0.0, whole, 1.0)
    depth = (np.add.reduceat(removed.area, first) / whole)[group]
    section = (np.add.reduceat(removed.volume, first) / whole)[group]
    is_new = (np.diff(group, prepend=-1) != 0) | (np.diff(windows.segment, prepend=-1) != 0)
    begin = np.flatnonzero(is_new)
    end = np.append(begin[1:], len(length)) - 1
    kept = windows.end[end] - windows.start[begin]
    return Removed(
        windows=Windows(
            segment=windows.segment[end], start=windows.start[begin], end=windows.end[end]
        ),
        area=depth[end] * kept,
        volume=section[end] * kept,
    )


@entry
def _number_groups(
    area: Floats, volume: Floats, length: Floats, least: float, group: Ints
) -> None:
    """Write the group number of each stretch, from 0 up, into ``group`` (initially zeros)."""
    total, depth, section = length[0], area[0], volume[0]
    for row in range(1, len(area)):
        is_air = volume[row] == 0.0
        # A group is entirely in the cut or entirely in air; it grows until it is long enough
        # to measure, and after that as long as the following stretches are similar.
        is_same = is_air == (section == 0.0)
        if is_same and not is_air and min(total, length[row]) >= least:
            per_total, per_row = 1.0 / total, 1.0 / length[row]
            is_same = _alike(depth * per_total, area[row] * per_row) and _alike(
                section * per_total, volume[row] * per_row
            )
        elif is_same and not is_air and total >= least:
            is_same = False
        if is_same:
            total += length[row]
            depth += area[row]
            section += volume[row]
            group[row] = group[row - 1]
        else:
            total, depth, section = length[row], area[row], volume[row]
            group[row] = group[row - 1] + 1


@kernel
def _alike(one: float, other: float) -> bool:
    """True if two values are equal within the tolerance ``ALIKE``."""
    return bool(abs(one - other) <= ALIKE * abs(one))
