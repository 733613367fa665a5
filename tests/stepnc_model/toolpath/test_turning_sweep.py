"""Sections of grooves against their drawings."""

from pathlib import Path

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.turning_outline import outline_of
from stepnc_model.toolpath.turning_piece import Piece
from stepnc_model.toolpath.turning_sweep import rounded, vee_angle
from stepnc_model.units import rad_from_deg

SHAFT = Path(__file__).parents[3] / "examples" / "parts" / "shaft.stpnc"


def job(name: str, *edits: tuple[str, str]) -> Job:
    """A workingstep of the shaft with some texts replaced."""
    text = SHAFT.read_text()
    for before, after in edits:
        assert before in text
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="shaft"), name="shaft")
    (step,) = (step for step in program.workingsteps if step.id == name)
    return job_of(program, step)


SQUARE = "SQUARE_U_PROFILE($,#134,#135,0.,#135,0.)"


def section(text: str) -> tuple[Piece, ...]:
    at = job("THREAD RELIEF", (SQUARE, text))
    return outline_of(at, at.step.features[0], 15.0).pieces


def test_a_square_groove_has_two_walls_and_a_floor() -> None:
    pieces = section(SQUARE)
    assert pieces[0].start == pytest.approx((-25.0, 15.0))
    assert pieces[-1].end == pytest.approx((-29.0, 15.0))
    assert [p.radius for p in pieces if p.centre] == pytest.approx([0.2, 0.2])
    assert min(p.end[1] for p in pieces) == 12.5


def test_walls_lean_by_their_angle() -> None:
    """2.5 mm high at 45 degrees: 2.5 mm wider on each side."""
    pieces = section("SQUARE_U_PROFILE($,#134,#135,45.,#135,45.)")
    assert pieces[0].start == pytest.approx((-22.5, 15.0))
    assert pieces[-1].end == pytest.approx((-31.5, 15.0))


def test_a_rounded_groove_is_a_half_circle() -> None:
    arcs = [p for p in section("ROUNDED_U_PROFILE($,#134)") if p.centre]
    assert {p.radius for p in arcs} == {2.0}
    assert arcs[0].point(0.5) == pytest.approx((-27.0, 12.5))


def test_the_bottom_of_a_vee_is_that_of_its_radius() -> None:
    arcs = [p for p in section("VEE_PROFILE($,#135,90.,0.)") if p.centre]
    assert min(p.at(-27.0) for p in arcs if p.low <= -27.0 <= p.high) == pytest.approx(12.5)


def test_corners_wider_than_the_floor_are_refused() -> None:
    with pytest.raises(SchemaError, match="are wider than"):
        section("SQUARE_U_PROFILE($,#134,#134,0.,#134,0.)")


def test_angles_of_vees_are_in_degrees_or_in_radians() -> None:
    assert vee_angle(60.0) == rad_from_deg(60.0)
    assert vee_angle(1.0) == 1.0


def test_a_corner_is_rounded_tangentially() -> None:
    first, arc, last = rounded([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)], [0.0, 2.0, 0.0])
    assert first.end == pytest.approx((3.0, 0.0))
    assert arc.centre == pytest.approx((3.0, 2.0))
    assert last.start == pytest.approx((5.0, 2.0))
