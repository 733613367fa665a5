"""Profiles and courses as contours, by lengths and areas of their drawings."""

from math import cos, pi, sqrt
from pathlib import Path

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Part21Error, PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.milling.contour import Chain, Loop, area, chain_length
from stepnc_model.toolpath.milling.outline import (
    closed_outline,
    course,
    open_outline,
    require_simple,
    require_upright,
    slope_of,
)
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


NEW = Ref[Entity](900)


def closed(profile: str, more: str = "") -> Loop:
    job = job_at("ROUGH POCKET", more=f"#900={profile};{more}")
    return closed_outline(job, Ref(900), Frame())


def travel(path: str, more: str = "") -> Chain:
    return course(job_at("ROUGH POCKET", more=f"#900={path};{more}"), NEW, Frame())


@pytest.mark.parametrize(
    ("profile", "size"),
    [
        ("RECTANGULAR_CLOSED_PROFILE($,#149,#180)", 3000.0),
        ("CIRCULAR_CLOSED_PROFILE($,#180)", 900.0 * pi),
        ("NGON_CLOSED_PROFILE($,#180,6,.T.)", 1.5 * sqrt(3.0) * 900.0),
        ("NGON_CLOSED_PROFILE($,#180,6,.F.)", 2.0 * sqrt(3.0) * 900.0),
        ("GENERAL_CLOSED_PROFILE($,#520)", 150.0 * 90.0 - (4.0 - pi) * 100.0),
    ],
)
def test_closed_profiles_run_counter_clockwise_about_their_area(
    profile: str, size: float
) -> None:
    assert area(closed(profile)) == pytest.approx(size)


def test_rectangle_has_its_length_along_x() -> None:
    """PROFILE_WIDTH 50, PROFILE_LENGTH 60."""
    xs = [edge.start.real for edge in closed("RECTANGULAR_CLOSED_PROFILE($,#149,#180)")]
    assert max(xs) - min(xs) == pytest.approx(60.0)


def test_polygon_has_a_corner_on_x() -> None:
    first = closed("NGON_CLOSED_PROFILE($,#180,8,.F.)")[0].start
    assert first == pytest.approx(30.0 / cos(pi / 8.0))


def test_arcs_of_the_file_stay_arcs() -> None:
    loop = closed("GENERAL_CLOSED_PROFILE($,#520)")
    assert sum(edge.centre is not None for edge in loop) == 4


@pytest.mark.parametrize("sides", ["2", "0", "-4", "100000"])
def test_polygon_has_three_sides_at_least(sides: str) -> None:
    with pytest.raises(PathError, match=r"#900 .*number_of_sides: .* sides"):
        closed(f"NGON_CLOSED_PROFILE($,#180,{sides},.T.)")


def test_profile_with_a_gap_is_refused() -> None:
    with pytest.raises(PathError, match="the profile does not close: gap of 28 mm"):
        closed("GENERAL_CLOSED_PROFILE($,#158)")


def test_open_profile_is_no_closed_one() -> None:
    with pytest.raises(PathError, match="#900 LINEAR_PROFILE: is not a closed profile"):
        closed("LINEAR_PROFILE($,#109)")


@pytest.mark.parametrize(
    ("path", "length"),
    [
        ("LINEAR_PATH($,#127,#503)", 90.0),
        ("COMPLETE_CIRCULAR_PATH($,#127)", 180.0 * pi),
        ("PARTIAL_CIRCULAR_PATH($,#127,30.)", 15.0 * pi),
        ("GENERAL_PATH($,#158)", 108.0),
    ],
)
def test_courses_are_as_long_as_drawn(path: str, length: float) -> None:
    assert chain_length(travel(path)) == pytest.approx(length)


def test_course_out_of_its_plane_is_refused() -> None:
    with pytest.raises(PathError, match="its_direction: the course of travel leaves its plane"):
        travel("LINEAR_PATH($,#127,#501)")


def test_what_is_no_course_is_refused() -> None:
    with pytest.raises(PathError, match="is not a course of travel"):
        travel("LINEAR_PROFILE($,#109)")


def test_open_arc_begins_on_x() -> None:
    job = job_at("ROUGH POCKET", more="#900=PARTIAL_CIRCULAR_PROFILE($,#127,90.);")
    (arc,) = open_outline(job, NEW, Frame())
    assert [arc.start, arc.end] == pytest.approx([90 + 0j, 90j])


def test_open_boundary_of_another_kind_is_refused() -> None:
    job = job_at("ROUGH POCKET", more="#900=ROUNDED_U_PROFILE($,#137);")
    with pytest.raises(PathError, match="this kind of open boundary is not supported"):
        open_outline(job, NEW, Frame())


@pytest.mark.parametrize("number", ["1.E7", "-1.E300"])
def test_point_that_lies_beyond_any_part_is_refused(number: str) -> None:
    more = f"#901=POLYLINE('',(#500,#902));#902=CARTESIAN_POINT('',({number},0.,0.));"
    with pytest.raises(PathError, match="is too far away"):
        travel("GENERAL_PATH($,#901)", more)


@pytest.mark.parametrize("number", ["NAN", "NaN", "INF"])
def test_reader_takes_no_number_that_is_none(number: str) -> None:
    more = f"#901=POLYLINE('',(#500,#902));#902=CARTESIAN_POINT('',({number},0.,0.));"
    with pytest.raises((SchemaError, Part21Error)):
        travel("GENERAL_PATH($,#901)", more)


def test_boundary_that_crosses_itself_is_refused() -> None:
    job = job_at("ROUGH POCKET")
    square = closed("RECTANGULAR_CLOSED_PROFILE($,#149,#180)")
    require_simple(job, square, NEW)
    bow = (square[0], square[2], square[1], square[3])
    with pytest.raises(PathError, match="crosses itself"):
        require_simple(job, bow, Ref(140))


def test_feature_must_stand_upright() -> None:
    with pytest.raises(PathError, match=r"#140 .*axis \(0, 1, 0\) is not parallel"):
        require_upright(job_at("ROUGH POCKET"), Frame(z=(0.0, 1.0, 0.0)), Ref(140))


def test_walls_lean_outwards_and_less_than_flat() -> None:
    job = job_at("ROUGH POCKET")
    assert slope_of(job, None, Ref(140)) == 0.0
    assert slope_of(job, 7.5, Ref(140)) == 7.5
    with pytest.raises(PathError, match="a wall at 89°"):
        slope_of(job, 89.0, Ref(140))
