"""Advice for whole programs: the sample parts.

What belongs to the mathematics alone is asked of estimated cuts, which take no time.
"""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.advice import Advice, AdviceStatus, Plan
from optimiser.cuts.source import from_features
from optimiser.modes import Free, Mode
from optimiser.optimise import DEFAULT_QUALITY, optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import LimitName
from simulator.library import load_machine, match_material
from simulator.physics.surface_spread import RoughnessForecast
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.units import mm_min_from_speed
from tests.optimiser.plans import (
    ALL_FREE,
    DEEP_INSERT,
    PARTS,
    advice_of,
    after,
    before,
    edited,
    measured,
    plan_of,
)


def test_paper_002_runs_at_290_mm_min_at_its_motor_power(paper: Plan) -> None:
    """The way down and through the face, 335 mm with the whole cutter before and behind it."""
    (advice,) = paper.advices
    state = after(advice)
    assert mm_min_from_speed(state.feed) == pytest.approx(290.0)
    assert state.setting.feed == pytest.approx(0.1171, abs=5e-5)
    assert state.motor_power == pytest.approx(290.0)
    assert state.cutting_force == pytest.approx(447.43, abs=0.01)
    program = edited("paper002")
    path = workingstep_path(program, program.workingsteps[0])
    fed = sum(length(at, move) for at, move in path.segments() if move.feed is not None)
    assert state.time == pytest.approx(fed / 290.0 * 60.0)
    assert advice.active is LimitName.MOTOR_POWER
    told = "motor power 0.29 kW reaches its bound of 0.29 kW, the power of the machine"
    assert advice.reason == told


@pytest.mark.parametrize("plan", [measured, plan_of])
@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_advice_keeps_every_limit_that_the_feed_or_the_depth_can_keep(
    name: str, mode: Mode, plan: Callable[[str, OptimisationTask], Plan]
) -> None:
    """A programmed speed outside its window is a warning, where the speed is not free."""
    not_free = {LimitName.CUTTING_SPEED, LimitName.SPINDLE_SPEED}
    for advice in plan(name, OptimisationTask(mode=mode)).advices:
        if advice.status is not AdviceStatus.ADVISED:
            continue
        for load in after(advice).loads:
            assert load.margin >= -1e-9 or load.limit.name in not_free


@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_advice_with_all_free_keeps_every_limit(name: str) -> None:
    for advice in plan_of(name, OptimisationTask(free=ALL_FREE)).advices:
        if advice.status is AdviceStatus.ADVISED:
            assert min(load.margin for load in after(advice).loads) >= -1e-9


def test_every_reason_names_the_limit_that_is_reached(bracket: Plan) -> None:
    for advice in bracket.advices:
        if advice.status is AdviceStatus.ADVISED:
            assert advice.active is not None
            assert advice.reason.startswith(advice.active_words)
            margins = [
                abs(load.margin)
                for load in after(advice).loads
                if load.limit.name is advice.active
            ]
            assert min(margins) < 1e-6


def test_inhibited_feed_is_untouched_and_said(bracket: Plan) -> None:
    advice = advice_of(bracket, "REAM HOLE 1")
    assert advice.status is AdviceStatus.UNTOUCHED
    assert "inhibit_feedrate_override" in advice.reason
    assert "the program locks this feed" in advice.reason
    assert after(advice) == before(advice)


def test_thread_is_untouched_and_said(shaft: Plan) -> None:
    advice = advice_of(shaft, "THREAD M30 X 2")
    assert advice.status is AdviceStatus.UNTOUCHED
    assert advice.reason == "the feed is bound to the pitch of the thread"
    assert advice.before is None


def test_feed_synchronised_with_the_spindle_is_untouched() -> None:
    change = (
        "#311=MILLING_TECHNOLOGY(0.0053,.TCP.,$,-38.,$,.F.,",
        "#311=MILLING_TECHNOLOGY(0.0053,.TCP.,$,-38.,$,.T.,",
    )
    advice = advice_of(plan_of("bracket", OptimisationTask(), change), "DRILL HOLE 1")
    assert advice.status is AdviceStatus.UNTOUCHED
    assert "pitch" in advice.reason


def test_roughness_of_the_file_is_kept() -> None:
    advice = advice_of(measured("shaft", OptimisationTask(), DEEP_INSERT), "FINISH CONTOUR")
    assert surface(advice).median == pytest.approx(1.6e-3)
    assert advice.roughness_probability == pytest.approx(0.5)
    assert advice.active is LimitName.ROUGHNESS


@given(share=st.floats(0.5, 0.75))
@settings(max_examples=5)
def test_a_share_of_surfaces_keeps_the_roughness(share: float) -> None:
    task = OptimisationTask(roughness=3.2e-3, roughness_quantile=share)
    advice = advice_of(measured("shaft", task, DEEP_INSERT), "FINISH CONTOUR")
    assert surface(advice).quantile(share) == pytest.approx(3.2e-3)
    assert advice.roughness_probability == pytest.approx(share)
    assert surface(advice).median <= 3.2e-3 * (1.0 + 1e-9)


def test_a_roughness_that_no_feed_promises_keeps_the_program_s_feed() -> None:
    """The floor alone is rougher than 0.5 µm in half of the published studies."""
    plan = plan_of("shaft", OptimisationTask(roughness=0.5e-3))
    advice = advice_of(plan, "FINISH CONTOUR")
    assert after(advice).setting.feed <= before(advice).setting.feed
    (missing,) = [each for each in advice.unchecked if each.name is LimitName.ROUGHNESS]
    assert "not promised before this shop has measured" in missing.why
    assert advice.roughness_probability is not None
    assert advice.roughness_probability < 0.5
    assert advice in plan.unlikely_surfaces


def surface(advice: Advice) -> RoughnessForecast:
    """Expected surface of an advice."""
    found = after(advice).surface
    assert found is not None
    return found


def test_roughness_that_the_programmed_feed_passes_is_said() -> None:
    """Ra = 0.12²/(18·√3·0.8) mm and the floor of 0.2 µm."""
    plan = plan_of("shaft", OptimisationTask(roughness=0.5e-3))
    advice = advice_of(plan, "FINISH CONTOUR")
    assert before(advice).roughness == pytest.approx(0.7774e-3, rel=1e-3)
    assert after(advice).roughness == pytest.approx(0.5e-3)
    texts = [str(finding) for finding in plan.findings]
    assert any(
        "as programmed: roughness Ra (ideal, not measured) 0.7774 µm exceeds 0.5 µm" in text
        for text in texts
    )


def test_parallel_land_of_a_face_mill_bounds_the_feed_per_revolution(bracket: Plan) -> None:
    """Sandvik Coromant: at most 80 % of the land; Mitsubishi: it is usually 1.4 mm wide."""
    advice = advice_of(bracket, "FINISH FACE")
    assert advice.tool.teeth * after(advice).setting.feed == pytest.approx(0.8 * 1.4)
    assert advice.active_words == "feed per revolution on the parallel land"
    assert after(advice).roughness is None


def test_roughness_of_the_user_goes_before_that_of_the_file() -> None:
    plan = plan_of("shaft", OptimisationTask(roughness=2.5e-3))
    assert surface(advice_of(plan, "FINISH CONTOUR")).median == pytest.approx(2.5e-3)
    texts = [str(finding) for finding in plan.findings]
    said = "the requested Ra 2.5 µm is coarser than Ra 1.6 µm in the file"
    assert any(said in text for text in texts)


def test_what_the_advice_leaves_out_of_range_is_said(bracket: Plan) -> None:
    """The speed is not free: 99.9 m/min stays below the window until it is."""
    text = "as programmed and as advised: cutting speed 99.9 m/min is below 200 m/min"
    assert any(text in str(finding) for finding in bracket.findings)
    freed = plan_of("bracket", OptimisationTask(free=ALL_FREE))
    assert not any("as advised" in str(finding) for finding in freed.findings)


def test_totals_say_what_they_leave_out(bracket: Plan, shaft: Plan) -> None:
    assert bracket.left_out == "tool changes and moves between workingsteps"
    assert shaft.left_out.startswith("1 of the workingsteps (no feed is chosen), ")
    assert bracket.energy_after < bracket.energy_before


def test_roughing_keeps_no_roughness() -> None:
    plan = plan_of("bracket", OptimisationTask(roughness=0.8e-3))
    names = {load.limit.name for load in after(advice_of(plan, "ROUGH FACE")).loads}
    assert LimitName.ROUGHNESS not in names


def test_quality_nobody_asked_for_is_the_default_and_said() -> None:
    plan = plan_of("shaft", OptimisationTask(mode=Mode.QC))
    found = surface(advice_of(plan, "FINISH FACE"))
    assert found.median <= DEFAULT_QUALITY * (1.0 + 1e-9)
    texts = [str(finding) for finding in plan.findings]
    assert any("no roughness is required: QC keeps Ra 3.2 µm" in text for text in texts)


@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_quality_is_never_slower_than_it_must(name: str) -> None:
    """The roughness, or another limit, is at its bound."""
    for advice in plan_of(name, OptimisationTask(mode=Mode.QC)).advices:
        if advice.status is AdviceStatus.ADVISED:
            margins = [
                abs(load.margin)
                for load in after(advice).loads
                if load.limit.name is advice.active
            ]
            assert min(margins) < 1e-6


def test_quality_equals_time_where_the_same_roughness_is_asked_for() -> None:
    task = OptimisationTask(roughness=1.6e-3)
    fast = plan_of("bracket", task)
    good = plan_of("bracket", OptimisationTask(mode=Mode.QC, roughness=1.6e-3))
    assert good.time_after == pytest.approx(fast.time_after)


@pytest.mark.parametrize("free", [frozenset({Free.FEED, Free.DEPTH}), ALL_FREE])
@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_energy_critical_never_needs_more_energy_than_time_critical(
    name: str, free: frozenset[Free]
) -> None:
    fast = plan_of(name, OptimisationTask(free=free))
    frugal = plan_of(name, OptimisationTask(mode=Mode.EC, free=free))
    for one, other in zip(fast.advices, frugal.advices, strict=True):
        if one.status is AdviceStatus.ADVISED:
            assert after(other).energy <= after(one).energy * (1.0 + 1e-8)
            assert after(one).time <= after(other).time * (1.0 + 1e-8)


def test_more_passes_are_told_when_the_deepest_is_not_the_best(bracket: Plan) -> None:
    """Slot: one pass of 6 mm bends the tool."""
    advice = advice_of(bracket, "MILL SLOT")
    assert advice.deepest_first_time is not None
    assert advice.deepest_first_time > after(advice).time
    assert after(advice).setting.passes > 1


@pytest.mark.parametrize(
    ("name", "bound", "active"),
    [
        ("FINISH CONTOUR", 0.05, "feed per tooth"),
        ("FINISH POCKET", 0.025, "feed per tooth after the ramp"),
        ("FINISH OPEN POCKET", 0.05, "tool deflection"),
    ],
)
def test_a_finish_is_not_slowed_by_a_deflection_that_does_not_exist(
    bracket: Plan, name: str, bound: float, active: str
) -> None:
    """Straight edges bent the tool by 0.05 mm at 338 mm/min where 382 were programmed.

    The tolerances of the pockets do bound their finishes, at a higher feed; that of the closed
    one where its ramp ends.
    """
    advice = advice_of(bracket, name)
    assert advice.active_words == active
    assert after(advice).feed > 1.2 * before(advice).feed
    (bent,) = (
        load
        for load in after(advice).loads
        if load.limit.name is LimitName.TOOL_DEFLECTION and load.limit.load.knows_depth
    )
    assert bent.bound == bound
    assert bent.value <= bent.bound * (1.0 + 1e-9)


def test_one_step_more_of_the_active_limit_saves_time(bracket: Plan) -> None:
    for advice in bracket.advices:
        if advice.status is AdviceStatus.ADVISED:
            assert advice.saving_of_one_more > 0.0


def test_machine_of_twice_the_power_runs_twice_the_feed(tmp_path: Path) -> None:
    source = (
        PARTS.parents[1] / "simulator" / "data" / "machines" / "paper002.toml"
    ).read_text()
    assert "power_kw = 0.29" in source
    machine = tmp_path / "double.toml"
    machine.write_text(source.replace("power_kw = 0.29", "power_kw = 0.58"))
    (advice,) = plan_of("paper002", OptimisationTask(), machine=str(machine)).advices
    assert mm_min_from_speed(after(advice).feed) == pytest.approx(580.0)


def test_accepted_correction_lowers_the_feed_at_the_power_limit() -> None:
    (first,) = plan_of("paper002", OptimisationTask()).advices
    assert first.force_factor == 1.0
    plan = plan_of("paper002", OptimisationTask(force_factors={first.tool.id: 1.42}))
    (advice,) = plan.advices
    assert advice.force_factor == 1.42
    assert mm_min_from_speed(after(advice).feed) == pytest.approx(290.0 / 1.42)
    note = f"k_c × 1.42 (accepted correction) for tool '{first.tool.id}'"
    assert [finding.message for finding in plan.findings].count(note) == 1


def test_accepted_correction_of_one_tool_leaves_the_others() -> None:
    plain, corrected = (
        plan_of("bracket", OptimisationTask(source=from_features, force_factors=factors))
        for factors in ({}, {"END MILL 12MM": 1.31})
    )
    notes = [each.message for each in corrected.findings if "k_c ×" in each.message]
    assert notes == ["k_c × 1.31 (accepted correction) for tool 'END MILL 12MM'"]
    for old, new in zip(plain.advices, corrected.advices, strict=True):
        is_meant = new.tool.id == "END MILL 12MM"
        assert new.force_factor == (1.31 if is_meant else 1.0)
        if not is_meant:
            assert new == old
        elif old.before is not None and new.before is not None:
            force = 1.31 * old.before.cutting_force
            assert new.before.cutting_force == pytest.approx(force)


def test_tool_without_a_material_is_taken_as_carbide_and_said() -> None:
    plan = plan_of(
        "bracket",
        OptimisationTask(),
        ("#423=CUTTING_COMPONENT(85.,#490,$,$,$);", "#423=CUTTING_COMPONENT(85.,$,$,$,$);"),
    )
    texts = [str(finding) for finding in plan.findings]
    assert any("names no cutting material: carbide assumed" in text for text in texts)


def test_tool_without_teeth_is_taken_with_one_and_said() -> None:
    plan = plan_of(
        "paper002",
        OptimisationTask(),
        ("#51=TAPERED_ENDMILL(#52,4,", "#51=TAPERED_ENDMILL(#52,$,"),
    )
    (advice,) = plan.advices
    assert after(advice).setting.feed == pytest.approx(0.4685, abs=5e-5)
    texts = [str(finding) for finding in plan.findings]
    assert any("one tooth assumed" in text for text in texts)


@pytest.mark.parametrize(
    ("part", "machine", "reason"),
    [
        ("shaft", "vmc15", "facing_rough needs a lathe, and 'vmc15' is a mill"),
        ("paper002", "lathe22", "plane_rough_milling needs a mill, and 'lathe22' is a lathe"),
        ("bracket", "lathe22", "plane_rough_milling needs a mill, and 'lathe22' is a lathe"),
    ],
)
def test_nothing_is_advised_for_another_kind_of_machine(
    part: str, machine: str, reason: str
) -> None:
    plan = plan_of(part, OptimisationTask(), machine=machine)
    assert plan.is_infeasible
    assert plan.advices[0].status is AdviceStatus.INFEASIBLE
    assert plan.advices[0].reason == reason
    assert plan.advices[0].after is None


def test_only_selected_workingsteps_are_advised() -> None:
    plan = optimise_program(
        edited("bracket"),
        machine=load_machine("vmc15"),
        material=match_material(["C45"]),
        task=OptimisationTask(),
        selected=lambda step: step.id == "MILL SLOT",
    )
    assert [advice.workingstep.id for advice in plan.advices] == ["MILL SLOT"]


@pytest.mark.parametrize("name", ["bracket", "paper002", "shaft"])
def test_same_inputs_give_the_same_plan(name: str) -> None:
    again = measured.__wrapped__(name, OptimisationTask())
    assert measured(name, OptimisationTask()).advices == again.advices


@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_front_trades_time_for_roughness(name: str) -> None:
    plan = plan_of(name, OptimisationTask(front=True))
    fronts = [advice.front for advice in plan.advices if len(advice.front) > 2]
    assert fronts
    for front in fronts:
        times = [point.state.time for point in front]
        assert times == sorted(times)
        roughness = [point.state.roughness for point in front]
        assert roughness[-1] == min(value for value in roughness if value is not None)
