"""The best number of passes where a path in other passes is not what the closed form takes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import pytest

from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut, CutKind
from optimiser.errors import Infeasible
from optimiser.formulate import OptimisationTask, problem_of
from optimiser.modes import Free
from optimiser.passes import AdviceContext, PassCountOptimum, best_of
from optimiser.problem import Setting
from optimiser.side_by_side import Result
from optimiser.source import CutSource
from simulator.library import load_machine, load_material
from simulator.physics.engagement import full_immersion
from simulator.spec import CuttingMaterial, Kienzle, ToolKind
from stepnc_model.errors import Finding
from stepnc_model.program import ResolvedWorkingstep
from stepnc_model.tool import Tool

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

    def cut(self, _step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        return self.at(_step, CUT, CUT.programmed), []

    def at(self, _step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        self.asked.append(setting.passes)
        return replace(cut, length=300.0 * self.factors.get(setting.passes, 1.0))

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        raise NotImplementedError

    def each(
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
    told = best(Ways({1: 1.005}), OptimisationTask())
    solution = told.optimum.solution
    feed = 4.0 * solution.setting.feed * solution.setting.speed
    assert solution.setting.passes == 1
    assert solution.time == pytest.approx(301.5 / feed + 1.0)


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


def asked_of(source: Ways, programmed: int, *, k_c11: float, rest: float) -> set[int]:
    """Numbers of passes whose paths were made; with Kienzle's exponent thin chips are dear."""
    steel = replace(AT.material, kienzle=Kienzle(k_c11=k_c11, m_c=0.3), max_feed_per_tooth=2.0)
    at = replace(AT, material=steel)
    given = replace(CUT.programmed, passes=programmed, depth=12.0 / programmed)
    cut = replace(CUT, rest_time=rest, programmed=given)
    step: ResolvedWorkingstep = None  # type: ignore[assignment]
    asked = AdviceContext(step=step, at=at, task=OptimisationTask(), cuts=source)
    told = best_of(cut, problem_of(cut, at, asked.task), asked)
    assert told.optimum.solution.setting.passes in source.asked
    return set(source.asked)


def test_a_path_that_cannot_be_the_best_by_its_own_promise_is_not_made() -> None:
    """Thirteen turn out five times as long; from there forty promise more time than four."""
    source = Ways({13: 5.0})
    assert asked_of(source, 4, k_c11=2000.0, rest=40.0) == {4, 13}
    assert source.asked[-1] == 4


def test_a_proposal_that_turns_out_a_little_longer_is_followed() -> None:
    """From thirteen that are longer by a fifth, fifteen promise less."""
    asked = asked_of(Ways({13: 1.2}), 1, k_c11=2000.0, rest=40.0)
    assert len(asked) > 2


def test_of_hundreds_of_passes_the_first_number_stands() -> None:
    """213 turn out longer by a fifth, from where 240 promise less; nobody asked for so many."""
    assert asked_of(Ways({213: 1.2}), 4, k_c11=20000.0, rest=20.0) == {4, 213}


def test_of_hundreds_of_programmed_passes_fewer_are_tried() -> None:
    assert asked_of(Ways({}), 220, k_c11=20000.0, rest=20.0) == {220, 213}
