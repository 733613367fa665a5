"""What holds the workpiece as limits: chucks, slender bars, vices and clamps."""

from dataclasses import replace
from functools import cache
from math import hypot, pi, radians, sqrt, tan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.advice import AdviceStatus, Plan
from optimiser.bounds.holding import chuck_limits, holding_limits, holding_load
from optimiser.bounds.limits import force_load
from optimiser.cuts.conditions import BarGrip, PermittedDeflection
from optimiser.cuts.cut import CutKind, TurnedBar
from optimiser.cuts.source import from_features
from optimiser.modes import Free, Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask, problem_of
from optimiser.solver.problem import LimitName
from optimiser.solver.workingstep import solve
from simulator.errors import LibraryError
from simulator.library import find_grade, load_machine, match_material
from simulator.physics.holding import GripSize, clamping_force, usable_speed
from simulator.physics.slender_bar import BarSection
from simulator.physics.spindle import available_power, idle_power
from simulator.physics.surface import RA_FLOOR, corner_coefficient
from simulator.physics.turning import BACK_SHARE, FEED_SHARE
from simulator.spec import (
    CuttingMaterial,
    ToolKind,
)
from simulator.work_holding import (
    Chuck,
    Clamp,
    Holding,
)
from stepnc_model.errors import Severity
from tests.optimiser.plans import ALL_FREE, DEEP_INSERT, advice_of, after, edited
from tests.optimiser.sample_cuts import CARBIDE, CUT, DRILLED, TURNED, conditions, named

CHUCK = Chuck(
    clamping_force=60_000.0,
    friction=0.2,
    source="test",
    jaw_mass=0.9,
    jaw_radius=63.0,
)
GRIP = BarGrip(size=GripSize(diameter=60.0, length=30.0), face=-120.0, front=2.0)
LATHE = replace(
    conditions(ToolKind.TURNING),
    machine=load_machine("lathe22"),
    holding=CHUCK,
    grip=GRIP,
)
BAR = TurnedBar(
    sections=(BarSection(start=0.0, end=152.0, outer=40.0),),
    back=-150.0,
    low=-110.0,
    high=0.0,
)
SHAFT_TURNED = replace(TURNED, turned=BAR)


@cache
def shaft(
    *holdings: Holding,
    task: OptimisationTask = OptimisationTask(),  # noqa: B008 (frozen)
    tail_stock: str = ".F.",
) -> Plan:
    functions = "#330=TURNING_MACHINE_FUNCTIONS(.T.,.FLOOD.,$,(),.T.,$,$,(),"
    return optimise_program(
        edited("shaft", DEEP_INSERT, (f"{functions}.F.,", f"{functions}{tail_stock},")),
        machine=replace(load_machine("lathe22"), holdings=holdings),
        material=match_material(["42CrMo4"]),
        task=task,
    )


def test_turning_no_chuck_no_bar() -> None:
    """The fault was 771 N·m at the jaws on 30 mm of grip, 22.5 kW on 22 kW, feeds of 0.75 r."""
    plan = shaft(CHUCK)
    spindle = plan.machine.spindle
    radius = 0.8
    for advice in plan.advices:
        if advice.status is not AdviceStatus.ADVISED:
            continue
        state, cut = after(advice), advice.cut
        assert cut is not None
        assert cut.turned is not None
        assert advice.holding_load is not None
        speed = cut.turned.fastest(state.setting.speed)
        held_force = clamping_force(CHUCK, min(speed, usable_speed(CHUCK))) / 1.5
        # Three jaws: 0.75 d of friction, and the jaws shift by a sixth of 30 mm.
        tilting = held_force / 3.0 * (0.2 * 60.0 * 0.75 + 30.0 / 6.0 * 3.0**0.5)
        assert advice.safety_factor * advice.holding_load.moment <= tilting * (1.0 + 1e-9)
        assert advice.holding_load.torque <= 0.5 * 0.2 * 60.0 * held_force * (1.0 + 1e-9)
        for each in (state.setting.speed, speed):
            drawn = state.motor_power + float(idle_power(spindle, each))
            assert drawn <= available_power(spindle, each)
        if cut.kind is CutKind.TURNING:
            share = 0.5 if cut.is_finishing else 2.0 / 3.0
            assert state.setting.feed <= share * radius * (1.0 + 1e-9)
    rough = advice_of(plan, "ROUGH CONTOUR")
    assert rough.active is LimitName.TILTING_MOMENT


def test_without_a_table_one_note_a_setup_tells_what_is_asked() -> None:
    plan = shaft()
    notes = [each for each in plan.findings if "[[holding]]" in each.message]
    assert len(notes) == 1
    assert notes[0].severity is Severity.NOTE
    load = advice_of(plan, "ROUGH CONTOUR").holding_load
    assert load is not None
    for text in (
        "'SETUP 1'",
        f"{1e-3 * load.torque:.4g} N·m about the axis (ROUGH CONTOUR)",
        f"{1e-3 * load.moment:.4g} N·m of tilting about the jaws (ROUGH CONTOUR)",
        "it grips 30 mm on Ø60 mm, overhang 122 mm (L/D 2)",
    ):
        assert text in notes[0].message


def test_a_tailstock_of_the_program_or_the_table_takes_the_moment() -> None:
    for plan in (
        shaft(CHUCK, tail_stock=".T."),
        shaft(replace(CHUCK, has_tailstock=True)),
    ):
        found = {load.limit.name for load in after(advice_of(plan, "ROUGH CONTOUR")).loads}
        assert LimitName.TILTING_MOMENT not in found
        faced = {load.limit.name for load in after(advice_of(plan, "ROUGH FACE")).loads}
        assert LimitName.TILTING_MOMENT in faced
        assert {LimitName.CHUCK_TORQUE, LimitName.BAR_DEFLECTION} <= found


def test_a_table_of_another_setup_is_told_and_bounds_nothing() -> None:
    plan = shaft(replace(CHUCK, setup="OP 20"))
    texts = [each.message for each in plan.findings]
    assert "work-holding of unknown setup 'OP 20'; the program has: 'SETUP 1'" in texts
    assert any("no [[holding]]" in text for text in texts)
    assert advice_of(plan, "ROUGH CONTOUR").active is advice_of(shaft(), "ROUGH CONTOUR").active


def test_a_table_that_names_the_setup_goes_before_one_that_names_none() -> None:
    weak = replace(CHUCK, clamping_force=1_000.0)
    named_setup = replace(CHUCK, setup="setup 1")
    assert [advice.after for advice in shaft(weak, named_setup).advices] == [
        advice.after for advice in shaft(CHUCK).advices
    ]


def test_a_chuck_that_cannot_be_judged_names_the_key() -> None:
    program = edited("shaft", ("$,$,#33,(#36));", "$,$,#33,());"))
    with pytest.raises(LibraryError, match="jaw_face_z_mm: missing; the bar"):
        optimise_program(
            program,
            machine=replace(load_machine("lathe22"), holdings=(CHUCK,)),
            material=match_material(["42CrMo4"]),
            task=OptimisationTask(),
        )


def test_the_paper_machines_keep_their_limits_alone() -> None:
    only_stated = replace(LATHE.machine, only_stated_limits=True)
    at = replace(LATHE, machine=only_stated, holding=None)
    assert holding_load(SHAFT_TURNED, at, TURNED.programmed) is None


def test_the_chuck_holds_torque_and_axial_force_by_one_friction() -> None:
    """Resultant at the jaws of F_c·D/d and F_f; the usual share of F_f has no exponent."""
    (torque, _) = chuck_limits(SHAFT_TURNED, LATHE, 10.0, 10.0)
    force = force_load(TURNED, LATHE).value(0.3, 2.0, 10.0)
    expected = 30.0 * hypot(force * 40.0 / 60.0, FEED_SHARE * force)
    at = replace(LATHE, material=replace(LATHE.material, feed_force=None, back_force=None))
    (torque, _) = chuck_limits(SHAFT_TURNED, at, 10.0, 10.0)
    assert torque.load.value(0.3, 2.0, 10.0) == pytest.approx(expected)
    left = 40_000.0 - 3 * 0.9 * 0.063 * (2.0 * pi * 10.0) ** 2
    assert torque.bound_at(10.0) == pytest.approx(0.2 * 30.0 * left / 1.5)


def test_the_moment_is_that_of_the_farthest_cut() -> None:
    at = replace(LATHE, material=replace(LATHE.material, feed_force=None, back_force=None))
    force = force_load(TURNED, at).value(0.3, 2.0, 10.0)
    (_, near) = chuck_limits(
        replace(SHAFT_TURNED, turned=replace(BAR, high=-80.0)), at, 10.0, 10.0
    )
    (_, whole) = chuck_limits(SHAFT_TURNED, at, 10.0, 10.0)
    assert whole.load.value(0.3, 2.0, 10.0) == pytest.approx(
        hypot(120.0 * force, BACK_SHARE * 120.0 * force)
    )
    assert near.load.value(0.3, 2.0, 10.0) == pytest.approx(
        hypot(40.0 * force, max(BACK_SHARE * 40.0, FEED_SHARE * 20.0) * force)
    )


def test_facing_swaps_feed_and_back_force() -> None:
    at = replace(LATHE, material=replace(LATHE.material, feed_force=None, back_force=None))
    facing = replace(SHAFT_TURNED, is_fed_inwards=True)
    force = force_load(TURNED, at).value(0.3, 2.0, 10.0)
    (torque, moment) = chuck_limits(facing, at, 10.0, 10.0)
    assert torque.load.value(0.3, 2.0, 10.0) == pytest.approx(
        30.0 * hypot(force * 40.0 / 60.0, BACK_SHARE * force)
    )
    assert moment.load.value(0.3, 2.0, 10.0) == pytest.approx(
        120.0 * hypot(force, FEED_SHARE * force)
    )


@settings(max_examples=50)
@given(feed=st.floats(0.05, 1.0))
def test_a_power_of_the_feed_is_never_below_the_forces_and_hardly_above(feed: float) -> None:
    """With the pairs of C45, whose exponents differ most."""
    (torque, moment) = chuck_limits(SHAFT_TURNED, LATHE, 10.0, 10.0)
    assert LATHE.material.feed_force is not None
    one = holding_load(SHAFT_TURNED, LATHE, replace(TURNED.programmed, feed=feed, depth=1.0))
    assert one is not None
    for limit in (torque, moment):
        exact = exact_load(limit.name, feed)
        assert exact * (1.0 - 1e-9) <= limit.load.value(feed, 1.0, 1.0) <= 1.05 * exact


def exact_load(name: LimitName, feed: float) -> float:
    """The same by Kienzle's three pairs, for κ = 90° and 1 mm of depth."""
    material = LATHE.material
    assert material.feed_force is not None
    assert material.back_force is not None
    force = force_load(TURNED, LATHE).value(feed, 1.0, 1.0)
    shares = [
        pair.k_c11 / material.kienzle.k_c11 * feed ** (material.kienzle.m_c - pair.m_c)
        for pair in (material.feed_force, material.back_force)
    ]
    if name is LimitName.CHUCK_TORQUE:
        return 30.0 * force * hypot(40.0 / 60.0, shares[0])
    return force * hypot(120.0, max(120.0 * shares[1], 20.0 * shares[0]))


def test_grooves_and_drills_load_the_chuck_too() -> None:
    groove = replace(SHAFT_TURNED, kind=CutKind.GROOVING, radial_width=3.0, is_fed_inwards=True)
    assert len(chuck_limits(groove, LATHE, 10.0, 10.0)) == 2
    at = replace(LATHE, grade=find_grade(ToolKind.DRILL, CuttingMaterial.CARBIDE, "P"))
    (torque,) = chuck_limits(replace(DRILLED, turned=None), at, 10.0, 10.0)
    assert torque.load.value(0.1, 1.0, 10.0) > 0.0
    assert chuck_limits(CUT, LATHE, 10.0, 10.0) == ()


def test_the_fastest_point_of_a_path_counts() -> None:
    """At constant surface speed half the diameter turns twice as fast, up to the clamp."""
    (slow, _) = chuck_limits(SHAFT_TURNED, LATHE, 20.0, 20.0)
    for limit, speed in ((60.0, 40.0), (30.0, 30.0)):
        turned = replace(BAR, speed_ratio=2.0, greatest_speed=limit)
        (fast, _) = chuck_limits(replace(TURNED, turned=turned), LATHE, 20.0, 20.0)
        (same, _) = chuck_limits(SHAFT_TURNED, LATHE, speed, speed)
        assert fast.bound_at(20.0) == pytest.approx(same.bound_at(speed))
        assert fast.bound_at(20.0) < slow.bound_at(20.0)


def test_a_speed_at_which_the_chuck_hardly_holds_is_lowered() -> None:
    heavy = replace(CHUCK, jaw_mass=9.0)
    at = replace(LATHE, holding=heavy)
    fast = replace(SHAFT_TURNED, programmed=replace(TURNED.programmed, speed=40.0))
    assert usable_speed(heavy) < 40.0
    problem = problem_of(fast, at, OptimisationTask())
    assert problem.speeds == (usable_speed(heavy),)


def test_free_speed_finds_what_a_grid_of_speeds_finds() -> None:
    """The grid has the true bounds, no powers of the speed: at most 3 % of time are lost."""
    heavy = replace(CHUCK, jaw_mass=5.0)
    at = replace(LATHE, holding=heavy, grip=replace(GRIP, front=-60.0))
    cut = replace(TURNED, turned=replace(BAR, high=-60.0), diameter=60.0, total_depth=4.0)
    free = problem_of(cut, at, OptimisationTask(free=ALL_FREE))
    best = solve(free, Mode.TC)
    low, high = free.speeds[0], free.speeds[-1]
    times = []
    for row in range(401):
        speed = low * (high / low) ** (row / 400)
        given = replace(cut, programmed=replace(cut.programmed, speed=speed))
        times.append(solve(problem_of(given, at, OptimisationTask()), Mode.TC).time)
    assert min(times) <= best.time * (1.0 + 1e-9)
    assert best.time <= 1.03 * min(times)
    assert {LimitName.CHUCK_TORQUE, LimitName.TILTING_MOMENT} & {
        load.name for load in best.limits
    }


def test_a_slender_bar_keeps_its_tolerance_by_the_back_force() -> None:
    """F_p·l³/(3·E·I) of steel, Ø40, 120 mm out, with the usual share."""
    material = replace(LATHE.material, back_force=None, feed_force=None)
    at = replace(LATHE, material=material, bar_deflection=PermittedDeflection(value=0.01))
    (limit,) = holding_limits(SHAFT_TURNED, at)
    force = BACK_SHARE * force_load(TURNED, at).value(0.3, 2.0, 10.0)
    inertia = pi * 40.0**4 / 64.0
    assert material.youngs_modulus == 200_000.0
    bent = force * 120.0**3 / (3.0 * 200_000.0 * inertia)
    assert limit.load.value(0.3, 2.0, 10.0) == pytest.approx(bent)
    assert limit.name is LimitName.BAR_DEFLECTION
    assert limit.bound == 0.01


def test_a_rest_or_an_unknown_path_leaves_the_bar_unbounded() -> None:
    at = replace(LATHE, bar_deflection=PermittedDeflection(value=0.01))
    for cut, grip in ((TURNED, GRIP), (SHAFT_TURNED, replace(GRIP, has_rest=True))):
        assert holding_limits(cut, replace(at, grip=grip)) == ()


def test_a_vice_holds_the_greatest_force_across_and_the_pull_of_the_helix() -> None:
    clamp = Clamp(holding_force=20_000.0, friction=0.15, source="test")
    at = replace(CARBIDE, holding=clamp)
    across, lift = holding_limits(CUT, at)
    assert across.bound == lift.bound == pytest.approx(0.15 * 20_000.0 / 1.5)
    setting = CUT.programmed
    mean = force_load(CUT, at).value(setting.feed, setting.depth, setting.speed)
    assert across.load.value(setting.feed, setting.depth, setting.speed) > mean
    pull = lift.load.value(setting.feed, setting.depth, setting.speed)
    assert pull == pytest.approx(mean * tan(radians(30.0)))
    assert lift.words == "lifting force"
    (straight,) = holding_limits(replace(CUT, helix_angle=0.0), at)
    assert straight.words == "holding force"
    assert holding_limits(DRILLED, at) == ()


def test_a_floor_that_is_swept_is_held_at_its_own_depth() -> None:
    at = replace(CARBIDE, holding=Clamp(holding_force=20_000.0, friction=0.15, source="test"))
    floor = replace(CUT, total_depth=0.5)
    *_, swept, _ = holding_limits(replace(CUT, floor=floor), at)
    assert not swept.load.knows_depth


def test_weak_clamps_bound_the_bracket_and_a_note_tells_what_is_asked() -> None:
    clamp = Clamp(holding_force=8_000.0, friction=0.15, source="test")
    mill = load_machine("vmc15")
    plans = [
        optimise_program(
            edited("bracket"),
            machine=machine,
            material=match_material(["C45"]),
            task=OptimisationTask(free=frozenset({Free.FEED}), source=from_features),
            selected=lambda step: step.id == "ROUGH POCKET",
        )
        for machine in (mill, replace(mill, holdings=(clamp,)))
    ]
    loose, tight = (advice_of(plan, "ROUGH POCKET") for plan in plans)
    assert loose.holding_load is not None
    assert tight.holding_load is not None
    needed = tight.safety_factor * tight.holding_load.force
    assert needed <= 800.0 * (1.0 + 1e-9) < tight.safety_factor * loose.holding_load.force
    assert tight.active is LimitName.HOLDING_FORCE
    asked = f"must hold {loose.holding_load.force:.4g} N across the spindle (ROUGH POCKET)"
    assert any(asked in each.message for each in plans[0].findings)
    assert not any("[[holding]]" in each.message for each in plans[1].findings)


def test_a_wiper_allows_twice_the_feed_for_the_same_roughness() -> None:
    """Ideally; no study tells what real wipers leave, and the plan says so."""
    name, asked = "FINISHING TOOL, CARBIDE P15", 0.8e-3
    task = OptimisationTask(wipers=frozenset({name}), roughness=asked)
    wiped = advice_of(shaft(task=task), "FINISH CONTOUR")
    plain = sqrt((asked - RA_FLOOR) / corner_coefficient(0.8))
    assert after(wiped).setting.feed == pytest.approx(2.0 * plain)
    assert after(wiped).roughness == pytest.approx(asked)
    assert after(wiped).surface is None
    assert any("roughness" in each.words for each in wiped.unchecked)


def test_idling_leaves_less_of_the_drive() -> None:
    problem = problem_of(SHAFT_TURNED, LATHE, OptimisationTask())
    (speed,) = problem.speeds
    power = named(problem.stretches[0], LimitName.MOTOR_POWER)
    spindle = LATHE.machine.spindle
    left = available_power(spindle, speed) - float(idle_power(spindle, speed))
    assert power.full_bound_at(speed) == pytest.approx(left)
    assert power.origin == "the drive power less the idling power of the spindle"


def test_power_counts_where_the_path_turns_fastest() -> None:
    """The drive falls from 22 kW at 3000 rpm to 18 kW at 4000 rpm."""
    (speed,) = problem_of(SHAFT_TURNED, LATHE, OptimisationTask()).speeds
    spindle, top = LATHE.machine.spindle, 200.0 / 3.0
    cut = replace(SHAFT_TURNED, turned=replace(BAR, speed_ratio=top / speed))
    power = named(
        problem_of(cut, LATHE, OptimisationTask()).stretches[0], LimitName.MOTOR_POWER
    )
    left = available_power(spindle, top) - float(idle_power(spindle, top))
    assert power.full_bound_at(speed) == pytest.approx(left)
