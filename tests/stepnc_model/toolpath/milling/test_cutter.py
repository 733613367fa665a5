"""Cutters as outlines, from the sizes of their drawings."""

from math import radians, sqrt, tan
from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.strategy import EndMillShape, cutter_of, run_out
from stepnc_model.toolpath.task import ToolPathTask, job_of

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


def test_flat_cutter_is_as_wide_at_the_tip_as_above() -> None:
    assert [EndMillShape(radius=5.0).reach(h) for h in (0.0, 1.0, 9.0)] == [5.0, 5.0, 5.0]


def test_ball_is_a_circle_up_to_its_middle() -> None:
    """3 mm from its middle a ball of 5 mm is 4 mm wide."""
    ball = EndMillShape(radius=5.0, corner=5.0)
    assert ball.reach(0.0) == 0.0
    assert ball.reach(2.0) == pytest.approx(4.0)
    assert ball.reach(7.0) == 5.0


def test_bull_nose_begins_with_its_flat_end() -> None:
    nose = EndMillShape(radius=5.0, corner=2.0)
    assert nose.reach(0.0) == pytest.approx(3.0)
    assert nose.reach(1.0) == pytest.approx(3.0 + sqrt(3.0))
    assert nose.reach(2.0) == 5.0


def test_tapered_cutter_widens_by_the_tangent() -> None:
    cutter = EndMillShape(radius=5.0, taper=tan(radians(10.0)))
    assert cutter.reach(20.0) == pytest.approx(5.0 + 20.0 * 0.17632698)


def test_cutter_of_the_sample_has_the_diameter_and_the_corner_of_its_dimension() -> None:
    assert cutter_of(job_at("ROUGH POCKET")) == EndMillShape(radius=6.0, corner=0.2)


def test_ball_end_mill_has_half_its_diameter_as_its_corner() -> None:
    change = (
        "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$)",
        "#421=BALL_ENDMILL(#422,4,.RIGHT.,.F.,$)",
    )
    assert cutter_of(job_at("ROUGH POCKET", change)) == EndMillShape(radius=6.0, corner=6.0)


def test_taper_angle_is_read_in_degrees() -> None:
    change = (
        "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$)",
        "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,5.)",
    )
    cutter = cutter_of(job_at("ROUGH POCKET", change))
    assert cutter.taper == pytest.approx(tan(radians(5.0)))


def test_corner_larger_than_the_tool_is_refused_with_both_sizes() -> None:
    change = (
        "MILLING_TOOL_DIMENSION(12.,$,$,26.,0.2,",
        "MILLING_TOOL_DIMENSION(12.,$,$,26.,7.,",
    )
    with pytest.raises(PathError, match=r"#420 .*corner radius 7 mm on a tool of 12 mm"):
        cutter_of(job_at("ROUGH POCKET", change))


def test_taper_that_no_tool_has_is_refused() -> None:
    change = (
        "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$)",
        "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,90.)",
    )
    with pytest.raises(PathError, match=r"taper angle 90°.*80°"):
        cutter_of(job_at("ROUGH POCKET", change))


def test_overcut_is_what_the_operation_says_else_two_millimetres() -> None:
    assert run_out(job_at("ROUGH FACE")) == 5.0
    assert run_out(job_at("ROUGH POCKET")) == 2.0


def test_negative_overcut_is_refused() -> None:
    with pytest.raises(PathError, match=r"#200 .*overcut_length: -5 mm"):
        run_out(job_at("ROUGH FACE", ("#300,#330,5.,", "#300,#330,-5.,")))
