"""Lower bounds on the cost of a workingstep in a number of passes whose path was not tried.

A path that was tried in the stock says three things about every other number of passes:

* *Its way.* The path in the other number of passes is made and timed with the machine's axes,
  at a feed that it cannot exceed. What it does beside the cut (ramps, rapids, links) counts in
  full. Only the contact with the stock, which takes most of the time, is not worked out.
* *Fewer passes* are deeper, and no load falls with the depth: they permit no more feed than the
  path that was tried does.
* *More passes* are shallower. Each of their levels follows the same outline, so that the tool
  comes to the place that was hardest in the deeper pass, now at the smaller depth. There may be
  a harder place still. Stock that was left above the hardest place does not count.

Loads count with :data:`SLACK` less, for stations of two paths do not fall on the same places,
and if the levels of the two paths differ in length, loads that know the depth do not count.
Limits of the feed alone, as of tool and feed drives, hold in any number of passes. Units: mm,
s, J.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import inf

from optimiser.bounds.plunge_feed import unloaded_plunge_feed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import CriticalPlace, Cut
from optimiser.errors import Infeasible
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import OptimisationTask, problem_of
from optimiser.solver import workingstep as exact
from optimiser.solver.problem import BoundSide, Cost, Limit, LimitName, Problem, Setting

SLACK = 1.1
"""Factor on the bounds of loads that are taken over from another path.

On the sample parts in four materials, loads at the hardest place of a deeper pass exceed those
of shallower passes by less than 1 % (``python -m benchmarks.least_time``).
"""

ALIKE = 0.9
"""Least ratio of the lengths of one pass at which levels count as alike."""

SAME_VOLUME = 0.98
"""Least ratio of the volumes that two paths remove at which their levels count as alike."""

KEPT = frozenset({
    LimitName.PROGRAMMED_FEED, LimitName.AXIAL_DEPTH, LimitName.LEAST_COST,
})  # fmt: skip
"""Limits that are no loads; a feed other than the cheapest would cost more than the bound."""

HALF = 0.5
"""Ratio of the lengths of one pass that no path falls below, where levels are not alike.

Where walls lean, a tool does not fit into the lowest levels, so that passes are left out.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PassCountBounds:
    """Lower bounds on the cost of other numbers of passes, from one path that was tried."""

    passes: int
    """Number of passes of the path that was tried."""
    cut: Cut
    task: OptimisationTask
    at: CuttingConditions
    problem: Problem
    """Problem of the path without the stock that was left above its hardest places."""
    settings: dict[tuple[int, bool], Setting | None] = field(default_factory=dict)
    """Best settings of relaxed problems, by number of passes and whether levels are alike."""

    def shortest(self, *, is_alike: bool) -> Problem:
        """Problem with shorter levels than those tried, and nothing beside the cut."""
        cost = self.problem.cost
        length = (ALIKE if is_alike else HALF) * cost.length
        return replace(self.problem, cost=replace(cost, length=length, link_time=0.0))

    def at_least(self, passes: int, *, is_alike: bool) -> float:
        """Least cost in a number of passes, s or J; infinite where none is feasible.

        The path is not made: its levels count as shorter than those that were tried, and what
        it does beside the cut as nothing.
        """
        setting = self._best(passes, is_alike=is_alike)
        if setting is None:
            return inf
        return self._cost(self.shortest(is_alike=is_alike).cost, setting)

    def estimate(self, passes: int) -> float:
        """Cost in a number of passes that are like those that were tried, s or J.

        It is no bound; it is infinite where none is feasible.
        """
        setting = self._best(passes, is_alike=True)
        return inf if setting is None else self._cost(self.problem.cost, setting)

    def along(
        self, passes: int, timed: Callable[[Cut, Setting], Cut], *, is_alike: bool
    ) -> float:
        """Least cost along the path in a number of passes, s or J, without its contacts.

        Parameters
        ----------
        passes : int
        timed : callable
            Returns a cut with length and time of that path at a setting.
        is_alike : bool
            Whether the levels of all paths that were tried are alike.
        """
        setting = self._best(passes, is_alike=is_alike)
        if setting is None:
            return inf
        cut = timed(self.cut, self._with_plunge(setting))
        if is_alike and not are_alike((cut, self.cut)):
            return self.along(passes, timed, is_alike=False)
        task = replace(self.task, tool_change=0.0)
        return self._cost(problem_of(cut, self.at, task).cost, setting)

    def _best(self, passes: int, *, is_alike: bool) -> Setting | None:
        """Best setting under relaxed limits; None where even these have none."""
        key = passes, is_alike
        if key not in self.settings:
            try:
                relaxed = self._relaxed(passes, is_alike=is_alike)
                self.settings[key] = exact.solve(relaxed, self.task.mode).setting
            except Infeasible:
                self.settings[key] = None
        return self.settings[key]

    def _relaxed(self, passes: int, *, is_alike: bool) -> Problem:
        """Problem whose limits other numbers of passes cannot do without."""
        problem = self.problem
        given = replace(problem.programmed, passes=passes, depth=problem.depth_at(passes))
        known = None
        if passes < self.passes:
            known = self.cut.total_depth / self.passes

        def relaxed(limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
            return tuple(_relaxed_limits(limits, depth=known, is_alike=is_alike))

        return replace(
            problem,
            limits=relaxed(problem.limits),
            stretches=tuple(map(relaxed, problem.stretches)),
            passes=(passes, passes),
            programmed=given,
        )

    def _with_plunge(self, setting: Setting) -> Setting:
        """Setting with a plunge feed that no load bounds."""
        if Free.FEED not in self.task.free:
            return replace(setting, plunge_feed=self.cut.programmed.plunge_feed)
        return unloaded_plunge_feed(self.cut, self.at, setting)

    def _cost(self, cost: Cost, setting: Setting) -> float:
        """Time, or energy with the least work of the chips, at a setting.

        The same material is cut in any number of passes. Its work per volume falls with the
        feed, and does not fall when passes become shallower and chips thinner.
        """
        if self.task.mode is Mode.CC:
            return cost.money(setting)
        if self.task.mode is not Mode.EC:
            return cost.time(setting)
        own = self.problem.cost
        here = replace(setting, passes=self.passes, depth=self.cut.total_depth / self.passes)
        power = own.motor_power.value(here.feed, here.depth, here.speed)
        work = power * own.cutting_time(here) if setting.passes > self.passes else 0.0
        idle = cost.standby_power_per_speed * setting.speed * cost.cutting_time(setting)
        return cost.standby_power * cost.time(setting) + idle + work / SLACK


def bounds_of(
    cut: Cut, at: CuttingConditions, task: OptimisationTask, *, passes: int
) -> PassCountBounds:
    """Lower bounds on the cost of other numbers of passes, from a path that was tried."""
    bare = replace(
        cut, depth_share=1.0, shank=_without_rest(cut.shank), wall=_without_rest(cut.wall)
    )
    # Worn tools only add to the cost.
    problem = problem_of(bare, at, replace(task, tool_change=0.0))
    return PassCountBounds(passes=passes, cut=cut, at=at, task=task, problem=problem)


def are_alike(cuts: Sequence[Cut]) -> bool:
    """True if the levels of paths are alike: in length, and in the volume of them all."""
    lengths = [cut.length for cut in cuts]
    volumes = [cut.volume for cut in cuts if cut.volume is not None]
    return ALIKE * max(lengths) <= min(lengths) and (
        not volumes or SAME_VOLUME * max(volumes) <= min(volumes)
    )


def _without_rest(place: CriticalPlace | None) -> CriticalPlace | None:
    """Critical place without stock that was left above it."""
    return None if place is None else replace(place, depth_share=1.0)


def _relaxed_limits(
    limits: tuple[Limit, ...], *, depth: float | None, is_alike: bool
) -> Iterator[Limit]:
    """Limits with the slack of a path that was not tried.

    Parameters
    ----------
    depth : float, mm
        Depth at which loads count, for passes that are deeper than it; None: at their own.
    is_alike : bool
        Whether levels are alike, so that loads count at all.
    """
    for limit in limits:
        if limit.name in KEPT:
            yield limit
        elif limit.sense is BoundSide.AT_LEAST:
            yield replace(limit, bound=limit.bound / SLACK)
        elif not limit.load.knows_depth:
            yield limit
        elif is_alike:
            looser = replace(limit, bound=limit.bound * SLACK)
            is_deeper = depth is not None and limit.load.feed_exponent > 0.0
            yield looser.at_depth(depth) if is_deeper and depth is not None else looser
