"""Bounds that fall with spindle speed, approximated by powers of it on stretches of speed.

The solver takes bounds of the form ``b·n^δ``. The drive power left by an idling spindle and the
chuck force left by centrifugal force on the jaws are not powers of the speed; but their
logarithm is concave in that of the speed, so a power through the ends of a stretch lies below
them in between: on the safe side, and by little where the stretch is short.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from math import ceil, inf, log, sqrt

from optimiser.bounds.limits import segment_at
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from simulator.physics.holding import permitted_speed
from simulator.physics.spindle import CurveSegment, available_power, curve_segments, idle_power
from simulator.work_holding import (
    Chuck,
)

STEP = 2.0
"""Greatest ratio of the ends of a stretch of speeds.

The power law is then 3 % below the exact bound if idling takes a third of the drive power.
"""

LOSSES = tuple(share / 10.0 for share in range(1, 10))
"""Losses of chuck force at which stretches end.

The power law is 6 % below the exact bound in the last stretch, 1 % in the others.
"""

LEAST_POWER = 1.0
"""Least power that idling leaves for cutting, W, because a bound must be positive."""


def powers_of_speed(
    bound_at: Callable[[float], float], slow: float, fast: float
) -> tuple[float, float]:
    """Parameters (b, δ) of ``b·n^δ`` through a bound at two speeds; δ is 0 for one speed."""
    low, high = bound_at(slow), bound_at(fast)
    exponent = log(high / low) / log(fast / slow) if fast > slow else 0.0
    return low / slow**exponent, exponent


def stretch_ends(cut: Cut, at: CuttingConditions, low: float, high: float) -> tuple[float, ...]:
    """Ends of the speed stretches on which bounds are powers of the speed, ascending, rev/s."""
    inner = {part.max_speed for part in curve_segments(at.machine.spindle)}
    if not at.machine.only_stated_limits:
        if cut.turned is not None and cut.turned.speed_ratio < inf:
            inner |= {speed / cut.turned.speed_ratio for speed in inner}
        inner |= set(_chuck_ends(cut, at))
    ends = (low, *sorted(speed for speed in inner if low < speed < high), high)
    if at.machine.only_stated_limits:
        return ends
    return (*(speed for pair in pairwise(ends) for speed in _parts(*pair)), high)


def _parts(slow: float, fast: float) -> Iterator[float]:
    """Geometrically spaced speeds from the slow end to before the fast end."""
    count = max(1, ceil(log(fast / slow) / log(STEP) - 1e-9))
    return (slow * (fast / slow) ** (row / count) for row in range(count))


def _chuck_ends(cut: Cut, at: CuttingConditions) -> Iterator[float]:
    """Speeds at which a chuck has lost further tenths of its force, rev/s."""
    if isinstance(at.holding, Chuck) and (limit := permitted_speed(at.holding)) < inf:
        ratio = cut.turned.speed_ratio if cut.turned is not None else 1.0
        for share in LOSSES:
            yield limit * sqrt(share)
            yield limit * sqrt(share) / ratio


def segment_within(cut: Cut, at: CuttingConditions, slow: float, fast: float) -> CurveSegment:
    """Spindle curve on a stretch of speeds, less the idling power along the whole path."""
    segment = segment_at(at, sqrt(slow * fast))
    if at.machine.only_stated_limits:
        return segment
    spindle = at.machine.spindle

    def left(speed: float) -> float:
        fastest = speed if cut.turned is None else cut.turned.fastest(speed)
        return min(
            max(available_power(spindle, each) - idle_power(spindle, each), LEAST_POWER)
            for each in (speed, fastest)
        )

    coefficient, exponent = powers_of_speed(left, slow, fast)
    return replace(
        segment,
        min_speed=slow,
        max_speed=fast,
        power_coefficient=coefficient,
        power_exponent=exponent,
    )
