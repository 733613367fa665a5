"""The best number of passes where a path in other passes is not what the closed form takes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import pytest

from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.source import CutSource
from optimiser.cuts.two_cores import Result
from optimiser.errors import Infeasible
from optimiser.modes import Free
from optimiser.planning.formulate import OptimisationTask, problem_of
from optimiser.planning.passes import (
    WORTH,
    AdviceContext,
    PassCountOptimum,
    PassCountSearch,
    best_of,
    untried_words,
)
from optimiser.solver.problem import Setting
from simulator.library import load_machine, load_material
from simulator.physics.engagement import full_immersion
from simulator.spec import CuttingMaterial, Kienzle, ToolKind
from stepnc_model.errors import Finding
from stepnc_model.programs.program import ResolvedWorkingstep
from stepnc_model.programs.tool import Tool

CUT = Cut(
    kind=CutKind.MILLING,
    tool=Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=18.0, teeth=4),
    tool_kind=ToolKind.ENDMILL,
    diameter=18.0,
    programmed=Setting(feed=0.05, depth=3.0, passes=4, speed=619.0 / 60.0),
    length=300.0,
    total_depth=12.0,
    is_depth_free=True,
    engagement=full_immersion(),
    rest_time=1.0,
)
AT = CuttingConditions(
    machine=load_machine("paper002"),
    material=replace(load_material("paper002"), max_feed_per_tooth=0.4),
    cutting_material=CuttingMaterial.HSS,
    grade=None,
    roughness=None,
)


class Ways:
    """A source whose path has another length in each number of passes."""

    def __init__(self, factors: dict[int, float]) -> None:
        self.factors = factors
        self.asked: list[int] = []
        self.made: list[int] = []
        """numbers of passes whose paths were timed and not tried"""

    def cut(self, _step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        return self.at(_step, CUT, CUT.programmed), []

    def at(self, _step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        self.asked.append(setting.passes)
        return replace(cut, length=300.0 * self.factors.get(setting.passes, 1.0))

    def timed(self, _step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        self.made.append(setting.passes)
        return replace(cut, length=300.0 * self.factors.get(setting.passes, 1.0))

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        raise NotImplementedError

    def map_workingsteps(
        self, steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
    ) -> Iterator[Result]:
        raise NotImplementedError


def best(source: CutSource, task: OptimisationTask, cut: Cut = CUT) -> PassCountOptimum:
    step: ResolvedWorkingstep = None  # type: ignore[assignment]
    asked = AdviceContext(step=step, at=AT, task=task, cuts=source)
    return best_of(cut, problem_of(cut, AT, task), asked)


def test_passes_that_are_alike_are_told_by_the_closed_form() -> None:
    """Power is in proportion to feed times depth: only the rest counts, so one pass."""
    told = best(Ways({}), OptimisationTask())
    assert told.optimum.solution.setting.passes == 1


def test_a_proposal_that_turns_out_longer_is_refused() -> None:
    """One pass is proposed; its path is five times as long, and the programmed four stay."""
    source = Ways(dict.fromkeys((1, 2, 3), 5.0))
    told = best(source, OptimisationTask())
    setting = told.optimum.solution.setting
    assert setting.passes == 4
    assert source.asked[-1] == 4
    assert told.problem.cost.length == pytest.approx(300.0)


def test_time_is_that_of_the_path_at_the_advice() -> None:
    told = best(Ways({1: 1.003}), OptimisationTask())
    solution = told.optimum.solution
    feed = 4.0 * solution.setting.feed * solution.setting.speed
    assert solution.setting.passes == 1
    assert solution.time == pytest.approx(300.9 / feed + 1.0)


def test_a_depth_that_is_not_free_is_told_once() -> None:
    source = Ways({})
    told = best(source, OptimisationTask(free=frozenset({Free.FEED})))
    assert told.optimum.solution.setting.passes == 4
    assert set(source.asked) == {4}


def test_a_programmed_number_that_breaks_a_limit_is_left() -> None:
    """Four passes are too deep for the edge; the first feasible number is taken."""
    short = replace(CUT, depth_bound=2.0)
    assert best(Ways({}), OptimisationTask(), short).optimum.solution.setting.passes == 6


def test_no_number_of_passes_is_infeasible() -> None:
    short = replace(CUT, depth_bound=0.01)
    with pytest.raises(Infeasible):
        best(Ways({}), OptimisationTask(), short)
    with pytest.raises(Infeasible):
        best(Ways({}), OptimisationTask(free=frozenset({Free.FEED})), short)


def test_prices_come_with_tools_that_wear_out() -> None:
    told = best(Ways({}), OptimisationTask(tool_change=10.0, free=frozenset(Free)))
    assert told.optimum.solution.setting.feed > 0.0


def thin_chips(k_c11: float) -> CuttingConditions:
    """Conditions in which thin chips are dear, so that many passes compete."""
    kienzle = Kienzle(k_c11=k_c11, m_c=0.3)
    steel = replace(AT.material, kienzle=kienzle, max_feed_per_tooth=2.0)
    return replace(AT, material=steel)


def best_from(
    source: Ways, programmed: int, task: OptimisationTask, rest: float = 40.0
) -> PassCountOptimum:
    """The best number of passes from a programmed one, with seconds between passes."""
    at = thin_chips(2000.0)
    given = replace(CUT.programmed, passes=programmed, depth=12.0 / programmed)
    cut = replace(CUT, rest_time=rest, programmed=given)
    step: ResolvedWorkingstep = None  # type: ignore[assignment]
    asked = AdviceContext(step=step, at=at, task=task, cuts=source)
    return best_of(cut, problem_of(cut, at, task), asked)


@pytest.mark.parametrize("programmed", [1, 4, 13, 60])
@pytest.mark.parametrize("factors", [{}, {13: 5.0}, {12: 1.2, 13: 1.2, 14: 1.2}, {5: 0.5}])
def test_no_number_beats_the_best(programmed: int, factors: dict[int, float]) -> None:
    """Each number of passes, held and along its own path, takes as long or longer.

    Where the levels of a search do not reach to one that does not, it is told.
    """
    told = best_from(Ways(factors), programmed, OptimisationTask())
    fixed = OptimisationTask(free=frozenset({Free.FEED}))
    for passes in set(range(1, 41)) - set(told.untried):
        held = best_from(Ways(factors), passes, fixed)
        least = held.optimum.solution.time
        assert (1.0 - WORTH) * told.optimum.solution.time <= least


def test_few_paths_are_tried() -> None:
    """Of 120 numbers of passes."""
    source = Ways({})
    best_from(source, 4, OptimisationTask())
    assert len(set(source.asked)) < 15


def test_numbers_beyond_the_levels_of_a_search_are_told() -> None:
    """Nearly a hundred passes promise the least; two such paths are too many."""
    at, cut = thin_chips(2e4), replace(CUT, rest_time=60.0)
    step: ResolvedWorkingstep = None  # type: ignore[assignment]
    asked = AdviceContext(step=step, at=at, task=OptimisationTask(), cuts=Ways({}))
    told = best_of(cut, problem_of(cut, at, asked.task), asked)
    passes = told.optimum.solution.setting.passes
    assert 80 < passes < 96
    assert {passes - 1, passes + 1} <= set(told.untried)
    assert passes not in told.untried
    (words,) = untried_words(told.untried, passes)
    assert "passes were not tried" in words


def test_of_numbers_that_cost_nearly_the_same_the_fewest_are_taken() -> None:
    """Ten passes are 0.3 % longer than twelve: less than a plan knows of its time."""
    fixed = OptimisationTask(free=frozenset({Free.FEED}))

    def held(passes: int, factor: float) -> PassCountOptimum:
        return best_from(Ways({passes: factor}), passes, fixed)

    def found_in(seconds: float) -> PassCountOptimum:
        one, two = (held(10, factor).optimum.solution.time for factor in (1.0, 2.0))
        return held(10, 1.0 + (seconds - one) / (two - one))

    many = held(12, 1.0)
    least = many.optimum.solution.time
    step: ResolvedWorkingstep = None  # type: ignore[assignment]
    asked = AdviceContext(step=step, at=thin_chips(2000.0), task=fixed, cuts=Ways({}))

    def search(few: PassCountOptimum) -> PassCountSearch:
        return PassCountSearch(cut=CUT, context=asked, optima={10: few, 12: many})

    near, far = found_in(1.003 * least), found_in(1.006 * least)
    assert search(near).chosen(4) == 10
    assert search(near).chosen(12) == 12
    assert search(far).chosen(4) == 12
    assert search(far).chosen(10) == 12
