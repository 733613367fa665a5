"""Milling features as areas and flanks, against the drawing of the bracket."""

from math import pi, radians, sqrt, tan
from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import area
from stepnc_model.toolpath.milling.cover import Area, Flank
from stepnc_model.toolpath.milling.shapes import shapes
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


def shapes_of(id: str, *changes: tuple[str, str], more: str = "") -> list[Area | Flank]:
    job = job_at(id, *changes, more=more)
    (ref,) = job.step.features
    return list(shapes(job, ref, job.frame(ref)))


def shape_of(id: str, *changes: tuple[str, str], more: str = "") -> Area | Flank:
    (found,) = shapes_of(id, *changes, more=more)
    return found


def on(feature: str) -> tuple[str, str]:
    """The workingstep of the pocket on another feature, an instance #900."""
    return ("'ROUGH POCKET',#43,#140", "'ROUGH POCKET',#43,#900")


def test_face_is_travel_times_profile_at_its_heights() -> None:
    found = shape_of("ROUGH FACE")
    assert isinstance(found, Area)
    assert found.face is not None
    assert area(found.face) == pytest.approx(96.0 * 156.0)
    assert (found.top, found.bottom) == (2.0, 0.0)


def test_face_takes_its_own_boundary_before_travel_times_profile() -> None:
    found = shape_of("ROUGH FACE", ("#106,#108,$,());", "#106,#108,#191,());"))
    assert isinstance(found, Area)
    assert found.face is not None
    assert area(found.face) == pytest.approx(64.0 * pi)


def test_pocket_has_rounded_corners_and_its_island() -> None:
    found = shape_of("ROUGH POCKET")
    assert isinstance(found, Area)
    outline, island = (area(wall.loop) for wall in found.walls)
    assert outline == pytest.approx(60.0 * 50.0 - (4.0 - pi) * 64.0)
    assert island == pytest.approx(-64.0 * pi)


def test_hole_is_a_circle_and_its_edge_may_be_round() -> None:
    more = (
        "#900=ROUND_HOLE('H',#30,(),#141,#143,#180,$,#901);"
        "#901=FLAT_WITH_RADIUS_HOLE_BOTTOM(#147);"
    )
    found = shape_of("ROUGH POCKET", on("#900"), more=more)
    assert isinstance(found, Area)
    assert area(found.walls[0].loop) == pytest.approx(900.0 * pi)
    assert found.walls[0].inset(0.0) == pytest.approx(8.0)
    assert found.walls[0].inset(8.0) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("bottom", "deep", "half_way"),
    [
        # A cone of 90° is as deep as its radius, and half as wide half way down.
        ("CONICAL_HOLE_BOTTOM(90.,$)", 30.0, 15.0),
        # Half a sphere: at half its depth √3/2 of its radius.
        ("SPHERICAL_HOLE_BOTTOM(#180)", None, None),
        ("SPHERICAL_HOLE_BOTTOM(#902)", 30.0, 30.0 * sqrt(0.75)),
    ],
)
def test_bottom_of_a_hole_reaches_below_its_depth_plane(
    bottom: str, deep: float | None, half_way: float | None
) -> None:
    """60 mm wide, its cylinder 12 mm deep."""
    more = (
        "#900=ROUND_HOLE('H',#30,(),#141,#143,#180,$,#901);"
        f"#901={bottom};#902=TOLERANCED_LENGTH_MEASURE(30.,#510);"
    )
    found = shape_of("ROUGH POCKET", on("#900"), more=more)
    assert isinstance(found, Area)
    if deep is None or half_way is None:
        # A sphere of 60 mm radius: 60 − √(60² − 30²) deep.
        assert found.bottom == pytest.approx(-12.0 - (60.0 - sqrt(2700.0)))
        return
    assert found.bottom == pytest.approx(-12.0 - deep)
    (wall,) = found.walls
    assert wall.inset(0.5 * deep) == pytest.approx(30.0 - half_way)
    assert wall.inset(deep + 1.0) == 0.0


def test_sphere_smaller_than_its_hole_is_refused() -> None:
    more = (
        "#900=ROUND_HOLE('H',#30,(),#141,#143,#180,$,#901);"
        "#901=SPHERICAL_HOLE_BOTTOM(#902);#902=TOLERANCED_LENGTH_MEASURE(20.,#510);"
    )
    with pytest.raises(
        PathError, match="sphere radius 20 mm is smaller than the hole radius 30 mm"
    ):
        shape_of("ROUGH POCKET", on("#900"), more=more)


@pytest.mark.parametrize(
    ("taper", "inset"),
    [("ANGLE_TAPER(10.)", 12.0 * tan(radians(10.0))), ("DIAMETER_TAPER(#149)", 5.0)],
)
def test_hole_tapers_by_its_angle_or_to_its_final_diameter(taper: str, inset: float) -> None:
    """60 mm at the top; 50 mm at the bottom."""
    more = f"#900=ROUND_HOLE('H',#30,(),#141,#143,#180,#901,#167);#901={taper};"
    found = shape_of("ROUGH POCKET", on("#900"), more=more)
    assert isinstance(found, Area)
    assert found.walls[0].inset(0.0) == pytest.approx(inset)


@pytest.mark.parametrize("taper", ["ANGLE_TAPER(-10.)", "DIAMETER_TAPER(#127)"])
def test_hole_that_widens_with_depth_is_refused(taper: str) -> None:
    more = f"#900=ROUND_HOLE('H',#30,(),#141,#143,#180,#901,#167);#901={taper};"
    with pytest.raises(PathError, match=r"widens with depth|wider above than below"):
        shape_of("ROUGH POCKET", on("#900"), more=more)


def test_compound_feature_is_its_elements_in_their_places() -> None:
    more = "#900=COMPOUND_FEATURE('C',#30,(),#171,(#140,#150));"
    first, second = shapes_of("ROUGH POCKET", on("#900"), more=more)
    assert (first.bottom, second.bottom) == (-12.0, -10.0)
    assert isinstance(first, Area)
    xs = [edge.start.real for edge in first.walls[0].loop]
    # The compound stands at x = 127 mm, the pocket 42 mm further.
    assert 0.5 * (min(xs) + max(xs)) == pytest.approx(127.0 + 42.0)


def test_compound_feature_within_itself_is_refused() -> None:
    more = "#900=COMPOUND_FEATURE('C',#30,(),#171,(#900));"
    with pytest.raises(PathError, match=r"#900 .*nested compound features are not supported"):
        shapes_of("ROUGH POCKET", on("#900"), more=more)


@every_case(
    ("changes", "message"),
    [
        ([("#145=CARTESIAN_POINT('',(0.,0.,-12.))", "#145=CARTESIAN_POINT('',(0.,0.,0.))")],
         "#140 CLOSED_POCKET.depth: depth 0 mm"),
        ([("#145=CARTESIAN_POINT('',(0.,0.,-12.))", "#145=CARTESIAN_POINT('',(0.,0.,-41.))")],
         "floor at z = -41 mm lies below the workpiece, whose bottom is at z = -40 mm"),
        ([("(#206,#207),#141,#143,", "(#206,#207),#141,$,")], "depth"),
        ([("'POCKET CENTRE',#142,#501,", "'POCKET CENTRE',#142,#505,")],
         r"feature_placement: .*axis \(0, 0, -1\) is not parallel to the tool"),
        ([("'POCKET CENTRE',#142,#501,#502", "'POCKET CENTRE',#142,#502,#503")],
         r"axis \(1, 0, 0\) is not parallel to the tool"),
    ],
)  # fmt: skip
def test_feature_that_cannot_be_milled_says_why(
    changes: list[tuple[str, str]], message: str
) -> None:
    with pytest.raises(PathError, match=message):
        shape_of("ROUGH POCKET", *changes)


def test_feature_of_another_kind_is_named() -> None:
    more = "#900=TOOLPATH_FEATURE('T',#30,(),#141,#143);"
    with pytest.raises(PathError, match="#900 TOOLPATH_FEATURE: this kind of feature"):
        shape_of("ROUGH POCKET", on("#900"), more=more)
