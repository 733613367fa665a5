"""Labels of the segments of a rebuilt path: rapid or feed, and the block of the program.

Samples are laid on the path by how much of the way is behind them. Units mm.
"""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.logged_path.sampled_path import SPACING, PathSamples, course_of, stations
from simulator.motion.segments import Bools, Floats, Ints, Segments


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LabelledPath:
    """N segments and what the samples say of each."""

    segments: Segments
    """lines are cut where rapid and feed change"""
    is_rapid: Bools
    """(N,)"""
    seen_block: Floats
    """(N,) number of the program's block that is shown most often"""


def labelled(segments: Segments, samples: PathSamples, *, station: Floats) -> LabelledPath:
    """Segments with their rapids and block numbers, cut where rapid and feed change.

    Parameters
    ----------
    segments : Segments
    samples : PathSamples
        In the order of the path.
    station : (M,) array, mm
        Of the samples along any path of the same course.
    """
    row, along = _places(segments, samples, station=station)
    for index in range(len(segments) - 1, -1, -1):
        here = row == index
        cut = _change(samples.is_rapid[here], along[here])
        if cut is not None:
            segments = _cut(segments, index, at=cut)
    row, _ = _places(segments, samples, station=station)
    is_rapid = np.zeros(len(segments), dtype=np.bool_)
    seen = np.zeros(len(segments))
    for index in range(len(segments)):
        here = row == index
        if here.any():
            is_rapid[index] = samples.is_rapid[here].mean() > 0.5
            numbers, counts = np.unique(samples.block[here], return_counts=True)
            seen[index] = numbers[np.argmax(counts)]
        elif index:
            is_rapid[index], seen[index] = is_rapid[index - 1], seen[index - 1]
    return LabelledPath(segments=segments, is_rapid=is_rapid, seen_block=seen)


def _places(
    segments: Segments, samples: PathSamples, *, station: Floats
) -> tuple[Ints, Floats]:
    """Segment on which each sample lies, and how far along.

    The share of the way behind a sample stands in for block numbers, which segments do not
    have yet.
    """
    ends = np.cumsum(segments.length)
    share = 100.0 * (ends - 0.5 * segments.length) / ends[-1]
    known = replace(samples, block=100.0 * station / station[-1])
    place = stations(known, course_of(segments, share))
    row = np.minimum(np.searchsorted(ends, place), len(segments) - 1)
    return row, place - (ends - segments.length)[row]


def _change(is_rapid: Bools, along: Floats) -> float | None:
    """Place on a segment where rapid and feed change; ``None``: nowhere."""
    if not is_rapid.any() or is_rapid.all():
        return None
    starts_rapid = along[is_rapid].mean() < along[~is_rapid].mean()
    before, after = (is_rapid, ~is_rapid) if starts_rapid else (~is_rapid, is_rapid)
    low, high = float(along[before].max()), float(along[after].min())
    is_clear = high - low > -SPACING and min(before.sum(), after.sum()) > 1
    return 0.5 * (low + high) if is_clear else None


def _cut(segments: Segments, row: int, *, at: float) -> Segments:
    """The segments, one line in two."""
    if segments.turn[row] != 0.0:
        return segments
    point = segments.position(np.array([row]), np.array([at]))
    order = np.insert(np.arange(len(segments)), row, row)
    twice = segments[order]
    end, start = twice.end.copy(), twice.start.copy()
    end[row], start[row + 1] = point[0], point[0]
    return replace(twice, start=start, end=end, block=np.arange(len(order)))
