"""Strategies as numbers and directions (ISO 14649-11)."""

from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.strategy import Covering, ResolvedStrategy, cutter_of, way_of
from stepnc_model.toolpath.task import ToolPathTask, job_of
from tests.every_case import every_case

PARTS = Path(__file__).parents[4] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "") -> Program:
    """The bracket with some texts replaced and instances added."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="utf-8")
    for before, after in (*changes, (END, f"{more}\n{END}")):
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="bracket"))


def job_at(id: str, *changes: tuple[str, str], more: str = "") -> ToolPathTask:
    """Job of the workingstep with a name."""
    program = edited(*changes, more=more)
    step = next(step for step in program.workingsteps if step.id == id)
    return job_of(program, step)


OLD = "#352=CONTOUR_PARALLEL(0.5,.T.,.CCW.,.CLIMB.)"
LEFT = ("#421=TAPERED_ENDMILL(#422,4,.RIGHT.", "#421=TAPERED_ENDMILL(#422,4,.LEFT.")


def way(strategy: str, *changes: tuple[str, str], radial: str = "$") -> ResolvedStrategy:
    """Way of roughing the pocket with a tool of 12 mm."""
    job = job_at(
        "ROUGH POCKET",
        (OLD, f"#352={strategy}"),
        ("4.,6.,0.3,0.2);\n#207", f"4.,{radial},0.3,0.2);\n#207"),
        *changes,
    )
    return way_of(job, cutter_of(job))


@every_case(
    ("strategy", "covering"),
    [
        ("UNIDIRECTIONAL_MILLING($,.T.,#502,$)", Covering.ONE_WAY),
        ("BIDIRECTIONAL_MILLING($,.T.,#502,.LEFT.,$)", Covering.TO_AND_FRO),
        ("CONTOUR_PARALLEL($,.T.,.CCW.,$)", Covering.RINGS),
        ("CONTOUR_SPIRAL($,.T.,.CCW.,$)", Covering.SPIRAL),
        ("BIDIRECTIONAL_CONTOUR($,.T.,#502,.LEFT.,$,$)", Covering.STROKES_THEN_WALL),
        ("CONTOUR_BIDIRECTIONAL($,.T.,#502,.LEFT.,$,$)", Covering.WALL_THEN_STROKES),
        ("CENTER_MILLING($,.T.)", Covering.MIDDLE),
    ],
)
def test_each_strategy_has_its_covering(strategy: str, covering: Covering) -> None:
    assert way(strategy).covering is covering


@every_case(
    ("overlap", "radial", "step"),
    [
        ("0.5", "$", 6.0),
        ("50.", "$", 6.0),
        ("0.25", "$", 9.0),
        ("0.25", "4.", 4.0),
        ("0.75", "4.", 3.0),
        ("$", "5.", 5.0),
        ("0.", "$", 11.4),
    ],
)
def test_step_is_the_diameter_less_the_overlap_and_the_radial_depth_at_most(
    overlap: str, radial: str, step: float
) -> None:
    found = way(f"CONTOUR_PARALLEL({overlap},.T.,.CCW.,.CLIMB.)", radial=radial)
    assert found.step == pytest.approx(step)
    assert found.findings == ()


def test_step_that_nothing_gives_is_assumed_and_said() -> None:
    found = way("CONTOUR_PARALLEL($,.T.,.CCW.,.CLIMB.)")
    assert found.step == pytest.approx(0.95 * 12.0)
    assert "95%" in found.findings[0].message


@every_case("overlap", ["1.", "100.", "-0.1", "250."])
def test_overlap_that_leaves_no_progress_is_refused_at_its_strategy(overlap: str) -> None:
    with pytest.raises(PathError, match=r"#352 CONTOUR_PARALLEL\.overlap: overlap .*below 1"):
        way(f"CONTOUR_PARALLEL({overlap},.T.,.CCW.,.CLIMB.)")


@pytest.mark.parametrize("radial", ["0.", "-2."])
def test_width_of_cut_must_be_positive(radial: str) -> None:
    with pytest.raises(
        PathError, match=r"radial_cutting_depth: .* mm: the width of cut must be positive"
    ):
        way("CONTOUR_PARALLEL($,.T.,.CCW.,.CLIMB.)", radial=radial)


def test_steps_that_are_a_slip_are_refused() -> None:
    with pytest.raises(PathError, match="radial_cutting_depth: step of 1e-05 mm"):
        way("CONTOUR_PARALLEL($,.T.,.CCW.,.CLIMB.)", radial="0.00001")


def test_explicit_strategy_needs_its_path() -> None:
    with pytest.raises(
        PathError,
        match="the strategy asks for an explicit tool path, but the operation has none",
    ):
        way("EXPLICIT_STRATEGY($,$)")


@pytest.mark.parametrize(
    ("rotation", "mode", "is_left_hand", "is_inside_out"),
    [
        (".CCW.", ".CLIMB.", False, True),
        (".CW.", ".CLIMB.", False, False),
        (".CCW.", ".CONVENTIONAL.", False, False),
        (".CW.", ".CONVENTIONAL.", False, True),
        (".CCW.", ".CLIMB.", True, False),
        (".CW.", ".CLIMB.", True, True),
    ],
)
def test_rings_go_where_the_uncut_material_is_on_the_side_of_the_mode(
    rotation: str, mode: str, is_left_hand: bool, is_inside_out: bool
) -> None:
    """Counter-clockwise has the outside on its right: climbing with a right-hand tool, that is
    where the material must still be, so the rings go from the inside out."""
    changes = (LEFT,) if is_left_hand else ()
    found = way(f"CONTOUR_PARALLEL(0.5,.T.,{rotation},{mode})", *changes)
    assert found.is_counter_clockwise is (rotation == ".CCW.")
    assert found.is_inside_out is is_inside_out


@pytest.mark.parametrize(
    ("mode", "is_left_hand", "is_on_right"),
    [
        (".CLIMB.", False, True),
        (".CONVENTIONAL.", False, False),
        (".CLIMB.", True, False),
        (".CONVENTIONAL.", True, True),
    ],
)
def test_climb_has_the_wall_on_the_right_of_a_right_hand_tool(
    mode: str, is_left_hand: bool, is_on_right: bool
) -> None:
    changes = (LEFT,) if is_left_hand else ()
    found = way(f"CONTOUR_PARALLEL(0.5,.T.,.CW.,{mode})", *changes)
    assert found.has_wall_on_right is is_on_right
    strokes = way(f"UNIDIRECTIONAL_MILLING(0.5,.T.,#502,{mode})", *changes)
    # What is still to be cut lies on the side of the next stroke.
    assert strokes.steps_left is not is_on_right


def test_strokes_are_lifted_when_they_run_one_way_or_when_it_is_asked() -> None:
    assert way("UNIDIRECTIONAL_MILLING(0.5,.T.,#502,$)").is_lifted
    lifted = "BIDIRECTIONAL_MILLING(0.5,.T.,#502,.LEFT.,.LIFT_SHIFT_PLUNGE.)"
    assert way(lifted).is_lifted
    assert not way("BIDIRECTIONAL_MILLING(0.5,.T.,#502,.LEFT.,$)").is_lifted


def test_stepover_side_is_the_one_given() -> None:
    assert way("BIDIRECTIONAL_MILLING(0.5,.T.,#502,.LEFT.,$)").steps_left
    assert not way("BIDIRECTIONAL_MILLING(0.5,.T.,#502,.RIGHT.,$)").steps_left


def test_direction_of_strokes_turns_with_the_feature() -> None:
    turned = ("('POCKET CENTRE',#142,#501,#502)", "('POCKET CENTRE',#142,#501,#503)")
    found = way("BIDIRECTIONAL_MILLING(0.5,.T.,#502,.LEFT.,$)", turned)
    assert found.along == pytest.approx(1j)


def test_strokes_along_the_tool_are_refused() -> None:
    with pytest.raises(PathError, match="points along the tool"):
        way("BIDIRECTIONAL_MILLING(0.5,.T.,#501,.LEFT.,$)")
