"""Slots: sections, ends and courses, against their drawings."""

from math import pi, radians, sqrt, tan
from pathlib import Path

import pytest

from stepnc_model.entities.features import Slot
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import area, chain_length, vertices
from stepnc_model.toolpath.milling.cover import Area
from stepnc_model.toolpath.milling.layer import CutLevel, clear
from stepnc_model.toolpath.milling.offset import erode
from stepnc_model.toolpath.milling.outline import slot_area
from stepnc_model.toolpath.milling.strategy import EndMillShape, cutter_of, way_of
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


def slot(*changes: tuple[str, str], more: str = "") -> Area:
    """The slot of the bracket: 12 mm wide, 6 mm deep, 90 mm along y from (90, 0)."""
    job = job_at("MILL SLOT", *changes, more=more)
    (ref,) = job.step.features
    feature = job.program.get(ref)
    assert isinstance(feature, Slot)
    frame = job.frame(ref)
    return slot_area(job, ref, feature, frame, frame.origin[2] - 6.0)


def ended(one: str, other: str) -> tuple[tuple[str, str], str]:
    """Change of both ends and the instances that it needs."""
    more = f"#901={one};#902={other};#903=TOLERANCED_LENGTH_MEASURE(2.,#510);"
    more += "#904=TOLERANCED_LENGTH_MEASURE(6.,#510);#905=TOLERANCED_LENGTH_MEASURE(0.,#510);"
    return ("(#139,#139)", "(#901,#902)"), more


def profiled(profile: str) -> Area:
    return slot(("#133,#126,#136,", "#133,#126,#901,"), more=f"#901={profile};")


def width_at(found: Area, z: float) -> float:
    """Width of the straight slot for a thin tool: its area over its length."""
    thin = EndMillShape(radius=1e-3)
    (loop,) = found.boundaries(z, thin)
    xs = [edge.start.real for edge in loop]
    return max(xs) - min(xs)


def test_open_slot_is_run_out_of_at_both_ends() -> None:
    """12 mm of tool and 5 mm of overcut beyond 90 mm."""
    found = slot()
    assert area(found.walls[0].loop) == pytest.approx(12.0 * (90.0 + 2.0 * 17.0))
    assert found.solid is not None
    assert area(found.solid) == pytest.approx(12.0 * 90.0)
    assert chain_length(found.outside) == pytest.approx(24.0)


def test_radiused_ends_are_half_circles_beyond_the_course() -> None:
    change, more = ended("RADIUSED_SLOT_END_TYPE()", "RADIUSED_SLOT_END_TYPE()")
    found = slot(change, more=more)
    assert area(found.walls[0].loop) == pytest.approx(12.0 * 90.0 + 36.0 * pi)
    assert found.solid is None


@pytest.mark.parametrize(("ref", "radius"), [("#905", 0.0), ("#903", 2.0), ("#904", 6.0)])
def test_flat_ends_stop_at_the_course_with_their_corners(ref: str, radius: float) -> None:
    change, more = ended(f"FLAT_SLOT_END_TYPE({ref},{ref})", f"FLAT_SLOT_END_TYPE({ref},{ref})")
    found = slot(change, more=more)
    expected = 12.0 * 90.0 - (4.0 - pi) * radius**2
    assert area(found.walls[0].loop) == pytest.approx(expected, abs=0.02)


def test_woodruff_end_stops_at_the_course() -> None:
    change, more = ended("WOODRUFF_SLOT_END_TYPE(#904)", "OPEN_SLOT_END_TYPE()")
    found = slot(change, more=more)
    assert area(found.walls[0].loop) == pytest.approx(12.0 * (90.0 + 17.0))


@pytest.mark.parametrize("z", [-1.0, -3.0, -5.0, -6.0])
def test_woodruff_end_is_not_cut_into_at_any_level(z: float) -> None:
    """A tool of 10 mm in the slot of 12 mm: its rim stays on the arc or inside."""
    change, more = ended("WOODRUFF_SLOT_END_TYPE(#904)", "OPEN_SLOT_END_TYPE()")
    found = slot(change, more=more)
    loops = erode(found.boundaries(z, EndMillShape(radius=5.0)), 5.0)
    rim = min(point.imag for loop in loops for point in vertices(loop, tolerance=1e-4)) - 5.0
    height = 6.0 + z
    assert rim == pytest.approx(6.0 - sqrt(36.0 - (6.0 - height) ** 2), abs=1e-6)


def test_corner_larger_than_half_the_width_is_refused() -> None:
    change, more = ended("FLAT_SLOT_END_TYPE(#127,#127)", "OPEN_SLOT_END_TYPE()")
    with pytest.raises(
        PathError, match=r"corner radius 90 mm .*half the width of the slot, 6 mm"
    ):
        slot(change, more=more)


def test_loop_end_needs_a_course_that_closes() -> None:
    change, more = ended("LOOP_SLOT_END_TYPE()", "LOOP_SLOT_END_TYPE()")
    with pytest.raises(
        PathError, match="#130 SLOT: the slot's course does not close: gap of 90 mm"
    ):
        slot(change, more=more)


def test_one_end_condition_stands_for_both() -> None:
    found = slot(("(#139,#139)", "(#139)"))
    assert len(found.outside) == 2


def test_circular_slot_is_a_ring() -> None:
    """About the placement, radius 90 mm: 84 to 96 mm."""
    found = slot(
        ("#133,#126,#136,", "#133,#901,#136,"), more="#901=COMPLETE_CIRCULAR_PATH($,#127);"
    )
    total = sum(area(wall.loop) for wall in found.walls)
    assert total == pytest.approx(pi * (96.0**2 - 84.0**2))


def test_slot_along_an_arc_is_part_of_a_ring() -> None:
    change, more = ended("RADIUSED_SLOT_END_TYPE()", "RADIUSED_SLOT_END_TYPE()")
    more += "#906=PARTIAL_CIRCULAR_PATH($,#127,60.);"
    found = slot(change, ("#133,#126,#136,", "#133,#906,#136,"), more=more)
    expected = pi * (96.0**2 - 84.0**2) / 6.0 + 36.0 * pi
    assert area(found.walls[0].loop) == pytest.approx(expected)


def test_slot_around_a_corner_is_round_outside_and_sharp_inside() -> None:
    """Two legs of 40 and 28 mm: a square of 6 mm less, a quarter circle more."""
    more = "#906=GENERAL_PATH($,#907);#907=POLYLINE('',(#500,#181,#182));"
    change, ends = ended("RADIUSED_SLOT_END_TYPE()", "RADIUSED_SLOT_END_TYPE()")
    found = slot(change, ("#133,#126,#136,", "#133,#906,#136,"), more=more + ends)
    expected = 12.0 * (40.0 + 28.0) - 36.0 + 0.25 * pi * 36.0 + 36.0 * pi
    assert area(found.walls[0].loop) == pytest.approx(expected)


def test_course_sharper_than_half_the_width_is_refused() -> None:
    more = "#901=PARTIAL_CIRCULAR_PATH($,#902,200.);#902=TOLERANCED_LENGTH_MEASURE(3.,#510);"
    with pytest.raises(PathError, match="curves more tightly than the half width 6 mm"):
        slot(("#133,#126,#136,", "#133,#901,#136,"), more=more)


def test_square_u_with_leaning_walls_is_as_wide_as_drawn_at_the_top() -> None:
    found = profiled("SQUARE_U_PROFILE($,#137,$,10.,$,10.)")
    assert width_at(found, -0.0) == pytest.approx(12.0, abs=1e-6)
    assert width_at(found, -6.0) == pytest.approx(12.0 - 12.0 * tan(radians(10.0)), abs=1e-6)


def test_square_u_with_a_radius_is_narrower_on_its_floor() -> None:
    """0.2 mm of radius: 0.1 mm above the floor the wall stands 0.2 - √(0.2² - 0.1²) in."""
    found = profiled("SQUARE_U_PROFILE($,#137,#138,0.,#138,0.)")
    inset = 0.2 - sqrt(0.2**2 - 0.1**2)
    assert width_at(found, -5.9) == pytest.approx(12.0 - 2.0 * inset, abs=1e-6)
    assert width_at(found, -5.0) == pytest.approx(12.0, abs=1e-6)


def test_rounded_u_is_a_half_circle_on_its_floor() -> None:
    """6 mm of radius and of depth: at half the depth 2·√(6² - 3²) wide."""
    assert width_at(profiled("ROUNDED_U_PROFILE($,#137)"), -3.0) == pytest.approx(
        2.0 * sqrt(27.0), abs=1e-6
    )


def test_vee_is_as_wide_as_its_angle_opens_it() -> None:
    found = profiled("VEE_PROFILE($,#138,90.,0.)")
    assert width_at(found, 0.0) == pytest.approx(12.0, abs=1e-6)
    assert width_at(found, -4.0) == pytest.approx(4.0, abs=1e-6)


def test_partial_circle_is_as_wide_as_its_chord() -> None:
    """Radius 90 mm, 6 mm deep: 2·√(90² - 84²)."""
    found = profiled("PARTIAL_CIRCULAR_PROFILE($,#127,90.)")
    assert width_at(found, 0.0) == pytest.approx(2.0 * sqrt(90.0**2 - 84.0**2), abs=1e-6)


def test_tee_is_milled_as_wide_as_its_neck() -> None:
    found = profiled("TEE_PROFILE($,0.,0.,#180,#138,#138,#137,#138,#138)")
    assert width_at(found, -6.0) == pytest.approx(12.0, abs=1e-6)


def test_general_profile_is_as_wide_as_its_narrower_side_twice() -> None:
    """From x = -8 at the top to -4 on the floor, and from 4 up to 6."""
    more = (
        "GENERAL_PROFILE($,#910);#910=POLYLINE('',(#911,#912,#913,#914));"
        "#911=CARTESIAN_POINT('',(-8.,0.,0.));#912=CARTESIAN_POINT('',(-4.,0.,-6.));"
        "#913=CARTESIAN_POINT('',(4.,0.,-6.));#914=CARTESIAN_POINT('',(6.,0.,0.))"
    )
    found = profiled(more)
    assert width_at(found, 0.0) == pytest.approx(12.0, abs=1e-6)
    assert width_at(found, -3.0) == pytest.approx(10.0, abs=1e-6)


def test_profile_that_no_mill_makes_is_refused() -> None:
    with pytest.raises(PathError, match="a slot with this kind of profile cannot be milled"):
        profiled("LINEAR_PROFILE($,#109)")


@pytest.mark.parametrize(
    ("one", "other", "low", "high"),
    [
        ("OPEN_SLOT_END_TYPE()", "OPEN_SLOT_END_TYPE()", -11.0, 101.0),
        ("RADIUSED_SLOT_END_TYPE()", "RADIUSED_SLOT_END_TYPE()", 0.0, 90.0),
        ("FLAT_SLOT_END_TYPE(#905,#905)", "FLAT_SLOT_END_TYPE(#905,#905)", 6.0, 84.0),
        ("RADIUSED_SLOT_END_TYPE()", "FLAT_SLOT_END_TYPE(#905,#905)", 0.0, 84.0),
        ("WOODRUFF_SLOT_END_TYPE(#904)", "OPEN_SLOT_END_TYPE()", 12.0 - sqrt(27.0), 101.0),
    ],
)
def test_one_pass_along_the_middle_touches_the_end_walls(
    one: str, other: str, low: float, high: float
) -> None:
    """A tool of 12 mm in a slot of 12 mm: its middle stays 6 mm from a flat end, goes to the
    middle of a round one, and 6 + 5 mm beyond an open one. Half way down a Woodruff end of 6 mm
    radius the arc stands √27 mm from where it meets the floor, 6 mm from the end."""
    change, more = ended(one, other)
    job = job_at("MILL SLOT", change, more=more)
    found = slot(change, more=more)
    cutter = EndMillShape(radius=6.0)
    level = CutLevel(z=-3.0, above=0.0, cutter=cutter, allowance=0.0)
    layer = clear(job, found, level, way_of(job, cutter_of(job)))
    assert layer is not None
    (cut,) = layer.passes
    assert cut.start == pytest.approx(90 + 1j * low)
    assert cut.end == pytest.approx(90 + 1j * high)
