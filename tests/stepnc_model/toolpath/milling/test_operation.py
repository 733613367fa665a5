"""Milling paths of the bracket and of its kin, against what the drawing says."""

from math import dist, hypot, pi, radians, sqrt, tan
from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length, points_along
from stepnc_model.toolpath.milling.operation import allowance_of, levels, milling_path
from stepnc_model.toolpath.path import Move, MoveType, Point, ToolPath
from stepnc_model.toolpath.task import ToolPathTask, job_of
from tests.every_case import every_case
from tests.stepnc_model.places import place_of

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


def path_of(id: str, *changes: tuple[str, str], more: str = "") -> ToolPath:
    return milling_path(job_at(id, *changes, more=more))


ROUND = ("#148=RECTANGULAR_CLOSED_PROFILE($,#149,#180)", "#148=CIRCULAR_CLOSED_PROFILE($,#180)")
OLD = "4.,6.,0.3,0.2);\n#207"
"""depths of cut and allowances of roughing the pocket"""

NO_ISLAND = ("#141,#143,(#190),$,#146", "#141,#143,(),$,#146")
NO_CORNERS = ("#146,#138,#147,#148", "#146,$,$,#148")
CENTRE = (42.0, 45.0)


def contact(path: ToolPath) -> list[tuple[Point, Move]]:
    return [pair for pair in path.segments() if pair[1].type is MoveType.CONTACT]


def heights(path: ToolPath) -> list[float]:
    return sorted({round(move.end[2], 9) for _, move in contact(path)}, reverse=True)


def fed(path: ToolPath) -> list[Point]:
    """Points of all feed moves, arcs finely."""
    found = []
    for start, move in path.segments():
        if move.feed is not None:
            found += [start, *points_along(start, move, step=0.01)]
    return found


def texts(path: ToolPath) -> str:
    return " | ".join(finding.message for finding in path.findings)


def test_levels_are_equal_and_none_is_deeper_than_asked() -> None:
    assert levels(0.0, -12.0, 5.0) == pytest.approx([-4.0, -8.0, -12.0])
    assert levels(0.0, -12.0, 6.0) == pytest.approx([-6.0, -12.0])
    assert levels(0.0, -12.0, 99.0) == [-12.0]


def test_roughing_leaves_its_allowance_on_the_floor() -> None:
    """12 mm less 0.2 mm in levels of 4 mm at most."""
    assert heights(path_of("ROUGH POCKET")) == pytest.approx([-11.8 / 3, -23.6 / 3, -11.8])


def test_roughing_leaves_its_allowance_on_the_wall() -> None:
    """A round pocket of 60 mm, a tool of 12 mm, 0.3 mm: centres 23.7 mm from the middle."""
    path = path_of("ROUGH POCKET", ROUND, NO_ISLAND, NO_CORNERS)
    reach = max(hypot(x - 42.0, y - 45.0) for x, y, z in fed(path) if z < -0.01)
    assert reach == pytest.approx(30.0 - 6.0 - 0.3, abs=1e-6)


def test_finishing_after_roughing_cuts_the_walls_and_sweeps_the_floor_once() -> None:
    step = ("12.,5.,0.,0.);\n#208", "6.,5.,0.,0.);\n#208")
    path = path_of("FINISH POCKET", step)
    lengths = {
        z: sum(length(a, move) for a, move in contact(path) if abs(move.end[2] - z) < 1e-9)
        for z in (-6.0, -12.0)
    }
    # 60 x 50 mm less 5 mm of tool, corners of 3 mm; the island of 8 mm and the tool about it.
    around = 2.0 * (50.0 + 40.0) - 8.0 * 3.0 + 6.0 * pi + 26.0 * pi
    # From the wall to the island the tool stays down where that is two steps away at most.
    assert around <= lengths[-6.0] <= around + 2.0 * 5.0
    assert lengths[-12.0] * 10.0 > 60 * 50 - (4 - pi) * 64 - 64 * pi
    assert lengths[-12.0] > lengths[-6.0] + 100.0


def test_finishing_without_roughing_clears_everything() -> None:
    program = edited(("(#16,#17,#18,#19)", "(#17,#18,#19)"))
    step = next(each for each in program.workingsteps if each.id == "FINISH POCKET")
    path = milling_path(job_of(program, step))
    assert heights(path) == [-12.0]
    area = 60 * 50 - (4 - pi) * 64 - 64 * pi
    assert sum(length(a, move) for a, move in contact(path)) * 10.0 > area


def test_finishing_a_floor_on_which_nothing_was_left_still_smooths_it() -> None:
    path = path_of("FINISH FACE", ("#350,1.5,0.5);", "#350,1.5,0.);"))
    assert heights(path) == [0.0]


def test_side_milling_runs_along_the_walls_only() -> None:
    change = (
        "BOTTOM_AND_SIDE_ROUGH_MILLING($,$,'ROUGH POCKET'",
        "SIDE_ROUGH_MILLING($,$,'ROUGH POCKET'",
    )
    path = path_of(
        "ROUGH POCKET",
        change,
        (OLD, "4.,6.,0.3);\n#207"),
        ROUND,
        NO_ISLAND,
        NO_CORNERS,
    )
    for start, move in contact(path):
        assert hypot(start[0] - 42.0, start[1] - 45.0) == pytest.approx(23.7, abs=1e-6)
        assert move.arc is not None
    assert heights(path) == [-4.0, -8.0, -12.0]


def test_a_face_has_no_side() -> None:
    change = ("PLANE_ROUGH_MILLING($,$,'ROUGH FACE'", "SIDE_ROUGH_MILLING($,$,'ROUGH FACE'")
    with pytest.raises(PathError, match=r"#100 PLANAR_FACE.*no walls"):
        path_of("ROUGH FACE", change, ("#350,1.5,0.5);", "#350,1.5,$,0.);"))


def test_ramp_sinks_at_its_angle_and_arcs_become_helices() -> None:
    path = path_of("ROUGH POCKET", ROUND, NO_ISLAND, NO_CORNERS)
    sinking = [
        (start, move)
        for start, move in path.segments()
        if move.type is MoveType.APPROACH and move.feed is not None and move.end[2] < start[2]
    ]
    assert any(move.arc is not None for _, move in sinking)
    for start, move in sinking:
        drop = start[2] - move.end[2]
        plan = sqrt(length(start, move) ** 2 - drop**2)
        assert drop / plan == pytest.approx(tan(radians(3.0)), abs=1e-6)


@pytest.mark.parametrize("way", ["PLUNGE_HELIX($,4.,2.)", "PLUNGE_ZIGZAG($,2.,15.)"])
def test_helix_and_zigzag_sink_at_their_angle(way: str) -> None:
    path = path_of("ROUGH POCKET", ("#342=PLUNGE_RAMP($,3.)", f"#342={way}"))
    assert path.findings == ()
    for start, move in path.segments():
        drop = start[2] - move.end[2]
        if move.type is MoveType.APPROACH and move.feed is not None and drop > 1e-6:
            plan = sqrt(length(start, move) ** 2 - drop**2)
            assert drop / plan == pytest.approx(tan(radians(2.0)), abs=1e-6)


def test_low_island_is_passed_over_above_its_top_and_its_top_is_a_level() -> None:
    """Its top 5 mm below the pocket's: cut at -5.0 + 0.2 mm, and around it below."""
    more = "#900=AXIS2_PLACEMENT_3D('',#901,#501,#502);#901=CARTESIAN_POINT('',(42.,45.,-5.));"
    path = path_of(
        "ROUGH POCKET",
        ("#190=BOSS('ISLAND',#30,(),#141", "#190=BOSS('ISLAND',#30,(),#900"),
        more=more,
    )
    assert -4.8 in heights(path)
    gaps = {True: 99.0, False: 99.0}
    for x, y, z in fed(path):
        is_above = z > -4.8 - 1e-9
        gaps[is_above] = min(gaps[is_above], hypot(x - 42.0, y - 45.0))
    assert gaps[True] < 6.0
    assert gaps[False] == pytest.approx(8.0 + 6.0 + 0.3, abs=1e-6)


def test_bosses_move_with_their_pocket_in_a_pattern() -> None:
    more = (
        "#900=GENERAL_PATTERN('',#30,(),#41,#140,(#902));"
        "#902=AXIS2_PLACEMENT_3D('',#903,#501,#502);#903=CARTESIAN_POINT('',(112.,45.,0.));"
    )
    path = path_of(
        "ROUGH POCKET", ("'ROUGH POCKET',#43,#140", "'ROUGH POCKET',#43,#900"), more=more
    )
    for middle in (42.0, 112.0):
        near = [hypot(x - middle, y - 45.0) for x, y, z in fed(path) if z < -0.01]
        assert min(near) == pytest.approx(14.3, abs=1e-6)


def test_two_overlapping_islands_are_one() -> None:
    more = (
        "#900=BOSS('SECOND',#30,(),#901,#143,#191,$);#901=AXIS2_PLACEMENT_3D('',#902,#501,#502);"
        "#902=CARTESIAN_POINT('',(48.,45.,0.));"
    )
    path = path_of("ROUGH POCKET", ("#143,(#190),$", "#143,(#190,#900),$"), more=more)
    for middle in (42.0, 48.0):
        near = [hypot(x - middle, y - 45.0) for x, y, z in fed(path) if z < -0.01]
        assert min(near) == pytest.approx(14.3, abs=1e-6)


def test_slot_as_wide_as_its_tool_is_one_pass_along_its_middle_on_each_level() -> None:
    for strategy in ("CENTER_MILLING($,.T.)", "CONTOUR_PARALLEL(0.5,.T.,.CCW.,.CLIMB.)"):
        path = path_of("MILL SLOT", ("#354=CENTER_MILLING($,.T.)", f"#354={strategy}"))
        assert heights(path) == [-3.0, -6.0]
        assert {x for x, _, _ in fed(path)} == {90.0}
        # The tool touches from 6 mm before the slot to 6 mm behind it.
        assert sum(length(a, move) for a, move in contact(path)) == pytest.approx(2 * 102.0)


def test_slot_narrower_than_its_tool_names_both() -> None:
    with pytest.raises(PathError, match="#130 SLOT: 'END MILL 12MM' of 12 mm does not fit in"):
        path_of(
            "MILL SLOT",
            ("#137=TOLERANCED_LENGTH_MEASURE(12.,", "#137=TOLERANCED_LENGTH_MEASURE(11.9,"),
        )


def test_strokes_that_are_to_be_lifted_are_not_linked() -> None:
    """63 mm of tool, a quarter of overlap on 96 mm: two strokes, a retract after each."""
    change = (
        "#350=BIDIRECTIONAL_MILLING(0.25,.T.,#502,.LEFT.,$)",
        "#350=BIDIRECTIONAL_MILLING(0.25,.T.,#502,.LEFT.,.LIFT_SHIFT_PLUNGE.)",
    )
    lifted = path_of("ROUGH FACE", change)
    joined = path_of("ROUGH FACE")
    ups = [sum(m.type is MoveType.RETRACT for m in path.moves) for path in (joined, lifted)]
    assert ups == [2, 3]


def test_spiral_never_lifts_within_a_level() -> None:
    change = ("#352=CONTOUR_PARALLEL(0.5,", "#352=CONTOUR_SPIRAL(0.5,")
    path = path_of("ROUGH POCKET", change, ROUND, NO_ISLAND, NO_CORNERS)
    retracts = [move for move in path.moves if move.type is MoveType.RETRACT]
    assert len(retracts) == 3 + 1


def wall_gaps(path: ToolPath, radius: float, corner: float, angle: float) -> float:
    """Least gap in the plan between a cutter's outline and a wall about a round pocket."""
    least = 99.0
    for x, y, z in fed(path):
        away = hypot(x - 42.0, y - 45.0)
        for above in (12.0 * i / 60 for i in range(61)):
            if z + above <= 0.0:
                below = max(corner - above, 0.0)
                reach = radius - corner + sqrt(corner**2 - below**2)
                wall = 30.0 + (z + above) * tan(radians(angle))
                least = min(least, wall - away - reach)
    return least


@pytest.mark.parametrize("corner", [0.0, 2.0, 6.0])
def test_leaning_wall_is_touched_and_not_gouged(corner: float) -> None:
    tool = (
        "MILLING_TOOL_DIMENSION(12.,$,$,26.,0.2,",
        f"MILLING_TOOL_DIMENSION(12.,$,$,26.,{corner!r},",
    )
    lean = ("#143,(#190),$,#146,#138,#147,#148", "#143,(),10.,#146,$,$,#148")
    allowances = (OLD, "4.,6.,0.,0.);\n#207")
    gap = wall_gaps(path_of("ROUGH POCKET", tool, lean, allowances, ROUND), 6.0, corner, 10.0)
    assert -1e-6 <= gap < 0.01


def test_tapered_hole_is_followed_to_its_final_diameter() -> None:
    """60 mm at the top, 50 mm at the bottom of 12 mm: centres at 19 mm there."""
    more = (
        "#900=ROUND_HOLE('H',#30,(),#141,#143,#180,#901,#167);"
        "#901=DIAMETER_TAPER(#902);"
        "#902=TOLERANCED_LENGTH_MEASURE(50.,#510);"
    )
    changes = (
        ("'ROUGH POCKET',#43,#140", "'ROUGH POCKET',#43,#900"),
        (OLD, "4.,6.,0.,0.);\n#207"),
    )
    sharp = (
        "MILLING_TOOL_DIMENSION(12.,$,$,26.,0.2,",
        "MILLING_TOOL_DIMENSION(12.,$,$,26.,0.,",
    )
    path = path_of("ROUGH POCKET", *changes, sharp, more=more)
    for z, radius in ((-4.0, 30.0 - 5.0 / 3.0), (-8.0, 30.0 - 10.0 / 3.0), (-12.0, 25.0)):
        away = max(hypot(x - 42.0, y - 45.0) for x, y, h in fed(path) if abs(h - z) < 1e-9)
        assert away == pytest.approx(radius - 6.0, abs=1e-3)


def test_ball_in_a_round_floor_stays_a_radius_inside_the_sphere() -> None:
    """Sphere of 30 mm about a point 18 mm above the pocket's top: 12 mm deep in the middle."""
    more = (
        "#900=RADIUSED_POCKET_BOTTOM_CONDITION(#901,#902);"
        "#901=CARTESIAN_POINT('',(0.,0.,18.));"
        "#902=TOLERANCED_LENGTH_MEASURE(30.,#510);"
    )
    changes = (
        NO_ISLAND,
        ("$,#146,#138,#147,#148", "$,#900,$,$,#148"),
        ROUND,
        (OLD, "1.,2.,0.,0.);\n#207"),
        (
            "#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$)",
            "#421=BALL_ENDMILL(#422,4,.RIGHT.,.F.,$)",
        ),
    )
    path = path_of("ROUGH POCKET", *changes, more=more)
    # Higher up it touches the edge of the pocket instead.
    away = [dist((x, y, z + 6.0), (42.0, 45.0, 18.0)) for x, y, z in fed(path) if z <= -6.0]
    assert max(away) == pytest.approx(24.0, abs=2e-3)
    assert min(heights(path)) == pytest.approx(-12.0)


def test_rapids_over_shapes_at_different_heights_pass_over_the_higher_one() -> None:
    more = (
        "#900=COMPOUND_FEATURE('C',#30,(),#41,(#901,#140));"
        "#901=ROUND_HOLE('H',#30,(),#902,#143,#905,$,#167);"
        "#902=AXIS2_PLACEMENT_3D('',#903,#501,#502);"
        "#903=CARTESIAN_POINT('',(110.,45.,20.));"
        "#905=TOLERANCED_LENGTH_MEASURE(30.,#510);"
    )
    path = path_of(
        "ROUGH POCKET",
        ("'ROUGH POCKET',#43,#140", "'ROUGH POCKET',#43,#900"),
        ("0.05,$,$,#33,", "0.05,$,$,$,"),
        more=more,
    )
    for start, move in path.segments():
        if move.feed is None and dist(start[:2], move.end[:2]) > 1e-9:
            assert min(start[2], move.end[2]) >= 20.0 + 10.0


@every_case(
    ("changes", "place", "word"),
    [
        ([(OLD, "0.,6.,0.3,0.2);\n#207")], "#206.axial_cutting_depth", "0 mm"),
        ([(OLD, "-4.,6.,0.3,0.2);\n#207")], "#206.axial_cutting_depth", "-4 mm"),
        ([(OLD, "0.001,6.,0.3,0.2);\n#207")], "#206.axial_cutting_depth", "1000 levels"),
        ([(OLD, "4.,6.,-0.3,0.2);\n#207")], "#206.allowance_side", "-0.3 mm"),
        ([(OLD, "4.,6.,0.3,-0.2);\n#207")], "#206.allowance_bottom", "-0.2 mm"),
        ([(OLD, "4.,6.,0.3,15.);\n#207")], "#206.allowance_bottom", "nothing is removed"),
        ([(OLD, "4.,6.,20.,0.2);\n#207")], "#140", "20 mm left"),
        ([("MILLING_TOOL_DIMENSION(12.,", "MILLING_TOOL_DIMENSION(61.,")],
         "#140", "61 mm"),
        ([("(0.,0.,50.)", "(0.,0.,0.)"), ("$,$,#33,(#36", "$,$,$,(#36")],
         "#16.its_secplane", "z = 0 mm"),
        ([("'ROUGH POCKET',10.", "'ROUGH POCKET',-1.")], "#206.retract_plane", "-1 mm"),
        ([("#352=CONTOUR_PARALLEL(0.5,.T.,.CCW.,.CLIMB.)", "#352=EXPLICIT_STRATEGY($,$)")],
         "#352", "explicit"),
    ],
)  # fmt: skip
def test_what_cannot_be_milled_is_said_with_its_value(
    changes: list[tuple[str, str]], place: str, word: str
) -> None:
    with pytest.raises(PathError) as caught:
        path_of("ROUGH POCKET", *changes)
    assert place_of(caught.value) == place
    assert word in caught.value.rule


def test_a_refusal_reads_line_entity_attribute_value_and_remedy() -> None:
    with pytest.raises(PathError) as caught:
        path_of("ROUGH POCKET", (OLD, "-4.,6.,0.3,0.2);\n#207"))
    assert str(caught.value) == (
        "line 168: #206 BOTTOM_AND_SIDE_ROUGH_MILLING.axial_cutting_depth: -4 mm: the depth of "
        'cut must be positive; set it with --set "#206.axial_cutting_depth=VALUE"'
    )


def test_floor_that_the_tool_cannot_reach_is_said() -> None:
    path = path_of(
        "ROUGH POCKET", ("#143,(#190),$,#146,#138,#147,#148", "#143,(),70.,#146,$,$,#148")
    )
    assert "the tool does not fit below z = -3.93" in texts(path)


def test_missing_retract_plane_is_assumed_and_said() -> None:
    assert "5 mm above the feature" in texts(
        path_of("ROUGH POCKET", ("'ROUGH POCKET',10.", "'ROUGH POCKET',$"))
    )


def test_allowances_are_those_of_the_operation() -> None:
    job = job_at("ROUGH POCKET")
    found = allowance_of(job, job.step.operation)
    assert (found.side, found.bottom) == (0.3, 0.2)


def test_path_begins_and_ends_on_the_security_plane() -> None:
    path = path_of("ROUGH POCKET")
    assert path.start[2] == path.end[2] == 50.0
