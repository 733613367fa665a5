"""Limits of a workingstep at one spindle speed, reduced to what still depends on the depth.

Without an offset a limit caps the feed at ``f = ((b/c)·n^(δ−γ))^(1/α) · a^(−β/α)``: one power
of the depth. All caps that do not depend on the depth reduce to one number.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import exp, inf, log

from optimiser.errors import OptimisationError
from optimiser.problem import ROUNDING, BoundSide, Limit

LARGE = 20.0
"""Logarithm of a number of passes beyond any that is tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedCaps:
    """Greatest and least feed per tooth as functions of the depth, at one spindle speed."""

    constant: float
    """Least of the caps that do not depend on the depth, mm."""
    powers: tuple[tuple[float, float], ...]
    """(factor, exponent) of each cap that is a power of the depth."""
    others: tuple[Limit, ...]
    """Limits that depend on the depth, but not as a power of it."""
    floor: float
    """Greatest of the lower limits that do not depend on the depth, mm."""
    floors: tuple[Limit, ...]
    """Lower limits that depend on the depth."""
    deepest: float
    """Greatest depth that the depth limits allow, mm."""
    speed: float
    """Spindle speed, rev/s."""

    def best(self, depth: float) -> float:
        """Greatest feed per tooth that all limits allow at a depth, mm; zero if none is.

        Raises
        ------
        OptimisationError
            When nothing limits the feed.
        """
        if depth > self.deepest * (1.0 + ROUNDING):
            return 0.0
        highest, lowest = self.constant, self.floor
        for factor, exponent in self.powers:
            feed = factor * depth**exponent
            if feed < highest:  # noqa: PLR1730 (a call of min would take most of the time)
                highest = feed
        for limit in self.others:
            highest = min(highest, limit.feed_at_bound(depth, self.speed))
        if highest == inf:
            raise OptimisationError(
                "nothing limits the feed: the machine, the material and the tool grade give "
                "no power, force, chip load or feed bound"
            )
        for limit in self.floors:
            lowest = max(lowest, limit.feed_at_bound(depth, self.speed))
        return 0.0 if highest < lowest * (1.0 - ROUNDING) else highest

    def passes_to_constant(self, total_depth: float) -> float:
        """Number of passes from which on no power of the depth caps the feed; no integer."""
        if not 0.0 < self.constant < inf or total_depth <= 0.0:
            return 0.0
        # As a logarithm, since a small exponent makes a number of any size.
        least = min(
            (log(self.constant / factor) / exponent for factor, exponent in self.powers),
            default=inf,
        )
        return exp(min(log(total_depth) - least, LARGE))


def caps_at(limits: Iterable[Limit], speed: float) -> FeedCaps:
    """Collect the feed caps of all limits at one spindle speed in rev/s."""
    constant, floor, deepest = inf, 0.0, inf
    powers: list[tuple[float, float]] = []
    others: list[Limit] = []
    floors: list[Limit] = []
    at_least = BoundSide.AT_LEAST
    for limit in limits:
        load = limit.load
        if load.feed_exponent == 0.0:
            if limit.is_of_depth:
                deepest = min(deepest, limit.greatest_depth(speed))
        elif limit.sense is at_least:
            if load.knows_depth:
                floors.append(limit)
            else:
                floor = max(floor, limit.feed_at_bound(1.0, speed))
        elif not load.knows_depth:
            constant = min(constant, limit.feed_at_bound(1.0, speed))
        elif load.offset == 0.0 and load.curve is None:
            exponent = -load.depth_exponent / load.feed_exponent
            powers.append((limit.feed_at_bound(1.0, speed), exponent))
        else:
            others.append(limit)
    return FeedCaps(
        constant=constant,
        powers=tuple(powers),
        others=tuple(others),
        floor=floor,
        deepest=deepest,
        floors=tuple(floors),
        speed=speed,
    )
