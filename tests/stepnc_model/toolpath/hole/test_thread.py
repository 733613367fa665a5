"""Thread drilling: M12 x 1.5 in a hole of the sample bracket, 40 mm through at (110, 65).

The tool of 10.2 mm leads its axis on a circle of 0.9 mm; its point is flat.
"""

from math import atan2, hypot, pi
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import points_along, radius
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.path import Dwell, Move, MoveType, ToolPath
from stepnc_model.toolpath.task import job_of
from tests.every_case import every_case
from tests.stepnc_model.places import place_of

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"

THREAD = (
    ("#166=TOLERANCED_LENGTH_MEASURE(10.,", "#166=TOLERANCED_LENGTH_MEASURE(10.5,"),
    (
        "#214=REAMING($,$,'REAM HOLE 1',5.,$,#460,#312,#330,3.,$,9.8,$,1.,#360,.F.,$,$)",
        "#214=THREAD_DRILLING($,$,'M12',5.,$,#460,#311,#330,3.,$,$,0.5,2.,$,.F.)",
    ),
    ("#461=TAPERED_REAMER(#462,6,", "#461=MILLING_THREADING_TOOL(#462,2,"),
    (
        ".RIGHT.,.F.,$,$);\n#462=MILLING_TOOL_DIMENSION(10.,$,$,45.,",
        ".RIGHT.,.F.,$);\n#462=MILLING_TOOL_DIMENSION(10.2,$,$,45.,",
    ),
    (
        "#170=",
        "#620=CATALOGUE_THREAD('M12',#30,(),#161,#163,#621,(#160),.T.,$,#622,#622,12.,#623,"
        "#624,#625);\n"
        "#621=PARTIAL_AREA_DEFINITION(30.,#161,$);\n"
        "#622=DESCRIPTIVE_PARAMETER('','6H');\n"
        "#623=NUMERIC_PARAMETER('PITCH',1.5,'MM');\n"
        "#624=DESCRIPTIVE_PARAMETER('HAND','RIGHT');\n"
        "#625=SPECIFICATION((),'ISO 965',$,$);\n#170=",
    ),
)
BLIND = ("#167=THROUGH_BOTTOM_CONDITION()", "#167=FLAT_HOLE_BOTTOM()")
FORWARD = ("0.5,2.,$,.F.)", "0.5,2.,$,.T.)")
ON_THREAD = ("'REAM HOLE 1',#43,#160,", "'REAM HOLE 1',#43,#620,")


def path(*changes: tuple[str, str]) -> ToolPath:
    """Path of the threaded hole with some texts replaced."""
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in (*THREAD, *changes):
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == "REAM HOLE 1")
    return hole_path(job_of(program, step))


def helix(found: ToolPath) -> tuple[tuple[float, float, float], Move]:
    """The cut of several turns, with its start."""
    (cut,) = (
        (start, move)
        for start, move in found.segments()
        if move.arc is not None
        and abs(move.arc.turn) > pi + 1e-9
        and move.type is MoveType.CONTACT
    )
    return cut


def test_it_drills_along_the_axis_and_threads_on_its_way_out() -> None:
    """Through 40 mm and 3 mm; the thread is 30 mm long, and left above the part."""
    assert isinstance(path().steps[2], Dwell)
    moves = path().moves
    assert [move.arc is not None for move in moves] == [
        False,
        False,
        False,
        True,
        True,
        True,
        False,
        False,
    ]
    assert moves[1].end == (110.0, 65.0, -43.0)
    assert moves[2].end == (110.0, 65.0, -30.0)
    assert moves[-2].end == (110.0, 65.0, 5.0)
    assert moves[-2].type is MoveType.RETRACT


def test_the_helix_rises_one_pitch_a_turn() -> None:
    """30 mm of 1.5 mm are 20 turns, a quarter of one of them on the way onto the helix."""
    start, cut = helix(path())
    assert cut.arc is not None
    turns = cut.arc.turn / (2.0 * pi)
    assert turns == pytest.approx(20.0)
    assert cut.end[2] - start[2] == pytest.approx(turns * 1.5)
    assert cut.end[:2] == start[:2]


def test_its_radius_is_what_the_thread_is_wider_than_the_tool() -> None:
    start, cut = helix(path())
    assert cut.arc is not None
    assert radius(start, cut.arc) == pytest.approx(0.5 * (12.0 - 10.2))
    assert cut.arc.centre[:2] == (110.0, 65.0)


@pytest.mark.parametrize("way", [(), (FORWARD,)], ids=["out", "in and out"])
@pytest.mark.parametrize(("hand", "sense"), [("RIGHT", 1.0), ("LEFT", -1.0)])
def test_it_follows_the_thread_from_the_axis_and_back_to_it(
    way: tuple[tuple[str, str], ...], hand: str, sense: float
) -> None:
    """Wherever the tool is beside the axis, its height tells its angle: one thread."""
    found = path(("'RIGHT'", f"'{hand}'"), *way)
    base = helix(found)[0][2]
    for start, move in found.segments():
        if move.arc is None:
            continue
        for x, y, z in points_along(start, move, step=0.1):
            if hypot(x - 110.0, y - 65.0) > 1e-6:
                angle = sense * atan2(y - 65.0, x - 110.0) / (2.0 * pi)
                turns = (z - base) / 1.5 - angle
                assert turns == pytest.approx(round(turns), abs=1e-6)


def test_forward_it_drills_on_the_helix_and_returns_through_it() -> None:
    """From above the face down to the bottom: 43 mm and the rest of a turn."""
    start, cut = helix(path(FORWARD))
    assert cut.arc is not None
    assert cut.arc.turn == pytest.approx(-2.0 * pi * 29)
    assert cut.end[2] == pytest.approx(-43.0)
    assert start[2] == pytest.approx(-43.0 + 29 * 1.5)
    assert start[2] >= 0.0
    back = path(FORWARD).moves[4]
    assert back.arc is not None
    assert back.type is MoveType.NO_CONTACT
    assert back.arc.turn == -cut.arc.turn
    assert back.end == pytest.approx(start)


def test_that_the_helix_in_has_one_feed_is_said() -> None:
    (finding,) = path(FORWARD, ("0.5,2.,$,", "0.5,2.,#361,")).findings
    assert finding.attribute == "its_machining_strategy"


def test_a_blind_hole_is_left_by_one_pitch_first() -> None:
    """A thread as long as the hole ends one pitch above its bottom, which is said."""
    found = path(BLIND, ("DEFINITION(30.", "DEFINITION(40."))
    assert found.moves[2].end[2] == pytest.approx(-40.0 + 1.5)
    (finding,) = found.findings
    assert "the thread is 1.5 mm too short" in finding.message


def test_a_point_lies_below_the_teeth() -> None:
    """45 degrees: 5.1 mm of point below the thread of 30 mm."""
    found = path(("DIMENSION(10.2,$", "DIMENSION(10.2,45."))
    assert found.moves[2].end[2] == pytest.approx(-35.1)


def test_the_thread_itself_may_be_the_feature() -> None:
    assert path(ON_THREAD).steps == path().steps


@pytest.mark.parametrize(
    ("number", "pitch"),
    [
        ("1.5,'MM'", 1.5),
        ("1.25,'mm'", 1.25),
        ("2.,'PITCH'", 2.0),
        ("20.,'INCH'", 1.27),
        ("16.,'TPI'", 1.5875),
    ],
)
def test_a_pitch_is_metric_and_a_density_is_per_inch(number: str, pitch: float) -> None:
    start, cut = helix(path(("1.5,'MM'", number)))
    assert cut.arc is not None
    assert (cut.end[2] - start[2]) / cut.arc.turn == pytest.approx(pitch / (2.0 * pi))


@given(
    length=st.floats(1.0, 40.0),
    pitch=st.floats(0.5, 4.0),
    point=st.floats(3.0, 40.0),
)
def test_the_teeth_go_from_the_end_of_the_thread_to_above_the_part(
    length: float, pitch: float, point: float
) -> None:
    found = path(
        ("DEFINITION(30.", f"DEFINITION({length!r}"),
        ("1.5,'MM'", f"{pitch!r},'MM'"),
        ("DIMENSION(10.2,$", f"DIMENSION(10.2,{point!r}"),
    )
    onto = found.moves[2].end[2]
    start, cut = helix(found)
    teeth = found.moves[1].end[2] + 43.0
    assert onto - teeth == pytest.approx(-length)
    assert -1e-6 <= cut.end[2] - teeth <= pitch + 1e-9
    assert min(move.end[2] for move in found.moves) == found.moves[1].end[2]
    assert start[2] - onto == pytest.approx(0.25 * pitch)


@every_case(
    ("change", "place", "word"),
    [
        (
            ("(#160),.T.", "(#170),.T."),
            "#160",
            "no thread",
        ),
        (("1.5,'MM'", "0.,'MM'"), "#620.number_of_threads", "positive"),
        (("1.5,'MM'", "1.5,'FURLONG'"), "#620.number_of_threads", "FURLONG"),
        (("1.5,'MM'", "1.E-3,'MM'"), "#620.number_of_threads", "at most 1000"),
        (("'RIGHT')", "'WRONG')"), "#620.thread_hand", "LEFT or RIGHT"),
        (("#622,#622,12.,", "#622,#622,0.,"), "#620.major_diameter", "0 mm"),
        (
            ("#622,#622,12.,", "#622,#622,10.2,"),
            "#214.its_tool",
            "thread of 10.2 mm",
        ),
        (("DEFINITION(30.", "DEFINITION(-1."), "#620.partial_profile", "-1 mm"),
        (
            ("DIMENSION(10.2", "DIMENSION(10.6"),
            "#214.its_tool",
            "hole of 10.5 mm",
        ),
        (
            ("#620=CATALOGUE_THREAD(", "#630=SPECIFICATION((),'',$,$);\n#620=DEFINED_THREAD("),
            "#214.its_tool",
            "minor diameter",
        ),
    ],
)
def test_what_cannot_be_threaded_is_refused(
    change: tuple[str, str], place: str, word: str
) -> None:
    sizes = ("#624,#625)", "#624,11.,9.,$)")
    changes = (change, sizes) if "DEFINED" in change[1] else (change,)
    with pytest.raises(PathError) as caught:
        path(*changes)
    assert place_of(caught.value) == place
    assert word in caught.value.rule


def test_a_helix_that_leaves_a_core_is_refused() -> None:
    with pytest.raises(PathError, match="leaves a core"):
        path(FORWARD, ("DIMENSION(10.2", "DIMENSION(5."))
