"""Which modes hold for a cut, what they bound, and what is only estimated."""

from dataclasses import replace
from math import inf, pi

import pytest

from optimiser.bounds.stability import (
    FREQUENCY_TOLERANCE,
    Basis,
    Stability,
    estimate_texts,
    stability_limits,
    stability_of,
)
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.cuts.source import from_features
from optimiser.modes import Free
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask, problem_of
from optimiser.solver.problem import LimitName
from simulator.library import find_grade, load_machine, load_material, match_material
from simulator.physics.cutting import chip_stiffness
from simulator.physics.engagement import mean_chip_ratio, unidirectional
from simulator.physics.stability import DynamicCut, ModalStructure, least_stable_depth
from simulator.physics.turning_stability import orthogonal_limit
from simulator.spec import (
    CuttingMaterial,
    Machine,
    ModeDirection,
    ToolKind,
    VibratingPart,
    VibrationMode,
)
from tests.every_case import every_case
from tests.optimiser.plans import ALL_FREE, advice_of, after, edited
from tests.optimiser.sample_cuts import CARBIDE, CUT, DRILLED, MILL, PAPER, TURNED

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="MILL",
    direction=ModeDirection.XY,
    natural_frequency=900.0,
    damping_ratio=0.03,
    stiffness=12_000.0,
    source="tap test",
)
ALUMINIUM = replace(
    CARBIDE,
    material=load_material("al7075"),
    grade=find_grade(ToolKind.ENDMILL, CuttingMaterial.CARBIDE, "N"),
)


def on(*modes: VibrationMode, at: CuttingConditions = CARBIDE) -> CuttingConditions:
    return replace(at, machine=replace(at.machine, modes=modes))


def known(cut: Cut, at: CuttingConditions) -> Stability:
    found = stability_of(cut, at)
    assert found is not None
    return found


def test_without_modes_nothing_is_bounded_and_an_estimate_is_told() -> None:
    assert stability_limits(CUT, CARBIDE) == ()
    found = known(CUT, CARBIDE)
    assert found.basis is Basis.ESTIMATED
    assert found.least is not None
    assert found.band is not None
    assert found.band[0] <= found.least <= found.band[1]
    assert "overhang of 36 mm" in found.reason


def test_a_face_mill_is_estimated_without_an_overhang() -> None:
    assert (
        "usual tools (10 N/µm"
        in known(replace(CUT, tool_kind=ToolKind.FACEMILL), CARBIDE).reason
    )


@pytest.mark.parametrize("name", ["paper000", "paper002", "paper003"])
def test_machines_and_materials_of_papers_keep_their_limits_alone(name: str) -> None:
    assert stability_of(CUT, PAPER) is None
    assert stability_of(CUT, replace(CARBIDE, machine=load_machine(name))) is None


def test_drills_and_lathes_without_modes_have_no_statement() -> None:
    assert stability_of(DRILLED, CARBIDE) is None
    assert stability_limits(DRILLED, on(MODE)) == ()
    assert stability_of(TURNED, CARBIDE) is None


def test_measured_modes_bound_the_depth_by_speed() -> None:
    at = on(MODE, at=ALUMINIUM)
    (limit,) = stability_limits(CUT, at)
    assert limit.name is LimitName.STABILITY
    assert limit.curve is not None
    dynamic = DynamicCut(
        engagement=unidirectional(6.0, 12.0),
        teeth=4,
        stiffness=767.0,
        radial_ratio=168.8 / 767.0,
    )
    least = least_stable_depth(dynamic, ModalStructure(x=(MODE,), y=(MODE,)))
    assert min(limit.curve.bounds) == pytest.approx(least, rel=1e-3)
    found = known(CUT, at)
    assert (found.basis, found.reason) == (Basis.MEASURED, "1 measured mode")
    assert found.least == pytest.approx(least)


def test_a_measured_linear_edge_gives_the_stiffness_else_the_slope_of_kienzle() -> None:
    """C45 has no linear edge: 0.75·k_c1.1 at the mean chip of the least recommended feed."""
    material = load_material("c45")
    assert material.linear_edge is None
    ratio = material.min_feed_per_tooth_ratio
    grade = CARBIDE.grade
    assert ratio is not None
    assert grade is not None
    assert grade.min_feed_ratio is not None
    feed = 12.0 * min(ratio, grade.min_feed_ratio)
    assert CUT.engagement is not None
    kienzle = material.kienzle
    stiffness = chip_stiffness(
        feed * mean_chip_ratio(CUT.engagement), k_c11=kienzle.k_c11, m_c=kienzle.m_c
    )
    dynamic = DynamicCut(
        engagement=CUT.engagement, teeth=4, stiffness=stiffness, radial_ratio=0.3
    )
    expected = least_stable_depth(dynamic, ModalStructure(x=(MODE,), y=(MODE,)))
    assert known(CUT, on(MODE)).least == pytest.approx(expected)


def test_the_bound_does_not_move_with_the_programmed_feed() -> None:
    other = replace(CUT, programmed=replace(CUT.programmed, feed=0.02))
    assert stability_limits(other, on(MODE)) == stability_limits(CUT, on(MODE))


def test_a_correction_of_the_force_lowers_the_depth() -> None:
    harder = replace(on(MODE), force_factor=1.25)
    least, lower = known(CUT, on(MODE)).least, known(CUT, harder).least
    assert least is not None
    assert lower == pytest.approx(least / 1.25)


def test_stock_left_above_counts_in_the_depth() -> None:
    (limit,) = stability_limits(replace(CUT, depth_share=1.5), on(MODE))
    assert limit.load.value(1.0, 2.0, 1.0) == 3.0


@every_case(
    ("tool", "diameter", "holds"),
    [
        ("mill", None, True),
        (" MILL ".strip(), 12.0, True),
        ("mill", 10.0, False),
        ("another", None, False),
        ("", 12.0, True),
        ("", 10.0, False),
    ],
)
def test_a_mode_holds_for_the_tool_that_was_tapped(
    tool: str, diameter: float | None, holds: bool
) -> None:
    mode = replace(MODE, tool=tool, tool_diameter=diameter)
    assert bool(stability_limits(CUT, on(mode))) is holds


def test_modes_that_name_the_tool_come_before_those_of_its_diameter() -> None:
    by_diameter = replace(MODE, tool="", tool_diameter=12.0, stiffness=1_000.0)
    assert stability_limits(CUT, on(MODE, by_diameter)) == stability_limits(CUT, on(MODE))


def test_the_workpiece_gives_beside_the_tool_and_alone() -> None:
    work = replace(MODE, part=VibratingPart.WORKPIECE, tool="", stiffness=3_000.0)
    both, alone, tool = (known(CUT, on(*modes)) for modes in ((MODE, work), (work,), (MODE,)))
    assert both.least is not None
    assert alone.least is not None
    assert tool.least is not None
    assert both.least < min(alone.least, tool.least)
    assert "tool taken as rigid" in alone.reason


def test_a_direction_without_modes_is_told() -> None:
    found = known(CUT, on(replace(MODE, direction=ModeDirection.X)))
    assert found.reason == "1 measured mode, y taken as rigid"


def test_a_mode_along_the_spindle_does_not_bound_a_mill() -> None:
    assert stability_limits(CUT, on(replace(MODE, direction=ModeDirection.Z))) == ()


def test_thin_cuts_are_not_judged_by_zero_order() -> None:
    thin = replace(CUT, engagement=unidirectional(1.1, 12.0))
    for at in (CARBIDE, on(MODE)):
        assert stability_limits(thin, at) == ()
        found = known(thin, at)
        assert found.basis is Basis.NOT_USED
        reason = "a_e/D 0.092 is below 0.1, where the zero-order model is not used"
        assert found.reason == reason


def test_below_a_short_wave_the_flank_damps_and_nothing_bounds() -> None:
    """0.5 mm · 40 kHz / (π·12 mm) = 531 rev/s, above all that the spindle turns."""
    fast = replace(MODE, natural_frequency=40_000.0)
    assert stability_limits(CUT, on(fast)) == ()
    found = known(CUT, on(fast))
    assert found.basis is Basis.NOT_USED
    assert found.reason.startswith("process damping below 31831 rpm")


def test_lobes_begin_where_damping_ends() -> None:
    mode = replace(MODE, natural_frequency=6_000.0)
    (limit,) = stability_limits(CUT, on(mode))
    assert limit.curve is not None
    damped = 0.5 * 6_000.0 / (pi * 12.0)
    assert limit.curve.speeds[0] == pytest.approx(damped)
    assert limit.bound_at(0.99 * damped) == inf


def test_lobes_bear_a_frequency_that_is_a_little_off() -> None:
    (limit,) = stability_limits(CUT, on(MODE))
    softer = replace(
        MODE, natural_frequency=MODE.natural_frequency * (1.0 - FREQUENCY_TOLERANCE)
    )
    (drifted,) = stability_limits(CUT, on(softer))
    assert limit.curve is not None
    for speed in limit.curve.speeds[200:-200:50]:
        # The drifted lobes bear 1 % themselves: at the speed that is theirs, both see one lobe.
        assert (
            limit.bound_at(speed)
            <= drifted.bound_at(speed * (1.0 - FREQUENCY_TOLERANCE)) * 1.02
        )


def test_turning_is_bounded_by_one_depth_at_any_speed() -> None:
    mode = replace(MODE, tool="insert", direction=ModeDirection.Z, stiffness=25_000.0)
    at = replace(
        on(mode, at=replace(CARBIDE, machine=load_machine("lathe22"))),
        grade=find_grade(ToolKind.TURNING, CuttingMaterial.CARBIDE, "P"),
    )
    (limit,) = stability_limits(TURNED, at)
    assert limit.curve is None
    assert 0.1 < limit.bound < 20.0
    assert known(TURNED, at).least == pytest.approx(limit.bound)
    stiffer = replace(mode, stiffness=50_000.0)
    (wider,) = stability_limits(
        TURNED, replace(at, machine=replace(at.machine, modes=(stiffer,)))
    )
    assert wider.bound == pytest.approx(2.0 * limit.bound)
    assert orthogonal_limit((), (mode,), stiffness=1.0) / limit.bound > 100.0


def test_turning_slower_than_a_short_wave_is_damped() -> None:
    mode = replace(MODE, tool="insert", direction=ModeDirection.Z, natural_frequency=30_000.0)
    at = on(mode, at=replace(CARBIDE, machine=load_machine("lathe22")))
    assert stability_limits(TURNED, at) == ()
    assert known(TURNED, at).basis is Basis.NOT_USED


def test_a_turning_tool_that_gives_only_along_its_edge_is_not_limited() -> None:
    mode = replace(MODE, tool="insert", direction=ModeDirection.X)
    at = on(mode, at=replace(CARBIDE, machine=load_machine("lathe22")))
    assert stability_limits(TURNED, at) == ()


def test_a_tool_is_estimated_once_by_its_hardest_cut() -> None:
    soft = Stability(basis=Basis.ESTIMATED, reason="usual tools", least=1.0, band=(0.3, 2.0))
    hard = replace(soft, least=0.4, band=(0.1, 1.0))
    none = Stability(basis=Basis.NOT_USED, reason="thin")
    found = list(estimate_texts([(MILL, soft, 2.0), (MILL, hard, 3.0), (MILL, none, 9.0)]))
    ((tool, text),) = found
    assert tool == "mill"
    assert "0.4 mm would be stable at any speed (0.1 to 1 mm for 5 to 20 N/µm" in text
    assert "3 mm are cut" in text
    assert "stepnc taptest" in text


def test_the_problem_of_a_cut_holds_the_bound() -> None:
    task = OptimisationTask(free=ALL_FREE)
    assert problem_of(CUT, on(MODE), task).curved is not None
    assert problem_of(CUT, CARBIDE, task).curved is None


def tapped() -> Machine:
    """A mill whose 20 mm end mill was tapped."""
    mode = replace(MODE, tool="END MILL 20MM", natural_frequency=1_150.0, stiffness=5_000.0)
    return replace(load_machine("vmc15"), name="tapped", modes=(mode,))


def test_a_slot_deep_as_its_tool_is_no_longer_advised_where_modes_are_measured() -> None:
    """Aluminium, all free: 20 mm in one pass before, stable passes at a lobe after."""
    task = OptimisationTask(free=ALL_FREE, source=from_features)
    material = match_material(["al7075"])
    program = edited("bracket")
    plans = [
        optimise_program(program, machine=machine, material=material, task=task)
        for machine in (load_machine("vmc15"), tapped())
    ]
    unbounded, bounded = (advice_of(plan, "ROUGH CONTOUR") for plan in plans)
    assert after(unbounded).setting.depth == 20.0
    setting = after(bounded).setting
    (load,) = (load for load in after(bounded).loads if load.limit.name is LimitName.STABILITY)
    assert load.value <= load.bound * (1.0 + 1e-9)
    assert setting.depth < 20.0
    assert bounded.stability is not None
    assert bounded.stability.least is not None
    # At a peak: deeper than at any speed.
    assert setting.depth > 1.5 * bounded.stability.least
    notes = [finding.message for finding in plans[0].findings if "no modes" in finding.message]
    assert sum("'END MILL 20MM'" in note for note in notes) == 1
    assert not any(
        "'END MILL 20MM'" in finding.message
        for finding in plans[1].findings
        if "no modes" in finding.message
    )


def test_a_held_speed_takes_more_passes_and_a_held_depth_says_what_would_be_stable() -> None:
    program, material = edited("bracket"), match_material(["al7075"])
    for free in (frozenset({Free.FEED, Free.DEPTH}), frozenset({Free.FEED})):
        task = OptimisationTask(free=free, source=from_features)
        plan = optimise_program(program, machine=tapped(), material=material, task=task)
        advice = advice_of(plan, "ROUGH CONTOUR")
        assert any(
            "as programmed: stability allows" in finding.message for finding in plan.findings
        )
        if Free.DEPTH in free:
            assert after(advice).setting.passes > 2
        else:
            assert advice.after is None
            assert "stability allows" in advice.reason
            assert "would be stable" in advice.reason
