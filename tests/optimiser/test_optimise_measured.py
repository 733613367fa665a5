"""Optima where the path and the stock are known, and where they are not."""

import pytest

from optimiser.advice import AdviceStatus, Plan
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import LimitName
from service.programs.advice_records import changes_of
from simulator.library import load_machine, match_material
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.units import mm_min_from_speed
from tests.optimiser.plans import (
    USUAL,
    advice_of,
    after,
    before,
    edited,
    measured,
)


def test_the_first_cut_of_a_pocket_is_protected_like_a_slot(bracket: Plan) -> None:
    """Its path begins at full width: the same tool in a slot of that depth bends as much."""
    pocket, slot = advice_of(bracket, "ROUGH POCKET"), advice_of(bracket, "MILL SLOT")
    bent, bent_in_slot = (
        next(load for load in state.loads if load.limit.name is LimitName.TOOL_DEFLECTION)
        for state in (after(pocket), before(slot))
    )
    setting = after(pocket).setting
    in_slot = bent_in_slot.limit.load.value(setting.feed, setting.depth, setting.speed)
    assert pocket.active is LimitName.TOOL_DEFLECTION
    # The levels of the pocket meet a little more than their depth: what the face left.
    assert in_slot * bent.limit.safety_factor == pytest.approx(bent.bound, rel=0.06)


def test_advice_that_was_taken_is_given_again_in_the_same_time(bracket: Plan) -> None:
    """The time of the advice is that of the path which the written file gives."""
    for name, plan in (("bracket", bracket), ("shaft", measured("shaft", OptimisationTask()))):
        usual, material = USUAL[name]
        data = writeback.write(edited(name), changes_of(plan), FileProfile.OPTIMISATION)
        again = optimise_program(
            Program(Part21File.from_bytes(data, name=name), name=name),
            machine=load_machine(usual),
            material=match_material([material]),
            task=OptimisationTask(),
        )
        for one, other in zip(plan.advices, again.advices, strict=True):
            if one.status is AdviceStatus.ADVISED:
                assert before(other).time == pytest.approx(after(one).time, rel=1e-6)
                assert after(other).setting.passes == after(one).setting.passes
                assert after(other).feed == pytest.approx(after(one).feed, rel=0.02)


def test_a_workingstep_that_meets_nothing_keeps_its_feed_and_says_so() -> None:
    """The same face twice: nothing is left for the second time."""
    twice = (
        ("#2=WORKPLAN('MAIN WORKPLAN',(#3),$,#20,$);",
         "#2=WORKPLAN('MAIN WORKPLAN',(#3,#4),$,#20,$);\n"
         "#4=MACHINING_WORKINGSTEP('AGAIN',#22,#30,#40,$);"),
    )  # fmt: skip
    plan = measured("paper002", OptimisationTask(), *twice)
    first, second = plan.advices
    assert first.status is AdviceStatus.ADVISED
    assert second.status is AdviceStatus.UNTOUCHED
    assert second.reason == "the tool meets no material: the feed stays as programmed"
    assert after(second).setting == before(second).setting
    assert after(second).motor_power == 0.0
    assert before(second).time == pytest.approx(before(first).time)
    assert any("meets no material" in str(finding) for finding in plan.findings)


def test_without_a_stock_the_engagement_is_estimated_and_said() -> None:
    plan = measured("paper002", OptimisationTask(), ("0.1,$,$,#13,());", "0.1,$,$,$,());"))
    (advice,) = plan.advices
    assert mm_min_from_speed(after(advice).feed) == pytest.approx(290.0)
    texts = [str(finding) for finding in plan.findings]
    assert any("the stock is not known" in text for text in texts)


def test_without_a_path_nothing_is_advised() -> None:
    """No path lies between a feature and a retract plane below it."""
    below = ("'ROUGH THE FACE',10.,$,#50", "'ROUGH THE FACE',-10.,$,#50")
    with pytest.raises(SchemaError, match="retract plane must lie above"):
        measured("paper002", OptimisationTask(), below)
    plan = measured("paper002", OptimisationTask(keep_going=True), below)
    assert not plan.advices
    assert "retract plane must lie above" in plan.refused[0].reason


def test_time_counts_the_way_through_air(bracket: Plan) -> None:
    for advice in bracket.advices:
        cut = advice.cut
        assert cut is not None
        assert 0.0 < cut.air_length < cut.length
        feed = after(advice).feed
        passes = after(advice).setting.passes
        whole = passes * (cut.length / feed + cut.rest_time)
        assert after(advice).time == pytest.approx(whole, rel=1e-9)
