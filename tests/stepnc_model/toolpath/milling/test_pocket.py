"""Pockets and their islands, against the drawing of the bracket."""

from math import pi
from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import area, chain_length
from stepnc_model.toolpath.milling.cover import Area
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


ISLAND = "#190=BOSS('ISLAND',#30,(),#141,"


def pocket(*changes: tuple[str, str], more: str = "", id: str = "ROUGH POCKET") -> Area:
    job = job_at(id, *changes, more=more)
    (ref,) = job.step.features
    (found,) = shapes(job, ref, job.frame(ref))
    assert isinstance(found, Area)
    return found


def placed(x: float, y: float, z: float) -> tuple[tuple[str, str], str]:
    """The island somewhere else."""
    more = f"#900=AXIS2_PLACEMENT_3D('',#901,#501,#502);#901=CARTESIAN_POINT('',({x},{y},{z}));"
    return (ISLAND, ISLAND.replace("#141", "#900")), more


def test_open_pocket_is_lengthened_before_its_opening() -> None:
    """28 x 40 mm, open to the front; 10 mm of tool and 5 mm of overcut before it."""
    found = pocket(id="ROUGH OPEN POCKET")
    assert found.solid is not None
    assert area(found.solid) == pytest.approx(28.0 * 40.0)
    lowest = min(edge.start.imag for edge in found.walls[0].loop)
    assert lowest == pytest.approx(-15.0, abs=1e-6)
    assert chain_length(found.outside) == pytest.approx(28.0)


def test_open_pocket_may_be_drawn_in_either_sense() -> None:
    turned = ("(#500,#181,#182,#183)", "(#183,#182,#181,#500)")
    one, other = pocket(id="ROUGH OPEN POCKET"), pocket(turned, id="ROUGH OPEN POCKET")
    assert area(one.walls[0].loop) == pytest.approx(area(other.walls[0].loop))
    assert min(edge.start.imag for edge in other.walls[0].loop) == pytest.approx(
        -15.0, abs=1e-6
    )


def test_open_boundary_that_closes_is_refused() -> None:
    with pytest.raises(PathError, match="#150 OPEN_POCKET: the boundary is closed"):
        pocket(("(#500,#181,#182,#183)", "(#500,#181,#182,#183,#500)"), id="ROUGH OPEN POCKET")


def test_open_boundary_that_crosses_itself_is_refused() -> None:
    with pytest.raises(
        PathError, match="#150 OPEN_POCKET: the feature's boundary crosses itself"
    ):
        pocket(("(#500,#181,#182,#183)", "(#500,#182,#181,#183)"), id="ROUGH OPEN POCKET")


@pytest.mark.parametrize("corner", ["26.", "90."])
def test_corners_that_do_not_fit_are_refused(corner: str) -> None:
    with pytest.raises(
        PathError, match=r"#140 .*orthogonal_radius: corner radius .* mm does not fit"
    ):
        pocket((
            "#147=TOLERANCED_LENGTH_MEASURE(8.,",
            f"#147=TOLERANCED_LENGTH_MEASURE({corner},",
        ))


def test_boundary_that_crosses_itself_is_refused() -> None:
    more = "#900=GENERAL_CLOSED_PROFILE($,#901);#901=POLYLINE('',(#500,#182,#183,#181,#500));"
    with pytest.raises(
        PathError, match="#140 CLOSED_POCKET: the feature's boundary crosses itself"
    ):
        pocket(("#147,#148);", "#147,#900);"), more=more)


def test_boundary_that_does_not_close_is_refused_with_its_gap() -> None:
    more = "#900=GENERAL_CLOSED_PROFILE($,#901);#901=POLYLINE('',(#500,#182,#183));"
    with pytest.raises(PathError, match=r"#900 .*the profile does not close: gap of 28 mm"):
        pocket(("#147,#148);", "#147,#900);"), more=more)


@pytest.mark.parametrize("x", [20.0, 12.0, -30.0])
def test_island_that_touches_the_wall_is_named(x: float) -> None:
    """The wall stands at x = 12 mm, the island is 8 mm wide on either side."""
    change, more = placed(x, 45.0, 0.0)
    with pytest.raises(PathError, match=r"#190 BOSS.its_boundary: the boss touches the wall"):
        pocket(change, more=more)


def test_first_island_below_the_floor_does_not_hide_the_second_at_the_wall() -> None:
    change, more = placed(42.0, 45.0, -12.0)
    more += (
        "#902=BOSS('SECOND',#30,(),#903,#143,#191,$);#903=AXIS2_PLACEMENT_3D('',#904,#501,#502);"
        "#904=CARTESIAN_POINT('',(20.,45.,0.));"
    )
    with pytest.raises(PathError, match=r"#902 BOSS.its_boundary: the boss touches the wall"):
        pocket(change, ("#143,(#190),$", "#143,(#190,#902),$"), more=more)


def test_island_knows_its_own_top() -> None:
    change, more = placed(42.0, 45.0, -5.0)
    assert pocket(change, more=more).walls[1].top == -5.0


def test_island_below_the_floor_is_none() -> None:
    change, more = placed(42.0, 45.0, -12.0)
    assert len(pocket(change, more=more).walls) == 1


@every_case("slope", ["-5.", "89.5", "200."])
def test_wall_that_no_tool_makes_from_above_is_refused(slope: str) -> None:
    with pytest.raises(PathError, match=r"a wall at .*below 89°"):
        pocket(("#143,(#190),$,#146", f"#143,(#190),{slope},#146"))


def test_floor_that_is_part_of_a_sphere_is_a_wall_that_closes_below() -> None:
    """A sphere of 50 mm, its lowest point on the depth plane: 30 mm from the axis at 10 mm."""
    more = (
        "#900=RADIUSED_POCKET_BOTTOM_CONDITION(#901,#149);#901=CARTESIAN_POINT('',(0.,0.,38.));"
    )
    found = pocket(("(#190),$,#146", "(),$,#900"), more=more)
    wall = found.walls[-1]
    assert area(wall.loop) == pytest.approx(2500.0 * pi)
    assert [wall.inset(height) for height in (0.0, 10.0, 50.0)] == pytest.approx([50, 20, 0])


def test_floor_of_any_shape_is_not_made() -> None:
    more = "#900=GENERAL_POCKET_BOTTOM_CONDITION(#901);#901=TOPOLOGICAL_REGION();"
    with pytest.raises(PathError, match="bottom_condition: a floor of general shape"):
        pocket(("(#190),$,#146", "(#190),$,#900"), more=more)
