"""No limit goes without a word: the tool's own limits, borrowed windows, unchecked limits."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from optimiser.advice import AdviceStatus, Plan
from optimiser.bounds.limits import allowance_limits, depth_limits, limits_of
from optimiser.bounds.required_limits import REQUIRED, unchecked_limits, why_impossible
from optimiser.bounds.speed_limits import borrowed_bound
from optimiser.cuts.cut import Cut
from optimiser.cuts.hardest_places import Bending, with_hardest
from optimiser.cuts.source import from_features
from optimiser.modes import Free
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask, problem_of, state_of
from optimiser.solver.problem import BoundSide, Limit, LimitName
from simulator.files.material_file import read_material
from simulator.library import load_machine, load_material
from simulator.physics.engagement import full_immersion
from simulator.removal.stations import StationKind
from simulator.spec import Certainty, CuttingMaterial, MaterialMatch, ToolKind, WorkMaterial
from simulator.tools.tool_table import grade_for
from stepnc_model.errors import Severity
from tests.every_case import every_case
from tests.optimiser.cuts.test_hardest_places import met
from tests.optimiser.plans import advice_of, after, edited
from tests.optimiser.sample_cuts import CARBIDE, CUT, DRILLED, TURNED, conditions, named, names

CASES = Path(__file__).parents[4] / "shared" / "cases" / "advice"
C45 = load_material("c45")
ALL_LIMITS = {LimitName.TOOL_DEFLECTION, LimitName.SHANK_STRENGTH, LimitName.MOTOR_POWER}


def advised(
    name: str, material: WorkMaterial, machine: str = "vmc15", *changes: tuple[str, str]
) -> Plan:
    match = MaterialMatch(material=material, certainty=Certainty.EXACT, reason="for the test")
    return optimise_program(
        edited(name, *changes),
        machine=load_machine(machine),
        material=match,
        task=OptimisationTask(source=from_features),
    )


def without_group(material: WorkMaterial) -> WorkMaterial:
    return replace(material, iso_group="")


def test_the_limits_of_the_tool_hold_without_a_group() -> None:
    """C45 with an empty group: no faster than C45, and told what is missing."""
    known, unknown = (advised("paper002", each) for each in (C45, without_group(C45)))
    (usual,), (advice,) = known.advices, unknown.advices
    assert {load.limit.name for load in after(advice).loads} >= ALL_LIMITS
    assert after(advice).feed <= after(usual).feed
    assert not known.unchecked
    assert {limit.name for _, limit in unknown.unchecked} == {
        LimitName.FEED_PER_TOOTH,
        LimitName.AXIAL_DEPTH,
    }
    assert all("iso_group" in limit.datum for _, limit in unknown.unchecked)
    told = [each for each in unknown.findings if each.severity is Severity.WARNING]
    assert any("ISO group S" in each.message for each in told)


def test_a_material_of_which_only_the_force_is_known_takes_the_widest_spread() -> None:
    bare = replace(without_group(C45), hardness_hb=None, windows=(), spread=0.25)
    (advice,) = advised("paper002", bare).advices
    assert {each.name for each in advice.unchecked} >= {
        LimitName.FEED_PER_TOOTH,
        LimitName.CUTTING_SPEED,
    }
    assert after(advice).setting.speed == advice.before.setting.speed  # type: ignore[union-attr]


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases are not beside this tree")
@every_case("name", ["c45_nogroup", "shop_steel"])
def test_files_without_a_group_raise_no_feed_silently(name: str) -> None:
    material = read_material(CASES / f"{name}.toml")
    usual, plan = advised("bracket", C45), advised("bracket", material)
    for known, advice in zip(usual.advices, plan.advices, strict=True):
        if advice.status is AdviceStatus.ADVISED and advice.before is not None:
            assert advice.unchecked, advice.workingstep.id
            usual_feed, feed = after(known).setting.feed, after(advice).setting.feed
            if after(known).setting.depth == after(advice).setting.depth:
                most = max(usual_feed, advice.before.setting.feed)
                assert feed <= most * (1.0 + 1e-9), advice.workingstep.id
            assert feed <= 1.0
    assert material.spread in {0.2, 0.25}
    assert material.youngs_modulus is not None


@every_case("name", ["hardened_55hrc", "hardened_60hrc", "chilled_iron"])
def test_high_speed_steel_in_hard_material_is_infeasible(name: str) -> None:
    plan = advised("paper002", load_material(name))
    (advice,) = plan.advices
    assert plan.is_infeasible
    assert advice.status is AdviceStatus.INFEASIBLE
    assert "high-speed steel" in advice.reason


def test_machines_with_only_stated_limits_add_nothing() -> None:
    (advice,) = advised("paper002", load_material("paper002"), "paper002").advices
    assert not advice.unchecked
    assert not ALL_LIMITS - {LimitName.MOTOR_POWER} & {
        load.limit.name for load in after(advice).loads
    }


def test_borrowed_windows_do_not_slow_a_program_down() -> None:
    """Group S allows 0.004 × 12 mm: what is programmed stays allowed."""
    grade = grade_for(ToolKind.ENDMILL, CuttingMaterial.HSS, without_group(C45))
    at = replace(
        CARBIDE, grade=grade, cutting_material=CuttingMaterial.HSS, material=without_group(C45)
    )
    fast = replace(CUT, programmed=replace(CUT.programmed, feed=0.2, depth=30.0))
    feed = named(limits_of(fast, at), LimitName.FEED_PER_TOOTH)
    assert feed.bound == 0.2
    assert "as programmed" in feed.origin
    assert "group S" in feed.origin
    slow = replace(CUT, programmed=replace(CUT.programmed, feed=0.01))
    assert named(limits_of(slow, at), LimitName.FEED_PER_TOOTH).bound == pytest.approx(0.048)


def test_an_own_window_is_no_borrowed_bound() -> None:
    assert borrowed_bound(0.1, 0.2, CARBIDE).bound == 0.1


def test_without_any_source_the_programmed_setting_is_the_cap() -> None:
    grade = grade_for(ToolKind.FACEMILL, CuttingMaterial.CERAMIC, C45)
    at = replace(CARBIDE, grade=grade, cutting_material=CuttingMaterial.CERAMIC)
    cut = replace(CUT, tool_kind=ToolKind.FACEMILL)
    limits = limits_of(cut, replace(at, material=replace(C45, windows=())))
    assert named(limits, LimitName.PROGRAMMED_FEED).bound == cut.programmed.feed
    assert named(limits, LimitName.AXIAL_DEPTH).bound == cut.programmed.depth
    assert {each.name for each in unchecked_limits(cut, at, limits)} >= {
        LimitName.FEED_PER_TOOTH,
        LimitName.CUTTING_SPEED,
        LimitName.AXIAL_DEPTH,
    }


def test_every_kind_of_tool_has_its_required_limits() -> None:
    assert set(REQUIRED) == set(ToolKind)


@every_case(
    ("edge", "width", "ratio"),
    [
        (CuttingMaterial.CARBIDE, 1.0, 1.0),
        (CuttingMaterial.CARBIDE, 0.75, 1.5),
        (CuttingMaterial.CARBIDE, 0.5, 2.0),
        (CuttingMaterial.HSS, 1.0, 0.5),
        (CuttingMaterial.HSS, 0.5, 1.5),
    ],
)
def test_a_slot_is_no_deeper_than_its_catalogue_allows(
    edge: CuttingMaterial, width: float, ratio: float
) -> None:
    """Carbide 1 × D (Widia), high-speed steel 0.5 × D (Dormer Pramet); beside it as printed."""
    grade = grade_for(ToolKind.ENDMILL, edge, C45)
    at = replace(CARBIDE, grade=grade, cutting_material=edge)
    cut = replace(CUT, radial_width=12.0 * width, engagement=full_immersion(), depth_bound=None)
    (limit,) = depth_limits(cut, at)
    assert limit.bound == pytest.approx(12.0 * ratio)


def test_the_feed_of_a_centre_drill_is_that_of_its_pilot() -> None:
    """DIN 333: a body of 10 mm has a pilot of 4 mm; carbide in steel 0.02 × 4 mm a turn."""
    cut = replace(DRILLED, tool_kind=ToolKind.CENTER_DRILL)
    at = conditions(ToolKind.CENTER_DRILL)
    assert named(limits_of(cut, at), LimitName.FEED_PER_TOOTH).bound == pytest.approx(0.04)


def test_ratios_of_the_diameter_end_at_both_ends() -> None:
    """At D 160 the least feed is that of 20 mm; at D 0.3 the edge is sharp enough for it."""
    limits = {
        diameter: limits_of(resized(diameter), CARBIDE) for diameter in (0.3, 20.0, 160.0)
    }
    least = [named_label(limits[diameter], "against rubbing") for diameter in (20.0, 160.0)]
    assert least[0] == pytest.approx(least[1])
    most = named(limits[0.3], LimitName.FEED_PER_TOOTH).bound
    chip = named(limits[0.3], LimitName.CHIP_THICKNESS, BoundSide.AT_LEAST)
    assert chip.feed_at_bound(1.0, 1.0) <= most


def resized(diameter: float) -> Cut:
    return replace(
        CUT,
        diameter=diameter,
        tool=replace(CUT.tool, diameter=diameter, corner_radius=None),
        radial_width=0.5 * diameter,
    )


def named_label(limits: tuple[Limit, ...], words: str) -> float:
    (found,) = (each for each in limits if words in each.words)
    return found.bound


@every_case(
    ("before", "is_too_much", "is_too_little"),
    [(9.8, False, False), (8.0, True, False), (9.98, False, True)],
)
def test_what_a_reamer_takes_off_is_checked(
    before: float, *, is_too_much: bool, is_too_little: bool
) -> None:
    """Ø10: 0.2 to 0.3 mm on the diameter."""
    cut = replace(DRILLED, tool_kind=ToolKind.REAMER, previous_diameter=before)
    broken = {
        limit.sense
        for limit in allowance_limits(cut, conditions(ToolKind.REAMER))
        if not limit.holds(1.0, 1.0, 1.0)
    }
    assert (BoundSide.AT_MOST in broken) is is_too_much
    assert (BoundSide.AT_LEAST in broken) is is_too_little


def test_a_reamer_with_two_millimetres_to_take_off_is_impossible() -> None:
    cut = replace(DRILLED, tool_kind=ToolKind.REAMER, previous_diameter=8.0)
    why = why_impossible(cut, conditions(ToolKind.REAMER), cut.tool)
    assert "reaming allowance 2 mm exceeds 0.3 mm" in why
    good = replace(cut, previous_diameter=9.8)
    assert not why_impossible(good, conditions(ToolKind.REAMER), cut.tool)


def test_a_reamer_without_a_known_hole_lists_its_allowance_as_unchecked() -> None:
    cut, at = replace(DRILLED, tool_kind=ToolKind.REAMER), conditions(ToolKind.REAMER)
    (found,) = unchecked_limits(cut, at, limits_with_power(cut))
    assert found.name is LimitName.ALLOWANCE


def limits_with_power(cut: Cut) -> tuple[Limit, ...]:
    at = conditions(cut.tool_kind)
    problem = problem_of(cut, at, OptimisationTask(free=frozenset(Free)))
    return tuple(load.limit for load in state_of(cut, problem, at, cut.programmed).loads)


def test_the_deepest_place_of_a_turning_path_keeps_the_depth_of_the_insert() -> None:
    """0.5 mm along the bar, 4 mm at a shoulder with a thin chip; hard steel allows 0.5 mm."""
    path = met(
        [(0.1, 0.5, 0.0, 0.0), (0.1, 4.0, 0.0, 0.0)],
        kind=StationKind.TURNING,
        chips=(0.01, 0.9),
    )
    finish = replace(
        TURNED, is_depth_free=False, programmed=replace(TURNED.programmed, depth=0.5)
    )
    nothing = Bending(at=np.zeros(0, dtype=np.int64), shank=np.zeros(0), wall=np.zeros(0))
    cut = with_hardest(finish, path, C45.kienzle, depth=0.5, bent=nothing)
    at = conditions(ToolKind.TURNING)
    hard = grade_for(ToolKind.TURNING, CuttingMaterial.CARBIDE, load_material("hardened_55hrc"))
    held = replace(at, grade=hard)
    limits = limits_of(cut, held)
    limit = named(limits, LimitName.PROGRAMMED_FEED)
    assert limit.bound == cut.programmed.feed
    assert "4 mm deep at a shoulder" in limit.origin
    assert LimitName.AXIAL_DEPTH in {each.name for each in unchecked_limits(cut, held, limits)}
    rough = replace(cut, is_depth_free=True)
    depth = named(limits_of(rough, held), LimitName.AXIAL_DEPTH)
    assert depth.load.value(1.0, 0.5, 1.0) == pytest.approx(4.0)


def test_a_depth_far_beyond_the_estimate_is_a_risk_with_its_numbers() -> None:
    plan = advised("bracket", C45)
    advice = advice_of(plan, "ROUGH POCKET")
    risk = advice.chatter_risk
    assert risk is not None
    assert risk.depth == after(advice).setting.depth > risk.stable
    told = [each for each in plan.findings if "risk of chatter" in each.message]
    assert told
    assert {each.severity for each in told} == {Severity.WARNING}


def test_the_windows_of_c45_are_checked() -> None:
    assert LimitName.FEED_PER_TOOTH in names(limits_of(CUT, CARBIDE))
    assert not advised("bracket", C45).unchecked
