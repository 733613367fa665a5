"""The limits of a cut: which there are, where their bounds come from, and what loads them."""

from collections.abc import Sequence
from dataclasses import replace
from math import pi, radians, sin

import pytest

from optimiser.bounds import loads
from optimiser.bounds.chip_load import FINISH_NOSE_FEED, ROUGH_NOSE_FEED
from optimiser.bounds.limits import (
    force_factor,
    force_load,
    limits_of,
    power_load,
    segment_at,
    spindle_limits,
)
from optimiser.bounds.speed_limits import cutting_speed_window, speed_range
from optimiser.cuts.conditions import GREATEST_DEFLECTION, PermittedDeflection
from optimiser.cuts.cut import Texture
from optimiser.solver.problem import BoundSide, Limit, LimitName
from simulator.physics.engagement import bilateral, full_immersion, unidirectional
from simulator.physics.strength import STICK_OUT
from simulator.spec import ToolKind
from tests.optimiser.sample_cuts import (
    CARBIDE,
    CUT,
    DRILLED,
    MILL,
    PAPER,
    TURNED,
    conditions,
    named,
    names,
)


def test_what_a_source_does_not_give_does_not_limit() -> None:
    """Table 2 of paper 002 gives a motor and a greatest feed per tooth."""
    cut = replace(CUT, depth_bound=None)
    assert names(limits_of(cut, PAPER)) == {LimitName.FEED_PER_TOOTH}
    limits = spindle_limits(cut, PAPER, segment_at(PAPER, 10.0))
    assert names(limits) == {LimitName.MOTOR_POWER}
    assert limits[0].bound_at(10.0) == pytest.approx(290.0)


def test_end_mill_on_a_machining_centre_has_all_its_limits() -> None:
    at = replace(CARBIDE, roughness=1.6e-3)
    cut = replace(CUT, texture=Texture.CORNER_PER_TOOTH, corner_radius=0.5)
    assert names(limits_of(cut, at)) == {
        LimitName.CUTTING_FORCE,
        LimitName.FEED_MECHANISM,
        LimitName.FEED_PER_TOOTH,
        LimitName.CHIP_THICKNESS,
        LimitName.TOOL_DEFLECTION,
        LimitName.SHANK_STRENGTH,
        LimitName.AXIAL_DEPTH,
        LimitName.ROUGHNESS,
        LimitName.CUTTING_SPEED,
        LimitName.SPINDLE_SPEED,
    }


def test_face_mill_does_not_bend() -> None:
    cut = replace(CUT, tool_kind=ToolKind.FACEMILL)
    found = names(limits_of(cut, conditions(ToolKind.FACEMILL)))
    assert not found & {LimitName.TOOL_DEFLECTION, LimitName.SHANK_STRENGTH}


def test_feed_per_tooth_is_the_grades_share_of_the_diameter() -> None:
    limit = named(limits_of(CUT, CARBIDE), LimitName.FEED_PER_TOOTH)
    assert CARBIDE.grade is not None
    assert CARBIDE.grade.max_feed_ratio is not None
    assert limit.bound == pytest.approx(CARBIDE.grade.max_feed_ratio * 12.0)


def test_feed_per_tooth_of_the_material_holds_where_it_is_less() -> None:
    at = replace(CARBIDE, material=replace(CARBIDE.material, max_feed_per_tooth=0.02))
    assert named(limits_of(CUT, at), LimitName.FEED_PER_TOOTH).bound == 0.02


def test_drills_feed_is_per_revolution_and_shared_by_its_lips() -> None:
    at = conditions(ToolKind.DRILL)
    assert at.grade is not None
    assert at.grade.max_feed_ratio is not None
    limit = named(limits_of(DRILLED, at), LimitName.FEED_PER_TOOTH)
    assert limit.bound == pytest.approx(at.grade.max_feed_ratio * 10.0 / 2)


def test_feed_of_an_insert_stays_below_its_nose() -> None:
    at = conditions(ToolKind.TURNING)
    cut = replace(TURNED, corner_radius=0.2)
    for finish, wiper, share in (
        (False, False, ROUGH_NOSE_FEED),
        (True, False, FINISH_NOSE_FEED),
        (True, True, ROUGH_NOSE_FEED),
    ):
        tool = replace(cut.tool, has_wiper=wiper)
        one = replace(cut, tool=tool, is_finishing=finish)
        limit = named(limits_of(one, at), LimitName.FEED_PER_TOOTH)
        assert limit.bound == pytest.approx(share * 0.2)


def test_chip_floor_grows_the_feed_of_a_narrow_cut() -> None:
    """h_m = f_z·C/φ: a tenth of the diameter has C = 0.2 over 36.87 degrees."""
    cut = replace(CUT, engagement=unidirectional(1.2, 12.0))
    floor = named(limits_of(cut, CARBIDE), LimitName.CHIP_THICKNESS, BoundSide.AT_LEAST)
    assert CARBIDE.grade is not None
    ratio = 0.2 / (36.8699 * pi / 180.0)
    expected = CARBIDE.grade.min_chip_thickness / ratio
    assert floor.feed_at_bound(3.0, 60.0) == pytest.approx(expected, rel=1e-5)


def test_deflection_is_that_of_a_bar_clamped_at_one_end() -> None:
    """F·L³/(3·E·π·d⁴/64) with d = 0.8·D, L = 3·D, F at the wall; stress is that of the peak."""
    limit = named(limits_of(CUT, CARBIDE), LimitName.TOOL_DEFLECTION)
    stress = named(limits_of(CUT, CARBIDE), LimitName.SHANK_STRENGTH)
    overhang, diameter = STICK_OUT * 12.0, 0.8 * 12.0
    assert CARBIDE.grade is not None
    factor = force_factor(CARBIDE)
    wall = loads.wall_force(CUT, CARBIDE.material.kienzle, factor)
    across = loads.shank_force(CUT, CARBIDE.material.kienzle, factor)
    assert wall is not None
    stiffness = 3.0 * CARBIDE.grade.youngs_modulus * pi * diameter**4 / 64.0
    expected = wall.value(0.05, 3.0, 60.0) * overhang**3 / stiffness
    assert limit.load.value(0.05, 3.0, 60.0) == pytest.approx(expected)
    expected = 32.0 * across.value(0.05, 3.0, 60.0) * overhang / (pi * diameter**3)
    assert stress.load.value(0.05, 3.0, 60.0) == pytest.approx(expected)
    assert limit.bound == GREATEST_DEFLECTION
    assert stress.bound == CARBIDE.grade.bending_strength


def test_a_cut_that_reaches_no_wall_bends_the_tool_into_none() -> None:
    within = replace(CUT, engagement=bilateral(6.0, 12.0, offset=0.0))
    found = names(limits_of(within, CARBIDE))
    assert LimitName.TOOL_DEFLECTION not in found
    assert LimitName.SHANK_STRENGTH in found


def test_long_edge_sticks_out_further() -> None:
    long = replace(CUT, tool=replace(MILL, cutting_edge_length=72.0))
    deflections = [
        named(limits_of(cut, CARBIDE), LimitName.TOOL_DEFLECTION).load.coefficient
        for cut in (CUT, long)
    ]
    assert deflections[1] == pytest.approx(8.0 * deflections[0])


def test_deflection_keeps_what_the_wall_permits_and_says_why() -> None:
    permitted = PermittedDeflection(value=0.0125, origin="a quarter of ±0.05 mm")
    at = replace(CARBIDE, deflection=permitted)
    limit = named(limits_of(CUT, at), LimitName.TOOL_DEFLECTION)
    assert (limit.bound, limit.origin) == (0.0125, "a quarter of ±0.05 mm")


def test_sweep_of_a_floor_does_not_spoil_the_wall() -> None:
    at = replace(CARBIDE, deflection=PermittedDeflection(value=0.0125))
    floor = replace(CUT, total_depth=0.2)
    limits = limits_of(replace(CUT, floor=floor), at)
    bounds = [each.bound for each in limits if each.name is LimitName.TOOL_DEFLECTION]
    assert bounds == [0.0125, GREATEST_DEFLECTION]


def test_material_of_a_paper_bends_no_tool() -> None:
    at = replace(PAPER, deflection=PermittedDeflection(value=1e-6))
    assert LimitName.TOOL_DEFLECTION not in names(limits_of(CUT, at))


def test_floor_limits_the_feed_too_at_its_own_depth() -> None:
    floor = replace(CUT, engagement=full_immersion(), radial_width=12.0, total_depth=0.2)
    limits = limits_of(replace(CUT, floor=floor), CARBIDE)
    deflections = [limit for limit in limits if limit.name is LimitName.TOOL_DEFLECTION]
    assert len(deflections) == 2
    alone = named(limits_of(floor, CARBIDE), LimitName.TOOL_DEFLECTION)
    swept = deflections[1]
    for depth in (0.5, 6.0):
        assert swept.feed_at_bound(depth, 60.0) == pytest.approx(alone.feed_at_bound(0.2, 60.0))


def test_floor_loads_the_spindle_too() -> None:
    floor = replace(CUT, engagement=full_immersion(), total_depth=0.2)
    at = replace(CUT, floor=floor)
    segment = segment_at(CARBIDE, 60.0)
    powers = [
        limit
        for limit in spindle_limits(at, CARBIDE, segment)
        if limit.name is LimitName.MOTOR_POWER
    ]
    expected = power_load(floor, CARBIDE).value(0.05, 0.2, 60.0)
    assert powers[1].load.value(0.05, 99.0, 60.0) == pytest.approx(expected)


def test_spindle_gives_constant_torque_then_constant_power() -> None:
    """81.2 N·m up to 1500 rpm; 15 kW up to 8000 rpm."""
    low = spindle_limits(CUT, CARBIDE, segment_at(CARBIDE, 10.0))
    middle = spindle_limits(CUT, CARBIDE, segment_at(CARBIDE, 60.0))
    assert named(low, LimitName.SPINDLE_TORQUE).bound_at(10.0) == pytest.approx(81_200.0)
    assert named(low, LimitName.MOTOR_POWER).bound_at(12.5) == pytest.approx(7_500.0, rel=1e-3)
    assert named(middle, LimitName.MOTOR_POWER).bound_at(60.0) == pytest.approx(15_000.0)


def test_beyond_the_ends_of_the_curve_the_nearest_stretch_holds() -> None:
    assert segment_at(CARBIDE, 1e6).max_speed == pytest.approx(200.0)


def test_speed_range_is_what_tool_and_machine_share() -> None:
    """200 to 250 m/min on 12 mm: 88 to 110 rev/s, below 12 000 rpm."""
    low, high = speed_range(CUT, CARBIDE)
    assert low == pytest.approx(200_000.0 / 60.0 / (pi * 12.0))
    assert high == pytest.approx(250_000.0 / 60.0 / (pi * 12.0))
    slow = replace(CARBIDE.machine, spindle=replace(CARBIDE.machine.spindle, max_speed=100.0))
    assert speed_range(CUT, replace(CARBIDE, machine=slow))[1] == 100.0


def test_window_of_the_grade_goes_before_that_of_the_material() -> None:
    assert CARBIDE.grade is not None
    grade = replace(CARBIDE.grade, max_cutting_speed=1000.0)
    low, high = cutting_speed_window(replace(CARBIDE, grade=grade))
    assert high == 1000.0
    assert low == pytest.approx(200_000.0 / 60.0)


def test_material_of_constant_resistance_has_no_correction() -> None:
    assert force_factor(PAPER) == 1.0
    assert force_factor(replace(PAPER, force_factor=1.3)) == 1.3


def test_accepted_correction_multiplies_the_force() -> None:
    plain = force_load(CUT, CARBIDE).value(0.05, 3.0, 60.0)
    corrected = force_load(CUT, replace(CARBIDE, force_factor=1.2)).value(0.05, 3.0, 60.0)
    assert corrected == pytest.approx(1.2 * plain)


def test_positive_rake_cuts_easier() -> None:
    """One per cent a degree: 10 degrees more are 10 % less."""
    kienzle = replace(CARBIDE.material.kienzle, rake_angle=0.0)
    assert CARBIDE.grade is not None
    at = replace(CARBIDE, material=replace(CARBIDE.material, kienzle=kienzle))
    flat = replace(at, grade=replace(CARBIDE.grade, rake_angle=0.0))
    steep = replace(at, grade=replace(CARBIDE.grade, rake_angle=10.0 * pi / 180.0))
    assert force_factor(steep) == pytest.approx(0.9 * force_factor(flat))


DOWN = replace(
    DRILLED, tool=replace(MILL, point_angle=pi), tool_kind=ToolKind.ENDMILL, diameter=12.0
)
PLUNGED = replace(CUT, plunge=DOWN)


def straight_down(limits: Sequence[Limit]) -> dict[LimitName, Limit]:
    return {each.name: each for each in limits if each.words.endswith("straight down")}


def test_a_plunge_bears_half_the_feed_per_tooth_of_the_pass() -> None:
    along = named(limits_of(CUT, CARBIDE), LimitName.FEED_PER_TOOTH)
    down = straight_down(limits_of(PLUNGED, CARBIDE))[LimitName.FEED_PER_TOOTH]
    assert down.bound == pytest.approx(0.5 * along.bound)
    assert down.load.depth_exponent == 0.0


@pytest.mark.parametrize(("width", "share"), [(6.0, 0.5), (0.02, None), (0.001, 1.0)])
def test_half_the_feed_is_not_asked_where_the_edges_would_rub(
    width: float, share: float | None
) -> None:
    """Thin cuts along the pass need feed to make a chip; more than the pass bears none may."""
    cut = replace(PLUNGED, engagement=unidirectional(width, 12.0))
    limits = limits_of(cut, CARBIDE)
    down = straight_down(limits)[LimitName.FEED_PER_TOOTH].bound
    highest = named(limits_of(CUT, CARBIDE), LimitName.FEED_PER_TOOTH).bound
    if share is not None:
        assert down == pytest.approx(share * highest)
    else:
        chip = named(limits, LimitName.CHIP_THICKNESS, BoundSide.AT_LEAST)
        assert down == pytest.approx(chip.feed_at_bound(3.0, 60.0))
        assert 0.5 * highest < down < highest


def test_a_plunge_is_held_to_the_programmed_feed_where_nothing_says_what_is_borne() -> None:
    bare = replace(PAPER, material=replace(PAPER.material, max_feed_per_tooth=None))
    found = straight_down(limits_of(PLUNGED, bare))
    assert found[LimitName.PROGRAMMED_FEED].bound == CUT.programmed.feed


def test_a_plunge_presses_along_the_axis_as_a_drill_does() -> None:
    """The share of k_c·f·D/2 for lips square to the axis; k_c at h = f/z; no chisel edge."""
    thrust = straight_down(limits_of(PLUNGED, CARBIDE))[LimitName.CUTTING_FORCE]
    kienzle = CARBIDE.material.kienzle
    k_c = force_factor(CARBIDE) * kienzle.k_c11 * 0.05**-kienzle.m_c
    expected = 0.5 / sin(radians(59.0)) * k_c * 4 * 0.05 * 6.0
    assert thrust.load.value(0.05, 3.0, 60.0) == pytest.approx(expected)


def test_a_plunge_takes_torque_and_power_whatever_the_depth() -> None:
    """k_c·f·D²/8 for four lips in the solid."""
    segment = segment_at(CARBIDE, 60.0)
    found = straight_down(spindle_limits(PLUNGED, CARBIDE, segment))
    assert set(found) == {LimitName.MOTOR_POWER, LimitName.SPINDLE_TORQUE}
    kienzle = CARBIDE.material.kienzle
    k_c = force_factor(CARBIDE) * kienzle.k_c11 * 0.05**-kienzle.m_c
    expected = k_c * 4 * 0.05 * 12.0**2 / 8.0
    torque = found[LimitName.SPINDLE_TORQUE].load
    assert torque.value(0.05, 3.0, 60.0) == pytest.approx(expected)
    assert torque.value(0.05, 1.0, 60.0) == pytest.approx(expected)


def test_a_cut_without_a_plunge_has_no_limit_of_one() -> None:
    segment = segment_at(CARBIDE, 60.0)
    assert not straight_down(limits_of(CUT, CARBIDE))
    assert not straight_down(spindle_limits(CUT, CARBIDE, segment))
