"""Ways between the samples of a log, their length and turns. Units mm, s and rad."""

from math import pi

import numpy as np

from simulator.motion.segments import Floats

LONGEST_LOSS = 2.0
"""Longest time, s, in which the tool is taken to have gone on unseen. In longer gaps it may
have rested: some logs have a row only where a position changes."""

AROUND = 2
"""Samples before and after one whose steps count for its uncertainty."""

STRAIGHT = 0.02
"""Turn of the path, rad, up to which it shows at what speed the tool goes on."""

STEADY = 0.9
"""Ratio of the ways on two straight lines above which the tool is as fast on both."""

STILL = 1e-9
"""Movement, mm, below which a tool stands still."""


def turns_of(position: Floats) -> tuple[Floats, Floats]:
    """Angles by which the path turns at the start and the end of each line between samples.

    Parameters
    ----------
    position : (N, 3) array, mm

    Returns
    -------
    (N - 1,) array, (N - 1,) array, rad
        Half a turn at both ends of the path, where it is not known; 0 where the tool stands
        still.
    """
    lines = np.diff(position, axis=0)
    length = np.linalg.norm(lines, axis=1)
    moves = np.flatnonzero(length > STILL)
    before, behind = np.zeros(len(lines)), np.zeros(len(lines))
    if len(moves):
        along = lines[moves] / length[moves, None]
        cosine = np.clip(np.sum(along[:-1] * along[1:], axis=1), -1.0, 1.0)
        turn = np.concatenate(([pi], np.arccos(cosine), [pi]))
        before[moves], behind[moves] = turn[:-1], turn[1:]
    return before, behind


def with_missing(way: Floats, seconds: Floats, interval: float) -> Floats:
    """Way between samples, mm; where samples are missing, at least that of their neighbours.

    The tool may have gone around a corner, or there and back.
    """
    if interval <= 0.0:
        return way
    counts = np.round(seconds / interval)
    is_whole = counts <= 1.0
    is_lost = ~is_whole & (seconds <= LONGEST_LOSS)
    if not is_lost.any():
        return way
    usual = greatest_around(np.where(is_whole, way, 0.0))
    return np.where(is_lost, np.maximum(way, usual * counts), way)


def longest_ways(ways: Floats, seconds: Floats) -> Floats:
    """Longest way that the tool may have gone between two samples, (N,), mm.

    It goes as fast as on straight lines before and behind, at most ``AROUND`` away, if these
    are equally fast; otherwise the way is infinite.

    Parameters
    ----------
    ways : (N,) array, mm
        Way where the line is straight at one end at least; NaN elsewhere.
    seconds : (N,) array, s
        Time between the samples.
    """
    count = len(ways)
    padded = np.pad(ways, AROUND, constant_values=np.nan)
    time = np.pad(seconds, AROUND, constant_values=np.nan)
    longest = np.full(count, np.inf)
    for before, behind in ((2, 2), (2, 1), (1, 2), (1, 1)):
        ends = [slice(AROUND + by, AROUND + by + count) for by in (-before, behind)]
        times = [np.maximum(seconds / np.maximum(time[end], STILL), 1.0) for end in ends]
        one, other = (padded[end] * each for end, each in zip(ends, times, strict=True))
        fast = np.maximum(one, other)
        longest = np.where(np.minimum(one, other) > STEADY * fast, fast, longest)
    return longest


def to_ends(values: Floats) -> Floats:
    """Values of N - 1 lines at the end of each, and at the start of the first, (N,)."""
    return np.concatenate((values[:1] if len(values) else [0.0], values))


def greatest_around(values: Floats) -> Floats:
    """Greatest of each value and its neighbours, (N,)."""
    found = values.copy()
    for shift in range(1, AROUND + 1):
        found[shift:] = np.maximum(found[shift:], values[:-shift])
        found[:-shift] = np.maximum(found[:-shift], values[shift:])
    return found
