"""How far a tool may bend at a wall: by its tolerance or its allowance."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.advice import Plan
from optimiser.bounds.tolerance import GREATEST_AT_WALL, permitted_deflection
from optimiser.cuts.conditions import GREATEST_DEFLECTION, PermittedDeflection
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import LimitName
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.program import Program
from tests.every_case import every_case
from tests.optimiser.plans import advice_of, after, edited, plan_of

CORPUS = Path(__file__).parents[4] / "shared" / "corpus" / "iso14649"
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="no corpus beside the project")

WIDTH = "#137=TOLERANCED_LENGTH_MEASURE(12.,#510);"
USUAL = "#510=PLUS_MINUS_VALUE(0.1,0.1,3);"
ROUGH_POCKET = "4.,6.,0.3,0.2);"


def permitted(program: Program, name: str) -> tuple[PermittedDeflection, list[Finding]]:
    (step,) = (step for step in program.workingsteps if step.id == name)
    return permitted_deflection(program, step)


def of_slot(tolerance: str, size: str = "12.") -> tuple[PermittedDeflection, list[Finding]]:
    """The slot's width with another tolerance."""
    width = f"#137=TOLERANCED_LENGTH_MEASURE({size},#901);\n#901={tolerance};"
    return permitted(edited("bracket", (WIDTH, width)), "MILL SLOT")


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited("bracket")


@pytest.mark.parametrize(
    ("name", "value", "origin"),
    [
        ("MILL SLOT", 0.025, "a quarter of the ±0.1 mm tolerance of the width of 12 mm (#137)"),
        ("FINISH POCKET", 0.025,
         "a quarter of the ±0.1 mm tolerance of the width of 50 mm (#149)"),
        ("MILL STEP", 0.05,
         "a quarter of the ±0.2 mm tolerance of the width of 15 mm (ISO 2768-m)"),
        ("FINISH OPEN POCKET", 0.05,
         "a quarter of the ±0.2 mm tolerance of the width of 28 mm (ISO 2768-m)"),
        ("FINISH CONTOUR", 0.05,
         "the customary maximum for any wall (a quarter of the ±0.3 mm tolerance of the width "
         "of 90 mm (ISO 2768-m) would be more)"),
    ],
)  # fmt: skip
def test_operation_that_leaves_a_wall_keeps_its_tolerance_and_says_so(
    bracket: Program, name: str, value: float, origin: str
) -> None:
    found, findings = permitted(bracket, name)
    assert found.value == pytest.approx(value)
    assert found.origin == origin
    (note,) = findings
    assert note.severity is Severity.NOTE
    bound = f"tool deflection at most {value:g} mm, {origin}"
    assert note.message == f"leaves no allowance on the wall: {bound}"
    (step,) = (step for step in bracket.workingsteps if step.id == name)
    assert note.entity == bracket.label(step.operation_ref)


@pytest.mark.parametrize("name", ["ROUGH CONTOUR", "ROUGH POCKET", "ROUGH OPEN POCKET"])
def test_earlier_operation_bends_by_a_third_of_its_allowance(
    bracket: Program, name: str
) -> None:
    found, findings = permitted(bracket, name)
    assert found.value == pytest.approx(0.1)
    assert found.origin == "a third of the allowance of 0.3 mm on the wall"
    assert not findings


def test_thin_allowance_forgives_less_and_a_thick_one_no_more() -> None:
    for allowance, value in (("0.15", 0.05), ("1.5", GREATEST_DEFLECTION)):
        program = edited("bracket", (ROUGH_POCKET, f"4.,6.,{allowance},0.2);"))
        found, _ = permitted(program, "ROUGH POCKET")
        assert found.value == pytest.approx(value)


def test_allowance_that_forgives_less_than_the_tolerance_tightens_nothing() -> None:
    program = edited("bracket", (ROUGH_POCKET, "4.,6.,0.01,0.2);"))
    found, (note,) = permitted(program, "ROUGH POCKET")
    assert found.value == pytest.approx(0.025)
    assert note.message.startswith("leaves 0.01 mm on the wall: tool deflection at most")


@pytest.mark.parametrize("name", ["ROUGH FACE", "FINISH FACE"])
def test_face_has_no_wall_to_keep(bracket: Program, name: str) -> None:
    assert permitted(bracket, name) == (PermittedDeflection(), [])


def test_face_with_a_boss_has_one() -> None:
    face = "#108,$,());"
    program = edited("bracket", (face, "#108,$,(#190));"))
    found, _ = permitted(program, "FINISH FACE")
    assert found.value == pytest.approx(0.025)


def test_operation_that_leaves_nothing_for_the_next_keeps_the_tolerance() -> None:
    program = edited("bracket", (ROUGH_POCKET, "4.,6.,0.,0.2);"))
    found, _ = permitted(program, "ROUGH POCKET")
    assert found.value == pytest.approx(0.025)


def test_allowance_that_is_not_given_is_the_customary_one_where_a_finish_follows() -> None:
    program = edited("bracket", (ROUGH_POCKET, "4.,6.,$,0.2);"))
    found, _ = permitted(program, "ROUGH POCKET")
    assert found == PermittedDeflection()


def test_allowance_that_is_not_given_is_none_where_nothing_follows() -> None:
    program = edited("bracket", ("3.,12.,0.,0.);", "3.,12.,$,0.);"))
    found, _ = permitted(program, "MILL SLOT")
    assert found.value == pytest.approx(0.025)


def test_last_operation_that_leaves_an_allowance_does_not_leave_the_wall() -> None:
    program = edited("bracket", ("3.,12.,0.,0.);", "3.,12.,0.2,0.);"))
    found, findings = permitted(program, "MILL SLOT")
    assert found.value == pytest.approx(0.2 / 3.0)
    assert not findings


def test_finish_of_the_floor_alone_leaves_the_wall_to_the_operation_before() -> None:
    program = edited(
        "bracket",
        ("#207=BOTTOM_AND_SIDE_FINISH_MILLING($,$,'FINISH POCKET',10.,$,#430,#306,#330,$,#342,"
         "#340,#352,\n     12.,5.,0.,0.);",
         "#207=PLANE_FINISH_MILLING($,$,'FINISH POCKET',10.,$,#430,#306,#330,$,#342,"
         "#340,#352,12.,0.);"),
        (ROUGH_POCKET, "4.,6.,$,0.2);"),
    )  # fmt: skip
    assert permitted(program, "FINISH POCKET")[0] == PermittedDeflection()
    assert permitted(program, "ROUGH POCKET")[0].value == pytest.approx(0.025)


@pytest.mark.parametrize(
    ("tolerance", "value", "origin"),
    [
        ("PLUS_MINUS_VALUE(0.018,0.,4)", 0.00225,
         "a quarter of the ±0.009 mm tolerance of the width of 12 mm (+0.018/-0 mm, #137)"),
        ("LIMITS_AND_FITS(0.,7.,.HOLE.)", 0.00225,
         "a quarter of the ±0.009 mm tolerance of the width of 12 mm (IT7, #137)"),
        ("LIMITS_AND_FITS('H',9.,.HOLE.)", 0.005375,
         "a quarter of the ±0.0215 mm tolerance of the width of 12 mm (IT9, #137)"),
        ("PLUS_MINUS_VALUE(0.5,0.5,3)", 0.05,
         "the customary maximum for any wall (a quarter of the ±0.5 mm tolerance of the width "
         "of 12 mm (#137) would be more)"),
    ],
)  # fmt: skip
def test_tolerance_of_the_file_counts_in_either_form(
    tolerance: str, value: float, origin: str
) -> None:
    found, _ = of_slot(tolerance)
    assert found.value == pytest.approx(value)
    assert found.origin == origin


@every_case(
    "tolerance",
    [
        "PLUS_MINUS_VALUE(-0.1,0.1,3)",
        "PLUS_MINUS_VALUE(0.,0.,3)",
        "LIMITS_AND_FITS('Q',7.,.HOLE.)",
        "LIMITS_AND_FITS(0.,0.,.HOLE.)",
        "CARTESIAN_POINT('',(0.,0.,0.))",
    ],
)
def test_tolerance_that_cannot_be_read_is_told_and_the_general_one_holds(
    tolerance: str,
) -> None:
    found, (warning, note) = of_slot(tolerance)
    origin = "a quarter of the ±0.2 mm tolerance of the width of 12 mm (ISO 2768-m, #137)"
    assert found.origin == origin
    assert warning.severity is Severity.WARNING
    assert warning.entity.startswith("#901 ")
    assert warning.line > 0
    assert note.severity is Severity.NOTE


def test_general_tolerance_of_a_narrow_slot_is_tighter() -> None:
    width = "#137=TOLERANCED_LENGTH_MEASURE(5.,$);"
    found, _ = permitted(edited("bracket", (WIDTH, width)), "MILL SLOT")
    assert found.value == pytest.approx(0.025)
    origin = "a quarter of the ±0.1 mm tolerance of the width of 5 mm (ISO 2768-m, #137)"
    assert found.origin == origin


def test_tightest_of_several_sizes_counts() -> None:
    boss = "#192=TOLERANCED_LENGTH_MEASURE(16.,#510);"
    program = edited("bracket", (boss, boss.replace("#510", "#511")))
    found, _ = permitted(program, "FINISH POCKET")
    assert found.value == pytest.approx(0.0125)
    assert "diameter of 16 mm (#192)" in found.origin


@settings(max_examples=25)
@given(st.floats(1e-4, 2.0), st.floats(1e-4, 2.0))
def test_bound_grows_with_the_tolerance_up_to_its_greatest(one: float, other: float) -> None:
    narrow, wide = sorted((one, other))
    bounds = [
        of_slot(f"PLUS_MINUS_VALUE({each:.6f},{each:.6f},3)")[0].value
        for each in (narrow, wide)
    ]
    assert bounds[0] <= bounds[1] <= GREATEST_AT_WALL
    assert bounds[0] == pytest.approx(min(GREATEST_AT_WALL, 0.25 * round(narrow, 6)))


def test_advice_keeps_the_bound_and_names_its_origin() -> None:
    plan = plan_of("bracket", OptimisationTask(safety=0.5))
    advice = advice_of(plan, "MILL SLOT")
    (load,) = (
        load for load in after(advice).loads if load.limit.name is LimitName.TOOL_DEFLECTION
    )
    assert load.value <= 0.025 * (1.0 + 1e-9)
    assert advice.reason == (
        "tool deflection 0.025 mm reaches its bound of 0.025 mm, "
        "a quarter of the ±0.1 mm tolerance of the width of 12 mm (#137)"
    )
    assert notes(plan, "leaves no allowance on the wall") == 5


def test_tolerance_that_no_cut_can_keep_is_a_conflict_that_names_it() -> None:
    tight = (USUAL, "#510=PLUS_MINUS_VALUE(0.001,0.001,4);")
    advice = advice_of(plan_of("bracket", OptimisationTask(), tight), "FINISH POCKET")
    assert advice.status.value == "infeasible"
    assert "tool deflection" in advice.reason


def test_material_of_a_paper_has_no_tolerance() -> None:
    plan = plan_of("paper002", OptimisationTask())
    assert notes(plan, "leaves no allowance on the wall") == 0
    assert notes(plan, "ISO 2768") == 0


def notes(plan: Plan, text: str) -> int:
    return sum(text in finding.message for finding in plan.findings)


@needs_corpus
@pytest.mark.parametrize(
    ("file", "name", "value", "origin"),
    [
        ("ex1.stp", "WS ROUGH POCKET1", 0.1, ""),
        ("ex1.stp", "WS FINISH POCKET1", 0.025,
         "±0.1 mm tolerance of the width of 50 mm (#122)"),
        ("EXAMPLE1_original.stp", "WS FINISH POCKET1", 0.05,
         "50 mm (ISO 2768-m) would be more)"),
        ("Cavidade.p21", "WS Finishing - Cavidade 1", 0.015,
         "±0.06 mm tolerance of the width of 50 mm (#63)"),
        ("Ranhura.p21", "WS ranhura - acabamento", 0.01375,
         "±0.055 mm tolerance of the width of 25 mm (#62)"),
        ("RanhuraPerfilVee.p21", "WS 2", 0.05,
         "±0.2 mm tolerance of the width of 26 mm (ISO 2768-m)"),
        ("ex1E.stp", "REAM HOLE1", 0.05,
         "±0.3 mm tolerance of the diameter of 22 mm (#58) would be more)"),
        ("ex1E.stp", "WS FINISH POCKET1 A", 0.025,
         "±0.1 mm tolerance of the width of 50 mm (#122)"),
    ],
)  # fmt: skip
def test_foreign_file(file: str, name: str, value: float, origin: str) -> None:
    program = Program.load(CORPUS / file)
    step = next(step for step in program.workingsteps if step.id.endswith(name))
    found, _ = permitted_deflection(program, step)
    assert found.value == pytest.approx(value)
    assert found.origin.endswith(origin)
