"""Best plunge feed where the axes already speed up for the pass at the end of a ramp.

A control rounds the change from the plunge feed to the feed of the pass over the time of its
filters, so that the end of a ramp is cut faster than programmed, and its loads depend on both
feeds. The load there, over its bound, is nearly linear in the plunge feed, since the speed is a
mean of both: a few steps of the secant method find the plunge feed that keeps it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import sqrt

from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.plunge_feed import holding, plunge_limits, with_plunge_feed
from optimiser.problem import Limit, LimitName, Monomial, Setting

ROUNDS = 8
"""Greatest number of plunge feeds tried for one feed along the pass."""

CLOSE = 1e-3
"""Relative excess over a bound within which the search ends."""

LEAST_SHARE = 0.1
"""Least share of the plunge feed without the pass; below it the pass must be slower."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlungeOptimum:
    """Setting with its plunge feed, and the cut along its path."""

    cut: Cut
    setting: Setting
    excess: float
    """Plunge feed over that which the limits at this setting allow; above 1 where the feed of
    the pass alone exceeds them."""
    limit: Limit | None
    """Limit that allows least; None without a plunge feed."""
    balanced_feed: float | None = None
    """Feed per tooth of the passes with which ramp and passes together take least time, mm;
    None where the greatest feed does."""


def best_plunge(
    cut: Cut, at: CuttingConditions, setting: Setting, timed: Callable[[Cut, Setting], Cut]
) -> PlungeOptimum:
    """Find the greatest plunge feed whose loads keep their bounds along the path.

    Parameters
    ----------
    cut : Cut
    at : CuttingConditions
    setting : Setting
        Setting of the passes.
    timed : callable
        Returns the cut as the axes run it at a setting.
    """
    found = _greatest(cut, at, setting, timed)
    given, plunge = cut.programmed.plunge_feed, found.setting.plunge_feed
    if given is None or plunge is None or abs(given / plunge - 1.0) > CLOSE:
        return found
    # The search begins at another feed in a second run, and ends a little beside the first.
    kept = _tried(found.cut, at, replace(found.setting, plunge_feed=given), timed)
    if kept.excess > 1.0 + CLOSE:
        return found
    return replace(kept, balanced_feed=found.balanced_feed)


def _greatest(
    cut: Cut, at: CuttingConditions, setting: Setting, timed: Callable[[Cut, Setting], Cut]
) -> PlungeOptimum:
    """Greatest plunge feed that keeps its bounds, by the secant method."""
    found = _tried(cut, at, with_plunge_feed(cut, at, setting), timed)
    first = found.setting.plunge_feed
    if first is None:
        return found
    before: PlungeOptimum | None = None
    for _ in range(ROUNDS):
        feed = found.setting.plunge_feed or first
        if found.excess <= 1.0 + CLOSE or feed <= LEAST_SHARE * first:
            break
        lower = max(_next(before, found), LEAST_SHARE * first)
        before = found
        found = _tried(found.cut, at, replace(setting, plunge_feed=lower), timed)
    if before is None:
        return found
    return replace(found, balanced_feed=_balanced_feed(before, found))


def _balanced_feed(one: PlungeOptimum, other: PlungeOptimum) -> float | None:
    """Feed of the passes at which slowing them saves as much on the ramp as it costs.

    With the excess ``A·f + B·p`` of a pass at the feed f after a ramp at the feed p, bounded by
    1, the time ``L/f + R/p`` is least where ``p/f = √(R·A/(L·B))``. Two plunge feeds at one f
    give A, B and the length R of the ramp.
    """
    feed, turns = one.setting.feed, one.cut.tool.teeth * one.setting.speed
    fast, slow = one.setting.plunge_feed or 0.0, other.setting.plunge_feed or 0.0
    if fast <= slow or slow <= 0.0:
        return None
    of_plunge = (one.excess - other.excess) / (fast - slow)
    of_pass = (other.excess - of_plunge * slow) / feed
    passes = one.setting.passes
    longer = passes * (other.cut.rest_time - one.cut.rest_time)
    ramp = longer * turns / (1.0 / slow - 1.0 / fast)
    length = passes * one.cut.length
    if min(of_plunge, of_pass, ramp, length) <= 0.0:
        return None
    ratio = sqrt(ramp * of_pass / (length * of_plunge))
    # Along the ramp itself p bears no more than where f = p.
    balanced = 1.0 / (of_plunge * min(ratio, 1.0) + of_pass)
    return balanced if balanced < feed * (1.0 - CLOSE) else None


def _tried(
    cut: Cut, at: CuttingConditions, setting: Setting, timed: Callable[[Cut, Setting], Cut]
) -> PlungeOptimum:
    """Time a cut at a plunge feed and compare the feed with what its limits allow."""
    cut = timed(cut, setting)
    limits = plunge_limits(cut, at, setting.speed)
    if setting.plunge_feed is None or not limits:
        return PlungeOptimum(cut=cut, setting=setting, excess=1.0, limit=None)
    limit = holding(limits, setting)
    allowed = limit.feed_at_bound(setting.depth, setting.speed)
    excess = setting.plunge_feed / allowed
    return PlungeOptimum(cut=cut, setting=setting, excess=excess, limit=limit)


def _next(before: PlungeOptimum | None, found: PlungeOptimum) -> float:
    """Plunge feed at which the excess is 1 by the secant; without one, the allowed feed."""
    feed = found.setting.plunge_feed or 0.0
    if before is not None and before.setting.plunge_feed is not None:
        way = before.setting.plunge_feed - feed
        rise = (before.excess - found.excess) / way
        if rise > 0.0:
            # A little below, so that the last step is not spent on rounding.
            return feed + (1.0 - 0.5 * CLOSE - found.excess) / rise
    return feed / found.excess


def at_foot(limit: Limit, feed: float) -> Limit:
    """Limit on the feed of a pass whose speed reaches back into the ramp before it."""
    return Limit(
        name=LimitName.FEED_PER_TOOTH,
        label="feed per tooth after the ramp",
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=feed,
        unit="mm",
        step=0.01,
        origin=f"where the axes speed up at the end of the ramp: {limit.words}",
    )
