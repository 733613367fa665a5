"""TC against EC, QC, the program as given and a brute-force grid over passes and feeds.

Each workingstep of the sample parts is planned in eight materials. A grid tries 1 to 12 passes
(or twice as many as the plan has), each along its own path, with feeds every half per cent,
and keeps what keeps every limit. A ratio above 1 means that the plan is beaten; the winner is
named.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

from optimiser import optimise as advising
from optimiser.advice import Advice, Plan
from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.formulate import OptimisationTask, problem_of
from optimiser.modes import Mode
from optimiser.passes import AdviceContext, PassCountOptimum, best_of
from optimiser.plunge_feed import holding, plunge_limits, with_plunge_feed
from optimiser.plunge_search import CLOSE
from optimiser.problem import ROUNDING, BoundSide, Limit, Problem, Setting
from optimiser.workingstep import limits_at
from simulator.library import load_machine
from simulator.matching import match_material
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program

PARTS = Path(__file__).parents[1] / "examples" / "parts"
SAMPLES = (
    ("bracket", "vmc15"),
    ("paper002", "vmc15"),
    ("paper003_case1", "vmc15"),
    ("paper003_case2", "vmc15"),
    ("paper003_pocket", "vmc15"),
    ("shaft", "lathe22"),
)
MATERIALS = (
    "c45",
    "42crmo4",
    "aisi304",
    "gg25",
    "al6061",
    "ti6al4v",
    "inconel718",
    "h13",
)

MOST_PASSES = 12
"""Least number of passes up to which the grid goes."""

FEED_STEP = 1.005
"""Ratio of neighbouring feeds of the grid."""

RAMP_STEP = 1.02
"""Ratio of neighbouring feeds where a ramp and its pass depend on each other."""

LEAST_OF_RAMP = 0.2
"""Least feed of that grid over the greatest."""

FEED_SPAN = 100.0
"""Greatest feed of the grid over the programmed one, and the programmed one over the least."""

WITHIN = 1.005
"""Cost of the plan over that of its best rival above which the plan counts as beaten."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival:
    """Another way to do a workingstep that keeps the same bounds."""

    name: str
    cost: float
    """Time, s, or energy, J."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GridPoint:
    """Best point of the grid in one number of passes."""

    setting: Setting
    time: float
    energy: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Plan of a workingstep beside its rivals."""

    part: str
    material: str
    workingstep: str
    mode: Mode
    cost: float
    """Time of TC, s, or energy of EC, J."""
    rivals: tuple[Rival, ...]

    @property
    def best(self) -> Rival:
        """Rival of the least cost."""
        return min(self.rivals, key=lambda rival: rival.cost)

    @property
    def is_beaten(self) -> bool:
        """Whether a rival is better by more than the grid's tolerance."""
        return self.cost > WITHIN * self.best.cost


def main(arguments: list[str] | None = None) -> None:
    """Print the ratios of each part and material, and the workingsteps that are beaten."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--materials", nargs="+", default=MATERIALS)
    parser.add_argument("--parts", nargs="+", default=[name for name, _ in SAMPLES])
    options = parser.parse_args(arguments)
    print(f"{'part':18}{'material':14}{'compared':>9}{'TC / rival':>12}{'EC / rival':>12}")
    beaten: list[Comparison] = []
    for name, machine in SAMPLES:
        for material in options.materials if name in options.parts else ():
            found = list(comparisons(name, machine, material))
            worst = {
                mode: max(
                    (each.cost / each.best.cost for each in found if each.mode is mode),
                    default=0.0,
                )
                for mode in (Mode.TC, Mode.EC)
            }
            print(
                f"{name:18}{material:14}{len(found):9}"
                f"{worst[Mode.TC]:12.4f}{worst[Mode.EC]:12.4f}",
                flush=True,
            )
            beaten += [each for each in found if each.is_beaten]
    for each in beaten:
        print(
            f"beaten: {each.part}, {each.material}, {each.workingstep}, {each.mode}: "
            f"{each.cost:.6g} by {each.best.name}: {each.best.cost:.6g}"
        )
    print(f"workingsteps that a rival beats by more than 0.5 %: {len(beaten)}")


def comparisons(name: str, machine: str, material: str) -> Iterator[Comparison]:
    """Workingsteps of a sample part whose feed is advised, beside their rivals."""
    grids: dict[str, dict[int, GridPoint]] = {}
    plans = {
        Mode.TC: planned(name, machine, material, mode=Mode.TC, grids=grids),
        Mode.QC: planned(name, machine, material, mode=Mode.QC),
        Mode.EC: planned(name, machine, material, mode=Mode.EC),
    }
    for mode in (Mode.TC, Mode.EC):
        for advice in plans[mode].advices:
            rivals = (
                *_programmed(advice, mode),
                *_of_modes(advice, mode, plans),
                *_of_grid(advice, mode, grids.get(advice.workingstep.id, {})),
            )
            if advice.active is not None and advice.after is not None and rivals:
                yield Comparison(
                    part=name,
                    material=material,
                    workingstep=advice.workingstep.id,
                    mode=mode,
                    cost=_cost(advice.after.time, advice.after.energy, mode),
                    rivals=rivals,
                )


def planned(
    name: str,
    machine: str,
    material: str,
    *,
    mode: Mode,
    grids: dict[str, dict[int, GridPoint]] | None = None,
) -> Plan:
    """Plan of a sample part; a grid is tried for each workingstep if its place is given."""

    def with_grid(cut: Cut, problem: Problem, asked: AdviceContext) -> PassCountOptimum:
        found = best_of(cut, problem, asked)
        if grids is not None:
            grids[asked.step.id] = grid(cut, problem, asked, found)
            asked.cuts.at(asked.step, found.cut, found.optimum.solution.setting)
        return found

    with patch.object(advising, "best_of", with_grid):
        return advising.optimise_program(
            Program(Part21File.from_bytes((PARTS / f"{name}.stpnc").read_bytes()), name=name),
            machine=load_machine(machine),
            material=match_material([material]),
            task=OptimisationTask(mode=mode, keep_going=True),
        )


def grid(
    cut: Cut, problem: Problem, asked: AdviceContext, found: PassCountOptimum
) -> dict[int, GridPoint]:
    """Fastest feed of the grid that keeps every limit, by number of passes."""
    given, points = problem.programmed, {}
    low, high = problem.passes
    most = max(MOST_PASSES, 2 * found.optimum.solution.setting.passes)
    for passes in range(low, min(high, most) + 1) if low < high else (given.passes,):
        depth = given.depth if passes == given.passes else problem.depth_at(passes)
        tried = asked.cuts.at(asked.step, cut, replace(given, passes=passes, depth=depth))
        there = problem_of(tried, asked.at, asked.task)
        speed = there.speeds[0]
        feed = _fastest(limits_at(there, speed), given.feed, depth=depth, speed=speed)
        if feed is None:
            continue
        point = _best_ramp(
            tried, Setting(feed=feed, depth=depth, passes=passes, speed=speed), asked
        )
        if point is not None:
            points[passes] = point
    return points


def _best_ramp(cut: Cut, fastest: Setting, asked: AdviceContext) -> GridPoint | None:
    """Best point of the grid over feeds and plunge feeds that keeps the limits of the way in.

    Where the axes speed up for the pass before a ramp ends, its limits depend on both feeds.
    """
    best: GridPoint | None = None
    setting = fastest
    while setting.feed > LEAST_OF_RAMP * fastest.feed:
        ideal = with_plunge_feed(cut, asked.at, setting)
        plunge, least = ideal.plunge_feed, LEAST_OF_RAMP * (ideal.plunge_feed or 0.0)
        while plunge is None or plunge > least:
            tried = replace(setting, plunge_feed=plunge)
            timed = asked.cuts.at(asked.step, cut, tried)
            cost = problem_of(timed, asked.at, asked.task).cost
            point = GridPoint(setting=tried, time=cost.time(tried), energy=cost.energy(tried))
            if best is not None and point.time >= best.time:
                break
            if _keeps_way_in(timed, asked.at, tried):
                best = point
                break
            if plunge is None:
                break
            plunge /= RAMP_STEP
        if setting is fastest and best is not None and best.setting == ideal:
            break
        setting = replace(setting, feed=setting.feed / RAMP_STEP)
    return best


def _keeps_way_in(cut: Cut, at: CuttingConditions, setting: Setting) -> bool:
    """Whether the plunge feed keeps its limits as the axes run it."""
    limits, plunge = plunge_limits(cut, at, setting.speed), setting.plunge_feed
    if plunge is None or not limits:
        return True
    allowed = holding(limits, setting).feed_at_bound(setting.depth, setting.speed)
    return plunge <= (1.0 + CLOSE) * allowed


def _fastest(
    limits: Sequence[Limit], programmed: float, *, depth: float, speed: float
) -> float | None:
    """Greatest feed of the grid that keeps every limit; None if none does."""
    feed, best = programmed / FEED_SPAN, None
    # A curve of the depth takes time; the depth is the same for all feeds.
    limits = [
        limit if limit.load.curve is None else limit.at_depth(depth)
        for limit in limits
        if _is_kept(limit)
    ]
    while feed <= programmed * FEED_SPAN:
        if all(limit.holds(feed, depth, speed) for limit in limits):
            best = feed
        feed *= FEED_STEP
    return best


def _is_kept(limit: Limit) -> bool:
    """Whether feed or depth can keep a limit; the speed is not free."""
    return limit.load.feed_exponent > 0.0 or limit.is_of_depth


def _cost(time: float, energy: float, mode: Mode) -> float:
    return energy if mode is Mode.EC else time


def _programmed(advice: Advice, mode: Mode) -> Iterator[Rival]:
    """The program as given, if it keeps the bounds; a speed may be below its window."""
    before = advice.before
    if before is not None and all(
        load.margin >= -ROUNDING
        for load in before.loads + before.plunge_loads
        if _is_kept(load.limit) or load.limit.sense is BoundSide.AT_MOST
    ):
        yield Rival(name="the program", cost=_cost(before.time, before.energy, mode))


def _of_modes(advice: Advice, mode: Mode, plans: dict[Mode, Plan]) -> Iterator[Rival]:
    """The plans of the other modes."""
    for other, plan in plans.items():
        for each in plan.advices:
            is_same = each.workingstep.id == advice.workingstep.id
            if other is not mode and is_same and each.active and each.after is not None:
                cost = _cost(each.after.time, each.after.energy, mode)
                yield Rival(name=f"{other} in {each.after.setting.passes} passes", cost=cost)


def _of_grid(advice: Advice, mode: Mode, points: dict[int, GridPoint]) -> Iterator[Rival]:
    """The best point of the grid."""
    costs = {passes: _cost(point.time, point.energy, mode) for passes, point in points.items()}
    if costs:
        passes = min(costs, key=lambda each: costs[each])
        feed = points[passes].setting.feed
        yield Rival(name=f"grid: {passes} passes, {feed:.4g} mm/tooth", cost=costs[passes])


if __name__ == "__main__":
    main()
