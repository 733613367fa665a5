"""Curves of both runs along the path and over time for plots, in a bounded number of points."""

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any

import numpy as np

from service.along_path.plan_run import LimitStretch
from service.along_path.run import FeedsAlongPath
from service.along_path.trace import PathSignal, PathTrace
from service.plots.buckets import BucketedRun
from simulator.motion.segments import Floats, Ints

MOST_BUCKETS = 1000
"""Largest number of stretches of a curve; each has a minimum and a maximum."""

SIGNALS = (
    ("feed_mm_min", PathSignal.FEED, 1.0),
    ("cutting_force_n", PathSignal.FORCE, 1.0),
    ("drive_power_w", PathSignal.POWER, 1e3),
)
"""Names of the signals, with the factor to their units."""

PLACES = 3
"""Decimal places of lengths, times and values."""


def curves_record(along: FeedsAlongPath) -> dict[str, Any] | None:
    """Return the curves of both runs as a JSON object; None if no signals were kept.

    Each curve has at most :data:`MOST_BUCKETS` stretches, hence twice as many points.
    """
    if along.before_trace is None or along.after_trace is None:
        return None
    runs = {"before": along.before_trace, "after": along.after_trace}

    def both(choose: Callable[[PathTrace], BucketedRun]) -> dict[str, Any]:
        return {name: _curve(choose(trace)) for name, trace in runs.items()}

    return {
        "length_mm": both(lambda trace: trace.along),
        "time_s": both(lambda trace: trace.over_time),
        "limits": _limits(along.limits),
    }


def _curve(run: BucketedRun) -> dict[str, Any]:
    """Minimum and maximum of each signal in stretches of a run."""
    count = len(run.begin)
    firsts = np.arange(0, count, max(ceil(count / MOST_BUCKETS), 1))
    lasts = np.append(firsts[1:], count) - 1 if count else firsts
    return {
        "begin": _shown(run.begin[firsts]),
        "end": _shown(run.end[lasts]),
        "signals": {
            name: {
                "low": _shown(factor * _joined(np.fmin, run.curve(signal).low, firsts)),
                "high": _shown(factor * _joined(np.fmax, run.curve(signal).high, firsts)),
            }
            for name, signal, factor in SIGNALS
        },
    }


def _joined(join: np.ufunc, values: Floats, firsts: Ints) -> Floats:
    """Join the values from each first index up to the next."""
    found: Floats = join.reduceat(values, firsts) if len(firsts) else values
    return found


def _shown(values: Floats) -> Floats:
    rounded: Floats = np.round(values, PLACES)
    return rounded


def _limits(limits: Sequence[LimitStretch]) -> dict[str, Any]:
    """Active limits along the path: in each of some stretches the one that holds longest."""
    names = list(dict.fromkeys(each.words for each in limits))
    end = max((each.end for each in limits), default=0.0)
    width = max(end / MOST_BUCKETS, 1e-9)
    held: dict[int, dict[str, float]] = {}
    for each in limits:
        for at in range(int(each.begin / width), int(each.end / width) + 1):
            low, high = max(each.begin, at * width), min(each.end, (at + 1) * width)
            if high > low:
                place = held.setdefault(at, {})
                place[each.words] = place.get(each.words, 0.0) + high - low
    rows: list[tuple[float, float, int]] = []
    for at, lengths in sorted(held.items()):
        number = names.index(max(lengths, key=lambda words: lengths[words]))
        begin = at * width
        if rows and rows[-1][2] == number and begin - rows[-1][1] < 0.5 * width:
            begin = rows.pop()[0]
        rows.append((begin, (at + 1) * width, number))
    return {
        "names": names,
        "begin_mm": [round(row[0], PLACES) for row in rows],
        "end_mm": [round(row[1], PLACES) for row in rows],
        "limit": [row[2] for row in rows],
    }
