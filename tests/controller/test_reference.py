from dataclasses import replace
from functools import cache
from math import inf, pi
from pathlib import Path

import pytest

from controller.reference import (
    BREAKAGE_RATIO,
    RUPTURE_RATIO,
    ForceBound,
    Reference,
    reference_of,
)
from optimiser.advice import Advice, EvaluatedSetting, LimitLoad
from optimiser.bounds.loads import cutting_force, shank_force, wall_force
from optimiser.cuts.source import from_features
from optimiser.modes import Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import BoundSide, Limit, LimitName, Monomial
from simulator.library import load_machine, match_material
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.every_case import every_case

PARTS = Path(__file__).parents[2] / "examples" / "parts"
VMC = load_machine("vmc15")


@cache
def advices(part: str, machine: str = "vmc15") -> dict[str, Advice]:
    """What is said of a part in C45 as it is programmed, by the workingstep's name."""
    text = (PARTS / f"{part}.stpnc").read_bytes()
    plan = optimise_program(
        Program(Part21File.from_bytes(text, name=part), name=part),
        machine=load_machine(machine),
        material=match_material(["C45"]),
        task=OptimisationTask(mode=Mode.TC, safety=0.5, free=frozenset(), source=from_features),
    )
    return {advice.workingstep.id: advice for advice in plan.advices}


def state(advice: Advice) -> EvaluatedSetting:
    assert advice.before is not None
    return advice.before


def bounds(reference: Reference) -> dict[LimitName, float]:
    """Least of each name, N."""
    return {each.name: each.force for each in reversed(reference.bounds)}


def loads(
    advice: Advice, name: LimitName, sense: BoundSide = BoundSide.AT_MOST
) -> list[LimitLoad]:
    return [
        load
        for load in state(advice).loads
        if load.limit.name is name and load.limit.sense is sense
    ]


MILLED = [
    ("paper002", "ROUGH THE FACE"),
    ("bracket", "ROUGH FACE"),
    ("bracket", "ROUGH CONTOUR"),
    ("bracket", "MILL SLOT"),
    ("bracket", "ROUGH OPEN POCKET"),
]


@pytest.mark.parametrize(("part", "name"), MILLED)
def test_a_bound_is_the_force_at_the_feed_that_reaches_the_limit(part: str, name: str) -> None:
    """The other way round: the feed of each limit first, then Kienzle's force at it."""
    advice = advices(part)[name]
    at = state(advice).setting
    (force,) = loads(advice, LimitName.CUTTING_FORCE)
    found = bounds(reference_of(advice))
    assert len(found) >= 3
    for limit, bound in found.items():
        (load,) = loads(advice, limit)
        feed = load.limit.feed_at_bound(at.depth, at.speed)
        assert bound == pytest.approx(force.limit.load.value(feed, at.depth, at.speed))


def test_the_shank_is_bound_by_the_peak_and_the_deflection_by_the_force_at_the_wall() -> None:
    """Bounds over their loads' forces are those that the plan has."""
    advice = advices("bracket")["ROUGH CONTOUR"]
    assert advice.cut is not None
    at = state(advice).setting
    law = match_material(["C45"]).material.kienzle
    shank = shank_force(advice.cut, law, 1.0).value(at.feed, at.depth, at.speed)
    wall = wall_force(advice.cut, law, 1.0)
    assert wall is not None
    normal = wall.value(at.feed, at.depth, at.speed)
    mean = cutting_force(advice.cut, law, 1.0).value(at.feed, at.depth, at.speed)
    for each in reference_of(advice).bounds:
        is_wall = each.name is LimitName.TOOL_DEFLECTION
        is_peak = each.name is LimitName.SHANK_STRENGTH
        assert each.wall == pytest.approx(each.force * normal / mean if is_wall else 0.0)
        assert each.peak == pytest.approx(each.force * shank / mean if is_peak else 0.0)
        assert each.is_mean is not (is_wall or is_peak)


def test_power_is_reached_at_the_force_that_it_gives_at_the_cutting_speed() -> None:
    """35 m/min: F = P·η/v_c."""
    advice = advices("paper002")["ROUGH THE FACE"]
    (power,) = loads(advice, LimitName.MOTOR_POWER)
    force = 1000.0 * power.bound * VMC.spindle.efficiency / (35_000.0 / 60.0)
    assert bounds(reference_of(advice))[LimitName.MOTOR_POWER] == pytest.approx(force)


def test_torque_is_reached_at_the_force_that_it_gives_at_the_radius() -> None:
    advice = advices("paper002")["ROUGH THE FACE"]
    (torque,) = loads(advice, LimitName.SPINDLE_TORQUE)
    diameter = 35_000.0 / 60.0 / (pi * state(advice).setting.speed)
    found = bounds(reference_of(advice))[LimitName.SPINDLE_TORQUE]
    assert found == pytest.approx(torque.bound / (0.5 * diameter))


def test_bounds_come_least_first_and_the_shank_tells_the_strength() -> None:
    reference = reference_of(advices("bracket")["ROUGH CONTOUR"])
    found = [each.force for each in reference.bounds]
    assert found == sorted(found)
    assert reference.breakage == RUPTURE_RATIO * bounds(reference)[LimitName.SHANK_STRENGTH]


def test_without_a_shank_the_strength_is_thrice_the_least_bound() -> None:
    reference = reference_of(advices("bracket")["ROUGH FACE"])
    assert LimitName.SHANK_STRENGTH not in bounds(reference)
    assert reference.breakage == BREAKAGE_RATIO * reference.bounds[0].force


def test_the_ceiling_is_that_of_the_chip_load() -> None:
    """0.35 mm a tooth where 0.1 mm are programmed."""
    assert reference_of(advices("bracket")["ROUGH FACE"]).ceiling == pytest.approx(3.5)


def test_the_ceiling_of_a_finished_bar_is_that_of_its_roughness() -> None:
    """c·f² + e = Ra, solved for the feed of 0.12 mm times the override."""
    advice = advices("shaft", "lathe22")["FINISH CONTOUR"]
    (load,) = loads(advice, LimitName.ROUGHNESS)
    monomial = load.limit.load
    feed = ((load.bound - monomial.offset) / monomial.coefficient) ** 0.5
    assert load.bound == 1.6e-3
    assert reference_of(advice).ceiling == pytest.approx(feed / 0.12)


def test_the_floor_is_that_of_the_catalogue_and_the_least_that_of_the_thinnest_chip() -> None:
    advice = advices("bracket")["ROUGH FACE"]
    (chip,) = loads(advice, LimitName.CHIP_THICKNESS, BoundSide.AT_LEAST)
    (feed,) = loads(advice, LimitName.FEED_PER_TOOTH, BoundSide.AT_LEAST)
    found = reference_of(advice)
    assert found.least == pytest.approx(chip.bound / chip.value)
    assert found.floor == pytest.approx(feed.bound / feed.value)


def test_a_program_below_the_catalogue_s_least_feed_has_the_least_chip_for_a_floor() -> None:
    advice = advices("bracket")["FINISH FACE"]
    (feed,) = loads(advice, LimitName.FEED_PER_TOOTH, BoundSide.AT_LEAST)
    assert feed.bound > feed.value
    found = reference_of(advice)
    assert 0.0 < found.floor == found.least < 1.0


def roughness(bound: float) -> LimitLoad:
    """Of 0.001·f² and an offset of 0.0004 mm."""
    monomial = Monomial(coefficient=1e-3, offset=4e-4, feed_exponent=2.0)
    limit = Limit(name=LimitName.ROUGHNESS, load=monomial, bound=bound, unit="µm")
    return LimitLoad(limit=limit, value=5e-4, bound=bound)


def test_a_roughness_that_no_feed_attains_does_not_stop_the_feed() -> None:
    advice = advices("paper002")["ROUGH THE FACE"]
    before = state(advice)
    hopeless = replace(before, loads=(*before.loads, roughness(3e-4)))
    assert reference_of(replace(advice, before=hopeless)).ceiling == 1.0


def test_a_roughness_that_only_a_rubbing_edge_attains_does_not_bind_either() -> None:
    advice = advices("paper002")["ROUGH THE FACE"]
    before = state(advice)
    rubbing = replace(before, loads=(*before.loads, roughness(4e-4 + 1e-12)))
    reference = reference_of(replace(advice, before=rubbing))
    assert reference.ceiling == 1.0
    assert reference.floor == reference_of(advice).floor


def test_a_floor_that_is_swept_with_the_walls_is_bound_by_its_own_force() -> None:
    """The same cutter bends as far at the floor's own force as at the walls'."""
    advice = advices("bracket")["FINISH POCKET"]
    assert advice.cut is not None
    assert advice.cut.floor is not None
    at = state(advice).setting
    walls, floor = loads(advice, LimitName.CUTTING_FORCE)
    assert floor.value < 0.5 * walls.value
    _, bent = loads(advice, LimitName.TOOL_DEFLECTION)
    feed = bent.limit.feed_at_bound(at.depth, at.speed)
    expected = floor.limit.load.value(feed, at.depth, at.speed)
    found = [
        each.force
        for each in reference_of(advice).bounds
        if each.name is LimitName.TOOL_DEFLECTION
    ]
    assert found[-1] == pytest.approx(expected)


def test_a_drills_thrust_is_told_as_the_force_at_its_edges() -> None:
    advice = advices("bracket")["DRILL HOLE 1"]
    (thrust,) = loads(advice, LimitName.CUTTING_FORCE)
    constant = thrust.limit.load.offset
    assert 0.0 < constant < 0.5 * thrust.value
    left = (thrust.bound - constant) / (thrust.value - constant)
    expected = state(advice).cutting_force * left
    assert bounds(reference_of(advice))[LimitName.CUTTING_FORCE] == pytest.approx(expected)


def test_the_program_may_inhibit_the_override() -> None:
    found = advices("bracket")
    assert reference_of(found["REAM HOLE 1"]).inhibition == "inhibit_feedrate_override"
    assert reference_of(found["ROUGH FACE"]).inhibition == ""


def test_the_feed_of_a_thread_is_its_pitch() -> None:
    advice = advices("shaft", "lathe22")["THREAD M30 X 2"]
    allowed = replace(advice.programmed, inhibition="")
    thread = reference_of(replace(advice, programmed=allowed))
    assert thread.inhibition == "the feed is bound to the pitch of the thread"
    assert thread.bounds == ()
    assert (thread.floor, thread.ceiling, thread.breakage) == (0.0, inf, inf)


def test_the_share_of_the_motors_power_moves_only_its_bound() -> None:
    power = ForceBound(name=LimitName.MOTOR_POWER, words="motor power", force=1000.0)
    bending = ForceBound(name=LimitName.TOOL_DEFLECTION, words="deflection", force=800.0)
    reference = Reference(workingstep="x", bounds=(bending, power))
    assert reference.bound() == bending
    assert reference.bound(power_factor=0.5) == replace(power, force=500.0)
    assert Reference(workingstep="x").bound(power_factor=0.5) is None


@every_case("change", [{"ceiling": 0.0}, {"breakage": 0.0}, {"floor": -0.1}])
def test_impossible_references_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        Reference(workingstep="x", **change)  # type: ignore[arg-type]
