"""Drilling paths as a whole, on two holes of the sample bracket.

Holes of 10 mm through 40 mm at (110, 65) and (127, 65); security plane at 50 mm, retract plane
5 mm above the face, stock from −40 to 2 mm.
"""

from math import radians, tan
from pathlib import Path

import pytest

from stepnc_model.errors import PathError, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.task import job_of
from tests.every_case import every_case
from tests.stepnc_model.places import place_of

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"
PATTERN = (
    "#160=ROUND_HOLE('HOLE 1',",
    "#600=GENERAL_PATTERN('HOLES',#30,(),#41,#160,(#171,#602));\n"
    "#602=AXIS2_PLACEMENT_3D('',#603,#501,#502);\n"
    "#603=CARTESIAN_POINT('',(20.,20.,0.));\n"
    "#160=ROUND_HOLE('HOLE 1',",
)
ON_PATTERN = ("'DRILL HOLE 1',#43,#160,", "'DRILL HOLE 1',#43,#600,")


def path(name: str, *changes: tuple[str, str]) -> ToolPath:
    """Path of a workingstep of the bracket with some texts replaced."""
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == name)
    return hole_path(job_of(program, step))


def places(found: ToolPath) -> list[tuple[float, float, float]]:
    return [found.start, *(move.end for move in found.moves)]


def test_it_starts_and_ends_over_the_hole_on_the_security_plane() -> None:
    found = path("REAM HOLE 1")
    assert found.start == found.end == (110.0, 65.0, 50.0)


def test_a_reamer_goes_through_the_part_and_its_overcut() -> None:
    """40 mm and 3 mm; a reamer has no point."""
    heights = [place[2] for place in places(path("REAM HOLE 1"))]
    assert heights == pytest.approx([50.0, 5.0, -43.0, 5.0, 50.0])


def test_a_drills_full_diameter_passes_the_bottom() -> None:
    """Lip angle of 20 degrees, radius 4.9 mm."""
    lowest = min(place[2] for place in places(path("DRILL HOLE 1")))
    assert lowest == pytest.approx(-(40.0 + 3.0 + 4.9 * tan(radians(20.0))))


def test_no_rapid_goes_below_the_retract_plane() -> None:
    for name in ("CENTRE HOLE 1", "DRILL HOLE 2", "REAM HOLE 2"):
        found = path(name)
        for start, move in found.segments():
            if move.feed is None:
                assert min(start[2], move.end[2]) >= 5.0


def test_it_feeds_in_and_out() -> None:
    types = [move.type for move in path("REAM HOLE 1").moves]
    assert types == [MoveType.RAPID, MoveType.CONTACT, MoveType.RETRACT, MoveType.RAPID]


def test_between_holes_it_stays_on_the_retract_plane_above_the_stock() -> None:
    """Copies at (127, 65) and (20, 20); the stock ends 2 mm above the face."""
    found = path("DRILL HOLE 1", PATTERN, ON_PATTERN)
    rapids = [move.end for move in found.moves if move.feed is None]
    assert rapids == [
        (110.0, 65.0, 5.0),
        (127.0, 65.0, 5.0),
        (20.0, 20.0, 5.0),
        (20.0, 20.0, 50.0),
    ]


def test_between_holes_it_rises_where_stock_may_stand() -> None:
    higher = ("156.,96.,42.", "156.,96.,60.")
    found = path("DRILL HOLE 1", PATTERN, ON_PATTERN, higher)
    rapids = [move.end for move in found.moves if move.feed is None]
    # The stock ends at z = 20 mm: from 21 mm down to the retract plane at 5 mm the tool feeds.
    assert rapids[1:4] == [(110.0, 65.0, 50.0), (127.0, 65.0, 50.0), (127.0, 65.0, 21.0)]
    fed = [move for move in found.moves if move.end == (127.0, 65.0, 5.0)]
    assert all(move.feed is not None for move in fed)


def test_between_holes_it_rises_where_the_stock_is_not_known() -> None:
    unknown = ("0.05,$,$,#33,", "0.05,$,$,$,")
    found = path("DRILL HOLE 1", PATTERN, ON_PATTERN, unknown)
    assert sum(place[2] == 50.0 for place in places(found)) == 6


def test_a_hole_of_a_pattern_has_a_cycle_of_its_own() -> None:
    found = path(
        "DRILL HOLE 1", PATTERN, ON_PATTERN, ("3.,$,$,$,$,#361);", "3.,$,$,$,$,#360);")
    )
    assert len(found.cycles) == 3
    for cycle in found.cycles:
        assert found.moves[cycle.first].type is MoveType.CONTACT
        assert found.moves[cycle.last].end[2] == cycle.retract_z == 5.0


def test_a_retract_plane_left_out_is_assumed_and_said() -> None:
    found = path("REAM HOLE 1", ("'REAM HOLE 1',5.,", "'REAM HOLE 1',$,"))
    assert places(found)[1][2] == 5.0
    (finding,) = found.findings
    assert (finding.severity, finding.attribute) == (Severity.NOTE, "retract_plane")


def test_the_retract_plane_never_lies_above_the_security_plane() -> None:
    found = path("REAM HOLE 1", ("'REAM HOLE 1',5.,", "'REAM HOLE 1',80.,"))
    assert max(place[2] for place in places(found)) == 50.0


def test_a_start_point_beside_the_axis_is_not_followed_and_said() -> None:
    found = path("REAM HOLE 1", ("'REAM HOLE 1',5.,$", "'REAM HOLE 1',5.,#142"))
    assert {place[:2] for place in places(found)} == {(110.0, 65.0)}
    assert found.findings[0].severity is Severity.WARNING


@every_case(
    ("change", "place", "word"),
    [
        (("'REAM HOLE 1',5.,", "'REAM HOLE 1',-1.,"), "#214.retract_plane", "-1 mm"),
        (("'REAM HOLE 1',5.,", "'REAM HOLE 1',0.,"), "#214.retract_plane", "0 mm"),
        (("'REAM HOLE 1',#43,#160,", "'REAM HOLE 1',#43,$,"), "#24.its_feature", "no feature"),
        (
            (
                "#161=AXIS2_PLACEMENT_3D('HOLE 1',#162,#501",
                "#161=AXIS2_PLACEMENT_3D('HOLE 1',#162,#505",
            ),
            "#160",
            "(0, 0, -1)",
        ),
        (("#162,#501,#502);", "#162,#502,#503);"), "#160", "(1, 0, 0)"),
        (("(0.,0.,-40.));\n#166", "(0.,0.,0.));\n#166"), "#160.depth", "depth 0 mm"),
    ],
)
def test_what_makes_no_path_is_refused(change: tuple[str, str], place: str, word: str) -> None:
    with pytest.raises(SchemaError) as caught:
        path("REAM HOLE 1", change)
    assert place_of(caught.value) == place
    assert word in caught.value.rule


def test_an_operation_that_mills_is_refused() -> None:
    with pytest.raises(PathError, match=r"#205 .*is not a hole-making operation"):
        path("MILL SLOT")


def test_thread_drilling_without_a_thread_is_refused() -> None:
    change = (
        "#214=REAMING($,$,'REAM HOLE 1',5.,$,#460,#312,#330,3.,$,9.8,$,1.,#360,.F.,$,$)",
        "#214=THREAD_DRILLING($,$,'REAM HOLE 1',5.,$,#460,#312,#330,3.,$,9.8,$,1.,#360,.F.)",
    )
    with pytest.raises(
        PathError,
        match=r"#160 .*no thread has this hole as its applied_shape: the pitch is unknown",
    ):
        path("REAM HOLE 1", change)


def test_a_pattern_without_any_hole_is_refused() -> None:
    pattern = (
        "#160=ROUND_HOLE('HOLE 1',",
        "#600=CIRCULAR_PATTERN('NONE',#30,(),#41,#160,10.,0,(),(#601),$,0.);\n"
        "#601=CIRCULAR_OMIT(1);\n#160=ROUND_HOLE('HOLE 1',",
    )
    with pytest.raises(PathError, match="omits every hole"):
        path("DRILL HOLE 1", pattern, ON_PATTERN)


def test_a_security_plane_below_the_hole_is_refused_where_no_stock_tells_better() -> None:
    without = ("$,$,#33,(#36,#37)", "$,$,$,(#36,#37)")
    with pytest.raises(PathError, match="security plane z = -1 mm does not lie above"):
        path("REAM HOLE 1", ("(0.,0.,50.)", "(0.,0.,-1.)"), without)
