"""Feed of a mill on its way down into the material: the greatest that its limits allow.

Straight down the mill is a drill with flat lips: thrust, torque and power are those of a drill,
and the feed per tooth is a share of the catalogue feed, since near the axis the edges hardly
move: half if the edges reach the axis, a quarter if that is unknown.

On a ramp at the angle α the part ``f·sin α`` along the axis is a plunge, and the rest mills as
a pass does, at the engagement that is met. Time and energy fall with the feed, so at a given
spindle speed the best plunge feed is the least of its caps in every mode: a plunge leaves no
surface. The speed is chosen for the passes.

Whether a mill may plunge straight into solid material depends on its edges: edges that end
short of the axis leave a core that the end face presses on. ISO 14649-111 has no attribute for
this, so a tool table states it; for some tool bodies it follows from their form.

Best plunge feed where the axes already speed up for the pass at the end of a ramp.

A control rounds the change from the plunge feed to the feed of the pass over the time of its
filters, so that the end of a ramp is cut faster than programmed, and its loads depend on both
feeds. The load there, over its bound, is nearly linear in the plunge feed, since the speed is a
mean of both: a few steps of the secant method find the plunge feed that keeps it.

References
----------
.. [1] Fanar, general catalogue 2021, p. 329: 25 to 50 % of the table's feed on the way into the
   material.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import sqrt

from optimiser.bounds import loads
from optimiser.bounds.chip_load import catalogue_feed, least_chip
from optimiser.bounds.limits import (
    PLUNGE_FEED_RATIO,
    drill_point,
    force_factor,
    machine_limits,
    segment_at,
    spindle_limits,
    straight_down,
    tool_limits,
)
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.solver.problem import (
    SCALES_WITH_FORCE,
    BoundSide,
    Limit,
    LimitName,
    Monomial,
    Setting,
)
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.program import Program, ResolvedWorkingstep

CAUTIOUS_FEED_RATIO = 0.25
"""Feed per tooth in a straight plunge over the catalogue feed, if centre cutting is unknown,
[1]."""

DOWN_A_RAMP = "down the ramp"
"""Words added to the limits of a ramp to distinguish them from those of a pass."""


def plunge_limits(cut: Cut, at: CuttingConditions, speed: float) -> tuple[Limit, ...]:
    """Limits of the plunge feed at one spindle speed in rev/s; empty if nothing is met."""
    found = (*_straight(cut, at, speed), *_ramp(cut, at, speed))
    return tuple(
        limit.with_safety(at.safety_factor)
        for limit in found
        if limit.sense is BoundSide.AT_MOST and limit.load.feed_exponent > 0.0
    )


def holding(limits: tuple[Limit, ...], setting: Setting) -> Limit:
    """Return the limit that allows the least plunge feed."""
    return min(limits, key=lambda each: each.feed_at_bound(setting.depth, setting.speed))


def with_plunge_feed(cut: Cut, at: CuttingConditions, setting: Setting) -> Setting:
    """Add the greatest permitted plunge feed to a setting, if the cut has a plunge feed."""
    limits = plunge_limits(cut, at, setting.speed)
    if not limits:
        return setting
    best = holding(limits, setting).feed_at_bound(setting.depth, setting.speed)
    return replace(setting, plunge_feed=best)


def unloaded_plunge_feed(cut: Cut, at: CuttingConditions, setting: Setting) -> Setting:
    """Add a plunge feed to a setting that only limits of the feed itself bound."""
    limits = plunge_limits(cut, at, setting.speed)
    free = tuple(each for each in limits if each.name not in SCALES_WITH_FORCE)
    if not free:
        return setting
    best = holding(free, setting).feed_at_bound(setting.depth, setting.speed)
    return replace(setting, plunge_feed=best)


def _straight(cut: Cut, at: CuttingConditions, speed: float) -> Iterator[Limit]:
    """Limits of straight plunges of a mill."""
    if cut.way_in is None or not cut.way_in.drilled:
        return
    ratio = _feed_ratio(at) if cut.way_in.reaches_axis else 1.0
    yield straight_down(_feed_limit(cut, at, ratio=ratio, share=1.0))
    for drilled in cut.way_in.drilled:
        for limit in (*machine_limits(drilled, at), *_spindle_limits(drilled, at, speed)):
            yield straight_down(limit)


def _ramp(cut: Cut, at: CuttingConditions, speed: float) -> Iterator[Limit]:
    """Limits of a ramp: of its milling and of its motion along the axis."""
    if cut.way_in is None or cut.way_in.ramp is None:
        return
    ramp, sine = cut.way_in.ramp, cut.way_in.sine
    found = [*machine_limits(ramp, at), *tool_limits(ramp, at)]
    found += _spindle_limits(ramp, at, speed)
    if sine > 0.0:
        found.append(_feed_limit(cut, at, ratio=_feed_ratio(at), share=sine))
        found += _thrust_limits(cut, at, sine)
    for limit in found:
        yield replace(limit, label=f"{limit.words} {DOWN_A_RAMP}")


def _spindle_limits(cut: Cut, at: CuttingConditions, speed: float) -> tuple[Limit, ...]:
    return spindle_limits(cut, at, segment_at(at, speed))


def _feed_ratio(at: CuttingConditions) -> float:
    """Feed per tooth along the axis over the catalogue feed."""
    return PLUNGE_FEED_RATIO if at.centre_cutting else CAUTIOUS_FEED_RATIO


def permitted_plunge(cut: Cut, at: CuttingConditions) -> float | None:
    """Greatest feed per tooth of a mill along its axis, mm; None if no catalogue states one."""
    if cut.kind is not CutKind.MILLING:
        return None
    return _permitted(cut, at, ratio=_feed_ratio(at))


def _permitted(cut: Cut, at: CuttingConditions, *, ratio: float) -> float | None:
    """Share of the catalogue feed, but at least the feed against rubbing; None without one."""
    highest = catalogue_feed(cut, at)
    if highest is None:
        return None
    rubbing = least_chip(cut, at)
    return min(highest, max(ratio * highest, rubbing))


def _feed_limit(cut: Cut, at: CuttingConditions, *, ratio: float, share: float) -> Limit:
    """Limit on the feed per tooth along the axis, a share of the feed along the path.

    Without a catalogue feed, the programmed feed is the only one known to be safe. The
    reduction of the catalogue feed is a custom, not physics, so it must not fall below the
    rubbing limit.
    """
    borne = _permitted(cut, at, ratio=ratio)
    name = LimitName.PROGRAMMED_FEED if borne is None else LimitName.FEED_PER_TOOTH
    if borne is None:
        borne = share * (cut.programmed.plunge_feed or cut.programmed.feed)
    return Limit(
        name=name,
        load=Monomial(coefficient=share, feed_exponent=1.0),
        bound=borne,
        unit="mm",
        step=0.01,
        origin=f"{ratio:g} × the catalogue value along the axis" if ratio < 1.0 else "",
    )


def _thrust_limits(cut: Cut, at: CuttingConditions, sine: float) -> Iterator[Limit]:
    """Limit on the thrust of a plunge into solid material at the axial part of the feed."""
    if at.machine.max_cutting_force is None:
        return
    drill = cut.as_drill
    load = loads.thrust(drill, at.material.kienzle, force_factor(at), drill_point(at))
    yield Limit(
        name=LimitName.CUTTING_FORCE,
        label="thrust",
        load=loads.scaled(load, sine**load.feed_exponent),
        bound=at.machine.max_cutting_force,
        unit="N",
        step=100.0,
    )


RAMPS = "plunge_ramp, plunge_helix or plunge_zigzag"


def goes_into_solid(cut: Cut | None) -> bool:
    """True if a mill plunges straight into material under its axis."""
    if cut is None:
        return False
    return cut.plunge is not None or (cut.way_in is not None and cut.way_in.reaches_axis)


def plunge_fault(cut: Cut | None, at: CuttingConditions, *, is_allowed: bool) -> str:
    """Reason why a cut must not plunge straight down as it does; empty where it may."""
    if is_allowed or at.centre_cutting is not False or not goes_into_solid(cut):
        return ""
    return "plunges straight into solid material with a tool that does not cut over centre"


def plunge_findings(
    program: Program,
    step: ResolvedWorkingstep,
    cut: Cut | None,
    at: CuttingConditions,
    *,
    is_allowed: bool,
) -> list[Finding]:
    """Findings on plunges into solid material, with the same words for every unknown tool."""
    if cut is None or not goes_into_solid(cut):
        return []
    tool = f"tool '{cut.tool.id}'"
    if at.centre_cutting is None:
        text = (
            f"{tool} plunges straight into solid material; it is unknown whether it cuts over "
            f"centre: use a ramp ({RAMPS}) or set centre_cutting in a tool table"
        )
        return [program.finding(Severity.WARNING, text, step.tool_ref)]
    if at.centre_cutting:
        return []
    severity = Severity.WARNING if is_allowed else Severity.ERROR
    text = f"{tool} does not cut over centre, but plunges into solid material: use a ramp"
    return [program.finding(severity, f"{text} ({RAMPS})", step.operation_ref, "approach")]


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


def _next(before: PlungeOptimum | None, optimum: PlungeOptimum) -> float:
    """Plunge feed at which the excess is 1 by the secant; without one, the allowed feed."""
    feed = optimum.setting.plunge_feed or 0.0
    if before is not None and before.setting.plunge_feed is not None:
        way = before.setting.plunge_feed - feed
        rise = (before.excess - optimum.excess) / way
        if rise > 0.0:
            # A little below, so that the last step is not spent on rounding.
            return feed + (1.0 - 0.5 * CLOSE - optimum.excess) / rise
    return feed / optimum.excess


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
