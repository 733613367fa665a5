"""The feed on the way down into the material."""

from dataclasses import replace
from math import pi, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.advice import Advice
from optimiser.bounds.limits import PLUNGE_FEED_RATIO
from optimiser.bounds.plunge_feed import CAUTIOUS_FEED_RATIO, plunge_limits, with_plunge_feed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, PlungeEngagement
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import LimitName
from simulator.physics.drilling import DrillingCut, drilling_torque, lip_thrust
from tests.optimiser.plans import advice_of, after, before, measured
from tests.optimiser.sample_cuts import CARBIDE, CUT, PAPER

ISCAR = 0.01
"""feed per tooth over the diameter of carbide end mills in steel, ISCAR's table"""

DOWN = replace(CUT, way_in=PlungeEngagement(drilled=(CUT.as_drill,), reaches_axis=True))
SINE = sin(radians(3.0))
SLOPE = PlungeEngagement(ramp=replace(CUT.bare, engagement=CUT.engagement), sine=SINE)
RAMPED = replace(CUT, way_in=SLOPE)
KNOWN = replace(CARBIDE, centre_cutting=True)
OPEN = ("ROUGH OPEN POCKET", "FINISH OPEN POCKET")
RAMP = ("'ROUGH OPEN POCKET',10.,$,#430,#305,#330,5.,#340,",
        "'ROUGH OPEN POCKET',10.,$,#430,#305,#330,5.,#342,")  # fmt: skip


def plunge_feed(cut: Cut, at: CuttingConditions, speed: float = CUT.programmed.speed) -> float:
    found = with_plunge_feed(cut, at, replace(cut.programmed, speed=speed)).plunge_feed
    assert found is not None
    return found


def weak(at: CuttingConditions, force: float) -> CuttingConditions:
    return replace(at, machine=replace(at.machine, max_cutting_force=force))


def drilled_at(feed: float) -> DrillingCut:
    """The mill of 12 mm with four flat lips as a drill of the textbooks."""
    return DrillingCut(
        feed_per_revolution=4.0 * feed,
        tool_diameter=12.0,
        teeth=4,
        cutting_edge_angle=0.5 * pi,
    )


def of(
    name: str,
    task: OptimisationTask = OptimisationTask(),  # noqa: B008 (frozen)
    *changes: tuple[str, str],
) -> Advice:
    return advice_of(measured("bracket", task, *changes), name)


def own_feed(advice: Advice) -> float:
    feed = after(advice).setting.plunge_feed
    assert feed is not None
    return feed


def test_one_feed_for_plunge_and_cut_up_to_half_the_feed_per_tooth_vertically() -> None:
    """Each has its own: the pass of a pocket feeds as fast whatever way leads down to it."""
    plunged, ramped = (
        of("ROUGH OPEN POCKET"),
        advice_of(measured("bracket", OptimisationTask(), RAMP), "ROUGH OPEN POCKET"),
    )
    assert own_feed(plunged) == pytest.approx(CAUTIOUS_FEED_RATIO * ISCAR * 10.0)
    assert after(plunged).setting.feed == pytest.approx(after(ramped).setting.feed, rel=0.02)
    assert after(plunged).setting.feed > own_feed(plunged)
    assert own_feed(ramped) > own_feed(plunged)
    assert before(plunged).plunge_feed == before(plunged).feed


def test_a_cutter_that_is_known_to_cut_over_centre_plunges_at_half_the_feed() -> None:
    task = OptimisationTask(centre_cutting={"END MILL 10MM": True})
    for name in OPEN:
        advice = of(name, task)
        assert own_feed(advice) == pytest.approx(PLUNGE_FEED_RATIO * ISCAR * 10.0)
        assert after(advice).setting.feed == after(of(name)).setting.feed
        assert after(advice).time < after(of(name)).time


@pytest.mark.parametrize("mode", [Mode.QC, Mode.EC])
def test_every_mode_plunges_alike(mode: Mode) -> None:
    for name in OPEN:
        assert own_feed(of(name, OptimisationTask(mode=mode))) == own_feed(of(name))


def test_a_held_feed_holds_the_plunge_too() -> None:
    state = after(of("ROUGH OPEN POCKET", OptimisationTask(free=frozenset({Free.DEPTH}))))
    assert state.setting.plunge_feed == state.setting.feed == pytest.approx(0.03)


@given(st.floats(100.0, 3000.0), st.sampled_from([1.0, 1.263]))
def test_thrust_bounds_the_plunge_feed(force: float, safety: float) -> None:
    at = weak(replace(KNOWN, safety_factor=safety), force)
    feed = plunge_feed(DOWN, at)
    factor = safety * at.force_factor
    thrust = factor * lip_thrust(at.material.kienzle, drilled_at(feed))
    assert thrust <= force * 1.05  # the rake of the grade makes the cut a little easier
    if feed < PLUNGE_FEED_RATIO * ISCAR * 12.0 * (1.0 - 1e-9):
        assert thrust == pytest.approx(force, rel=0.1)


def test_torque_and_power_of_the_plunge_bound_it_at_its_speed() -> None:
    """A slow spindle has no more than its torque, a fast one no more than its power."""
    for speed in (0.5, 200.0):
        limits = {each.name: each for each in plunge_limits(DOWN, KNOWN, speed)}
        feed = 0.02
        moment = drilling_torque(KNOWN.material.kienzle, drilled_at(feed))
        power = limits[LimitName.MOTOR_POWER].load.value(feed, 1.0, speed)
        efficiency = KNOWN.machine.spindle.efficiency
        assert power == pytest.approx(2.0 * pi * speed * moment / 1e3 / efficiency, rel=0.1)


def test_half_a_section_takes_half_the_thrust() -> None:
    half = replace(CUT.as_drill, fill=0.5)
    loads = [
        {
            each.name: each.load.value(0.02, 1.0, 50.0)
            for each in plunge_limits(cut, KNOWN, 50.0)
        }
        for cut in (
            DOWN,
            replace(DOWN, way_in=PlungeEngagement(drilled=(half,), reaches_axis=True)),
        )
    ]
    for name in (LimitName.CUTTING_FORCE, LimitName.MOTOR_POWER):
        assert loads[1][name] == pytest.approx(0.5 * loads[0][name])


def test_what_is_planed_off_beside_the_axis_keeps_the_feed_of_the_catalogue() -> None:
    beside = replace(CUT, way_in=PlungeEngagement(drilled=(CUT.as_drill,)))
    assert plunge_feed(beside, CARBIDE) == pytest.approx(ISCAR * 12.0)


def test_the_part_of_a_ramps_feed_along_the_axis_is_a_plunge() -> None:
    steep = replace(RAMPED, way_in=replace(SLOPE, sine=sin(radians(60.0))))
    feed = plunge_feed(steep, CARBIDE)
    assert feed * sin(radians(60.0)) == pytest.approx(CAUTIOUS_FEED_RATIO * ISCAR * 12.0)
    assert plunge_feed(RAMPED, CARBIDE) > feed


def test_the_rest_of_a_ramps_feed_is_bounded_as_a_pass_is() -> None:
    """At 3° the axial part is a twentieth: what bends the tool holds the ramp."""
    plain = plunge_feed(RAMPED, CARBIDE)
    bent = replace(CARBIDE, deflection=replace(CARBIDE.deflection, value=1e-3))
    assert plunge_feed(RAMPED, bent) < 0.2 * plain


def test_a_ramp_thrusts_by_its_part_along_the_axis() -> None:
    thrusts = [
        each
        for each in plunge_limits(RAMPED, CARBIDE, 50.0)
        if each.words == "thrust down the ramp"
    ]
    load = thrusts[0].load.value(0.1, 3.0, 50.0)
    down = lip_thrust(CARBIDE.material.kienzle, drilled_at(0.1 * SINE))
    assert load == pytest.approx(down, rel=0.1)


def test_no_catalogue_leaves_what_is_programmed() -> None:
    at = replace(PAPER, machine=replace(PAPER.machine, max_feed=None))
    at = replace(at, material=replace(at.material, max_feed_per_tooth=None))
    assert plunge_feed(DOWN, at) <= DOWN.programmed.feed


def test_a_cut_without_a_way_down_has_no_plunge_feed() -> None:
    assert with_plunge_feed(CUT, CARBIDE, CUT.programmed) == CUT.programmed
    assert plunge_limits(CUT, CARBIDE, 50.0) == ()
