"""The limits at one spindle speed, reduced to what a number of passes still has to look at.

Without an offset a limit caps the feed at ``f = ((b/c)·n^(δ−γ))^(1/α) · a^(−β/α)``: one power
of the depth. Caps that do not depend on the depth are one number, however many there are.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf

from optimiser.limit import ROUNDING, Limit, Sense


@dataclass(frozen=True, slots=True, kw_only=True)
class Caps:
    """Greatest and least feed per tooth as functions of the depth."""

    constant: float
    """mm, the least of the caps that know no depth"""
    powers: tuple[tuple[float, float], ...]
    """(factor, exponent) of the caps that do"""
    others: tuple[Limit, ...]
    """limits that depend on the depth, but by no power of it"""
    floor: float
    """mm, the greatest of the limits from below that know no depth"""
    floors: tuple[Limit, ...]
    """limits from below that do"""
    deepest: float
    """mm, the greatest depth that the depth limits allow"""
    speed: float
    """rev/s"""

    def greatest(self, depth: float) -> float:
        """Greatest feed per tooth at a depth, mm; infinite when nothing caps it.

        Zero at a depth that is itself not allowed.
        """
        if depth > self.deepest * (1.0 + ROUNDING):
            return 0.0
        feed = self.constant
        for factor, exponent in self.powers:
            feed = min(feed, factor * depth**exponent)
        for limit in self.others:
            feed = min(feed, limit.feed_at_bound(depth, self.speed))
        return feed

    def least(self, depth: float) -> float:
        """Least feed per tooth at a depth, mm."""
        feed = self.floor
        for limit in self.floors:
            feed = max(feed, limit.feed_at_bound(depth, self.speed))
        return feed


def caps_at(limits: Iterable[Limit], speed: float) -> Caps:
    """Caps of all limits that bound the feed, at one spindle speed in rev/s."""
    constant, floor, deepest = inf, 0.0, inf
    powers: list[tuple[float, float]] = []
    others: list[Limit] = []
    floors: list[Limit] = []
    for limit in limits:
        load = limit.load
        if load.feed_exponent == 0.0:
            if limit.is_of_depth:
                deepest = min(deepest, limit.greatest_depth(speed))
            continue
        if limit.sense is Sense.AT_LEAST:
            if not load.knows_depth:
                floor = max(floor, limit.feed_at_bound(1.0, speed))
            else:
                floors.append(limit)
        elif not load.knows_depth:
            constant = min(constant, limit.feed_at_bound(1.0, speed))
        elif load.offset == 0.0 and load.curve is None:
            exponent = -load.depth_exponent / load.feed_exponent
            powers.append((limit.feed_at_bound(1.0, speed), exponent))
        else:
            others.append(limit)
    return Caps(
        constant=constant,
        powers=tuple(powers),
        others=tuple(others),
        floor=floor,
        deepest=deepest,
        floors=tuple(floors),
        speed=speed,
    )
