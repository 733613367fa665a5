"""Sections of grooves against their drawings."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.outline import outline_of, rounded
from stepnc_model.toolpath.turning.profile import ProfilePiece

SQUARE = "SQUARE_U_PROFILE($,#134,#135,0.,#135,0.)"


def section(job: Callable[..., ToolPathTask], text: str) -> tuple[ProfilePiece, ...]:
    at = job("THREAD RELIEF", (SQUARE, text))
    return outline_of(at, at.step.features[0], 15.0).pieces


def test_a_square_groove_has_two_walls_and_a_floor(job: Callable[..., ToolPathTask]) -> None:
    pieces = section(job, SQUARE)
    assert pieces[0].start == pytest.approx((-25.0, 15.0))
    assert pieces[-1].end == pytest.approx((-29.0, 15.0))
    assert [p.radius for p in pieces if p.centre] == pytest.approx([0.2, 0.2])
    assert min(p.end[1] for p in pieces) == 12.5


def test_walls_lean_by_their_angle(job: Callable[..., ToolPathTask]) -> None:
    """2.5 mm high at 45 degrees: 2.5 mm wider on each side."""
    pieces = section(job, "SQUARE_U_PROFILE($,#134,#135,45.,#135,45.)")
    assert pieces[0].start == pytest.approx((-22.5, 15.0))
    assert pieces[-1].end == pytest.approx((-31.5, 15.0))


def test_a_rounded_groove_is_a_half_circle(job: Callable[..., ToolPathTask]) -> None:
    arcs = [p for p in section(job, "ROUNDED_U_PROFILE($,#134)") if p.centre]
    assert {p.radius for p in arcs} == {2.0}
    assert arcs[0].point(0.5) == pytest.approx((-27.0, 12.5))


def test_the_bottom_of_a_vee_is_that_of_its_radius(job: Callable[..., ToolPathTask]) -> None:
    arcs = [p for p in section(job, "VEE_PROFILE($,#135,90.,0.)") if p.centre]
    assert min(p.at(-27.0) for p in arcs if p.low <= -27.0 <= p.high) == pytest.approx(12.5)


def test_corners_wider_than_the_floor_are_refused(job: Callable[..., ToolPathTask]) -> None:
    with pytest.raises(SchemaError, match="exceed the width"):
        section(job, "SQUARE_U_PROFILE($,#134,#134,0.,#134,0.)")


def test_a_corner_is_rounded_tangentially() -> None:
    first, arc, last = rounded([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)], [0.0, 2.0, 0.0])
    assert first.end == pytest.approx((3.0, 0.0))
    assert arc.centre == pytest.approx((3.0, 2.0))
    assert last.start == pytest.approx((5.0, 2.0))


def test_a_groove_on_a_face_is_refused(job: Callable[..., ToolPathTask]) -> None:
    at = job("THREAD RELIEF", ("#131,#505,12.5,", "#131,#504,12.5,"))
    with pytest.raises(SchemaError, match="face grooves are not supported"):
        outline_of(at, at.step.features[0], 15.0)


def test_a_tee_groove_is_refused(job: Callable[..., ToolPathTask]) -> None:
    with pytest.raises(SchemaError, match="a tee groove is wider below than at its mouth"):
        section(job, "TEE_PROFILE($,0.,0.,#134,#135,#135,#135,0.,0.)")


@pytest.mark.parametrize(
    "points",
    [
        [(2.0, 0.0), (2.0, -3.0), (4.0, -3.0), (4.0, 0.0)],
        [(2.5, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0), (0.0, -2.0), (1.0, -2.0), (2.5, -1.0)],
    ],
)
def test_a_section_that_no_plunge_comes_to_is_refused(
    job: Callable[..., ToolPathTask], points: list[tuple[float, float]]
) -> None:
    """Open to the front, and undercut: x and z of its corners."""
    names = ",".join(f"#{610 + i}" for i in range(len(points)))
    lines = "".join(
        f"#{610 + i}=CARTESIAN_POINT('',({x!r},0.,{z!r}));\n" for i, (x, z) in enumerate(points)
    )
    curve = f"GENERAL_PROFILE($,#600);\n#600=POLYLINE('',({names}))"
    text = f"{curve};\n{lines}#699=CARTESIAN_POINT('',(0.,0.,0.))"
    with pytest.raises(SchemaError, match="a plunge from outside cannot reach it"):
        section(job, text)
