"""TC against EC, QC, the program as given and a brute-force grid over passes and feeds.

Each workingstep of the sample parts is planned in eight materials. A grid tries 1 to 12 passes
(or twice as many as the plan has), each along its own path, with feeds every half per cent,
and keeps what keeps every limit. The plan and the three best numbers of passes of the grid are
also run on the virtual machine, where a rival counts if it keeps the bounds with the k_c at the
quantile of the plan, and leaves the stock that the program leaves. A ratio above 1 means that
the plan is beaten; the winner is named.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

from optimiser import optimise as advising
from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, Plan
from optimiser.bounds.plunge_feed import CLOSE, holding, plunge_limits, with_plunge_feed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.modes import Mode
from optimiser.planning.formulate import OptimisationTask, problem_of, state_of
from optimiser.planning.passes import AdviceContext, PassCountOptimum, best_of
from optimiser.solver.problem import ROUNDING, BoundSide, Limit, Problem, Setting
from optimiser.solver.workingstep import limits_at
from service.programs.advice_records import changes_of
from service.simulation.confirm import confirm
from service.simulation.confirmation import ConfirmedStep
from simulator.library import load_machine, match_material
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

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

RUN_WITHIN = 1.02
"""The same for times on the virtual machine."""

RUN_RIVALS = 3
"""Numbers of passes of the grid that are run for each workingstep, the best first."""

GridPoints = dict[int, "GridPoint"]
"""Best points of the grid by number of passes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival:
    """Another way to do a workingstep that keeps the same bounds."""

    name: str
    cost: float
    """Time, s, or energy, J."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GridPoint:
    """Best point of the grid in one number of passes, with the cut along its path."""

    cut: Cut
    state: EvaluatedSetting

    @property
    def time(self) -> float:
        """Time of the plan's own model, s."""
        return self.state.time

    @property
    def name(self) -> str:
        """Number of passes and feed."""
        setting = self.state.setting
        return f"grid: {setting.passes} passes, {setting.feed:.4g} mm/tooth"


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
    within: float = WITHIN
    """Cost over that of the best rival above which the plan counts as beaten."""
    measure: str = "plan"
    """Where the costs come from: the plan, or the run on the virtual machine."""

    @property
    def best(self) -> Rival:
        """Rival of the least cost."""
        return min(self.rivals, key=lambda rival: rival.cost)

    @property
    def ratio(self) -> float:
        """Cost over that of the best rival."""
        return self.cost / self.best.cost

    @property
    def is_beaten(self) -> bool:
        """True if a rival is better by more than the tolerance."""
        return self.ratio > self.within


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """Plans of a sample part in one material, and the grid for each of its workingsteps."""

    part: str
    material: str
    program: Program
    plans: dict[Mode, Plan]
    grids: dict[str, GridPoints]


def main(arguments: list[str] | None = None) -> None:
    """Print the ratios of each part and material, and the workingsteps that are beaten."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--materials", nargs="+", default=MATERIALS)
    parser.add_argument("--parts", nargs="+", default=[name for name, _ in SAMPLES])
    options = parser.parse_args(arguments)
    columns = "".join(f"{heading:>12}" for heading in ("TC / rival", "EC / rival", "TC run"))
    print(f"{'part':18}{'material':14}{'compared':>9}{columns}")
    beaten: list[Comparison] = []
    for name, machine in SAMPLES:
        for material in options.materials if name in options.parts else ():
            sample = sample_of(name, machine, material)
            planned, run = list(comparisons(sample)), list(run_comparisons(sample))
            worst = [
                max((each.ratio for each in group), default=0.0)
                for group in (
                    [each for each in planned if each.mode is Mode.TC],
                    [each for each in planned if each.mode is Mode.EC],
                    run,
                )
            ]
            figures = "".join(f"{ratio:12.4f}" for ratio in worst)
            print(f"{name:18}{material:14}{len(planned):9}{figures}", flush=True)
            beaten += [each for each in (*planned, *run) if each.is_beaten]
    for each in beaten:
        print(
            f"beaten in the {each.measure}: {each.part}, {each.material}, {each.workingstep}, "
            f"{each.mode}: {each.cost:.6g} by {each.best.name}: {each.best.cost:.6g}"
        )
    for measure, within in (("plan", WITHIN), ("run", RUN_WITHIN)):
        count = sum(each.measure == measure for each in beaten)
        print(
            f"workingsteps that a rival beats in the {measure} by more than "
            f"{100.0 * (within - 1.0):.2g} %: {count}"
        )


def sample_of(name: str, machine: str, material: str) -> Sample:
    """Plan a sample part in each mode, and try the grid for time."""
    program = Program(Part21File.from_bytes((PARTS / f"{name}.stpnc").read_bytes()), name=name)
    grids: dict[str, GridPoints] = {}
    return Sample(
        part=name,
        material=material,
        program=program,
        plans={
            Mode.TC: planned(program, machine, material, mode=Mode.TC, grids=grids),
            Mode.QC: planned(program, machine, material, mode=Mode.QC),
            Mode.EC: planned(program, machine, material, mode=Mode.EC),
        },
        grids=grids,
    )


def comparisons(sample: Sample) -> Iterator[Comparison]:
    """Workingsteps of a sample part whose feed is advised, beside their rivals."""
    for mode in (Mode.TC, Mode.EC):
        for advice in sample.plans[mode].advices:
            rivals = (
                *_programmed(advice, mode),
                *_of_modes(advice, mode, sample.plans),
                *_of_grid(mode, sample.grids.get(advice.workingstep.id, {})),
            )
            if advice.active is not None and advice.after is not None and rivals:
                yield Comparison(
                    part=sample.part,
                    material=sample.material,
                    workingstep=advice.workingstep.id,
                    mode=mode,
                    cost=_cost(advice.after, mode),
                    rivals=rivals,
                )


def run_comparisons(sample: Sample, *, most: int = RUN_RIVALS) -> Iterator[Comparison]:
    """Times of TC on the virtual machine, beside those of the best points of the grid.

    Parameters
    ----------
    sample : Sample
    most : int
        Greatest number of points of the grid that are run for each workingstep.
    """
    plan = sample.plans[Mode.TC]
    best = {
        step: sorted(points.values(), key=lambda point: point.time)[:most]
        for step, points in sample.grids.items()
    }
    run = _run(plan, sample.program)
    rivals: dict[str, list[Rival]] = {}
    for place in range(most):
        points = {step: each[place] for step, each in best.items() if place < len(each)}
        for step in _run(_with_points(plan, points), sample.program) if points else ():
            if step.id in points and _keeps_bounds(step):
                rival = Rival(name=points[step.id].name, cost=_time(step))
                rivals.setdefault(step.id, []).append(rival)
    for step in run:
        if step.is_advised and step.id in rivals:
            yield Comparison(
                part=sample.part,
                material=sample.material,
                workingstep=step.id,
                mode=Mode.TC,
                cost=_time(step),
                rivals=tuple(rivals[step.id]),
                within=RUN_WITHIN,
                measure="run",
            )


def _run(plan: Plan, program: Program) -> tuple[ConfirmedStep, ...]:
    """Figures of the workingsteps of a plan as the virtual machine runs it."""
    data = writeback.write(program, changes_of(plan), FileProfile.OPTIMISATION)
    advised = program.changed(Part21File.from_bytes(data, name=program.name))
    return confirm(plan, program, advised).steps


def _with_points(plan: Plan, points: dict[str, GridPoint]) -> Plan:
    """Plan that takes points of the grid for its advised workingsteps."""
    return replace(
        plan,
        advices=tuple(
            replace(advice, cut=point.cut, after=point.state)
            if advice.status is AdviceStatus.ADVISED
            and (point := points.get(advice.workingstep.id)) is not None
            else advice
            for advice in plan.advices
        ),
    )


def _keeps_bounds(step: ConfirmedStep) -> bool:
    """True if a run keeps the bounds, and leaves the stock that the program leaves."""
    is_other_stock = step.left is not None and step.left.is_seen
    return not is_other_stock and not any(figure.is_passed for figure in step.figures)


def _time(step: ConfirmedStep) -> float:
    """Time of a workingstep on the virtual machine, s."""
    return next(figure.simulated for figure in step.figures if figure.key == "time_s")


def planned(
    program: Program,
    machine: str,
    material: str,
    *,
    mode: Mode,
    grids: dict[str, GridPoints] | None = None,
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
            program,
            machine=load_machine(machine),
            material=match_material([material]),
            task=OptimisationTask(mode=mode, keep_going=True),
        )


def grid(
    cut: Cut, problem: Problem, asked: AdviceContext, found: PassCountOptimum
) -> GridPoints:
    """Fastest feed of the grid that keeps every limit, by number of passes."""
    given = problem.programmed
    points: GridPoints = {}
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
            state = state_of(timed, problem_of(timed, asked.at, asked.task), asked.at, tried)
            point = GridPoint(cut=timed, state=state)
            if best is not None and point.time >= best.time:
                break
            if _keeps_way_in(timed, asked.at, tried):
                best = point
                break
            if plunge is None:
                break
            plunge /= RAMP_STEP
        if setting is fastest and best is not None and best.state.setting == ideal:
            break
        setting = replace(setting, feed=setting.feed / RAMP_STEP)
    return best


def _keeps_way_in(cut: Cut, at: CuttingConditions, setting: Setting) -> bool:
    """True if the plunge feed keeps its limits as the axes run it."""
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
    """True if feed or depth can keep a limit; the speed is not free."""
    return limit.load.feed_exponent > 0.0 or limit.is_of_depth


def _cost(state: EvaluatedSetting, mode: Mode) -> float:
    """Time, s, or energy, J."""
    return state.energy if mode is Mode.EC else state.time


def _programmed(advice: Advice, mode: Mode) -> Iterator[Rival]:
    """The program as given, if it keeps the bounds; a speed may be below its window."""
    before = advice.before
    if before is not None and all(
        load.margin >= -ROUNDING
        for load in before.loads + before.plunge_loads
        if _is_kept(load.limit) or load.limit.sense is BoundSide.AT_MOST
    ):
        yield Rival(name="the program", cost=_cost(before, mode))


def _of_modes(advice: Advice, mode: Mode, plans: dict[Mode, Plan]) -> Iterator[Rival]:
    """The plans of the other modes."""
    for other, plan in plans.items():
        for each in plan.advices:
            is_same = each.workingstep.id == advice.workingstep.id
            if other is not mode and is_same and each.active and each.after is not None:
                passes = each.after.setting.passes
                yield Rival(name=f"{other} in {passes} passes", cost=_cost(each.after, mode))


def _of_grid(mode: Mode, points: GridPoints) -> Iterator[Rival]:
    """The best point of the grid."""
    best = min(points.values(), key=lambda point: _cost(point.state, mode), default=None)
    if best is not None:
        yield Rival(name=best.name, cost=_cost(best.state, mode))


if __name__ == "__main__":
    main()
