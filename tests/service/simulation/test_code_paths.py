"""Moves of NC code that can be run: what is left out removes nothing."""

from math import pi

import numpy as np
import pytest

from service.along_path.course import BlockLog, stretches_of
from service.simulation.code_paths import CodePaths
from service.simulation.detour import BRIDGE
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import axis_limits
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from stepnc_model.post.blocks import Comment, Coolant, CoolantKind, ProgramStopBlock, Rapid
from stepnc_model.post.dialect import Dialect
from tests.service.along_path.foreign import BAR, END, HEAD, lines_of, paths_of, slot

PLAIN = HEAD + slot(10.0) + END


def volume(code: CodePaths) -> float:
    """Volume that a program removes, mm³."""
    run = code.prepared(0.0)
    control = control_model(ControlModelName.EXACT_STOP, axis_limits(run.machine))
    stock = run.stock("")
    assert isinstance(stock, MillingStock | TurningStock)
    before = stock.volume
    for _ in stretches_of(
        run,
        None,
        control=control,
        bounds=lambda _: None,
        log=BlockLog(run.blocks),
        watch=lambda *_: None,
    ):
        pass
    return abs(stock.volume - before)


def reasons(code: CodePaths) -> str:
    """What the findings say, in one text."""
    return "\n".join(f"{each.line}: {each.message}" for each in code.findings)


SLOT = 12.0 * 4.0 * 100.0
"""mm³"""

LEFT_OUT = {
    "an unknown tool": "T9 M6\nS3000 M3\n" + slot(40.0),
    "a tool from a variable": "T#1 M6\nS3000 M3\n" + slot(40.0),
    "another frame": "G55\n" + slot(40.0) + "G54\n",
    "a frame that is set anew": "G10 L2 P1 X0. Y30. Z0.\nG54\n" + slot(40.0),
    "block delete": "".join(f"/{line}\n" for line in slot(40.0).splitlines()),
    "a rotation": "G68 X0. Y0. R45.\n" + slot(40.0) + "G69\n",
    "a feed from a variable": slot(40.0).replace("F300.", "F#100"),
    "an end from a variable": slot(40.0).replace("X110.", "X#100"),
    "a condition": "IF [#1 EQ 1] GOTO 100\n" + slot(40.0) + "N100\n",
    "compensation": (
        "G0 X-20. Y40.\nZ-4.\nG41 D1 G1 X-10. F300.\nX50.\nG3 X52. Y42. R2.\nG1 Y60.\n"
        "G40 X120. Y60.\nG0 Z20.\n"
    ),
}


@pytest.mark.parametrize("what", LEFT_OUT)
def test_what_is_left_out_removes_nothing_and_is_told(what: str) -> None:
    text = HEAD + slot(10.0) + LEFT_OUT[what] + END
    code = paths_of(text, dialect=Dialect.FANUC)
    assert volume(code) == pytest.approx(SLOT, rel=0.01)
    said = reasons(code)
    for line in lines_of(text, "G1 X110.", "G1 X#100"):
        if line > len((HEAD + slot(10.0)).splitlines()):
            assert str(line) in said
            assert not code.can_change[line]
    assert code.can_change[lines_of(text, "G1 X110. F300.")[0]]


@pytest.mark.parametrize(("code", "removed"), [("G41", 0.0), ("G42", SLOT)])
def test_the_tool_cuts_beside_a_compensated_contour(code: str, removed: float) -> None:
    """The contour is the far side of the stock: to its left is air, to its right a slot."""
    text = HEAD + f"G0 X-30. Y80.\nZ-4.\n{code} D1 G1 X-10. F300.\nX110.\nG40 X130.\nG0 Z20.\n"
    paths = paths_of(text + END, dialect=Dialect.FANUC)
    assert volume(paths) == pytest.approx(removed, rel=0.01)
    line = lines_of(text, "X110.")[0]
    assert paths.can_change[line]
    assert not paths.can_split[line]
    assert "goes beside the compensated contour" in reasons(paths)


def test_the_tool_goes_over_the_stock_where_moves_are_left_out() -> None:
    # The contour ends 4 mm deep on the far side: a straight way there would cut a slot.
    text = (
        HEAD + "G0 X-20. Y-20.\nZ-4.\nG41 D1 G1 X-10. Y40. F300.\nX100.\n"
        "G3 X102. Y42. R2.\nG40 G1 X120. Y60.\n"
        "G1 Y70. F300.\nX112.\nG0 Z20.\n" + END
    )
    code = paths_of(text)
    assert volume(code) == pytest.approx(0.0, abs=1.0)
    ways = [block for line, block in code.prepared(0.0).blocks if line == BRIDGE]
    assert ways
    assert max(block.end[2] for block in ways if isinstance(block, Rapid)) > 0.0


def test_a_turning_tool_goes_beside_the_bar_where_moves_are_left_out() -> None:
    # Along the axis, the way to Z-30 would turn 30 mm of the bar to a diameter of 46 mm.
    text = (
        "%\nO0001\nG21 G99\nT0303\nG97 S800 M3\nG0 X60. Z5.\nG1 Z4. F0.2\n"
        "G42 X46. Z-20.\nG1 Z-25.\nG40 X46. Z-30.\nG1 Z-40.\nG0 X60.\nM30\n%\n"
    )
    code = paths_of(text, stock=BAR)
    turned = pi * (25.0**2 - 23.0**2)
    assert 10.0 * turned <= volume(code) <= 15.0 * turned


def test_moves_after_block_delete_stay_until_their_start_is_certain() -> None:
    text = HEAD + slot(10.0) + "/G0 Y40.\nZ-4.\nG1 X110. F300.\nG0 Z20.\n" + slot(60.0) + END
    code = paths_of(text)
    first, doubtful, last = lines_of(text, "G1 X110.")
    assert code.can_change[[first, last]].all()
    assert not code.can_change[doubtful]
    assert "they begin where moves end that the operator may skip" in reasons(code)


def test_parts_begin_with_tools_and_with_comments_about_surfaces() -> None:
    text = (
        HEAD + "(ROUGH POCKET)\n" + slot(10.0) + "(FINISH POCKET)\n" + slot(10.0)
        + "T2 M6\nS3000 M3\n" + slot(40.0) + END
    )  # fmt: skip
    parts = paths_of(text).parts
    assert [(part.name, part.is_finishing) for part in parts] == [
        ("T1", False),
        ("T1 (2)", True),
        ("T2", False),
    ]


def test_a_comment_in_a_subprogram_concerns_its_calls_alone() -> None:
    text = (
        HEAD + slot(10.0) + "M98 P2\n(ROUGH)\n" + slot(60.0) + "M30\n"
        "O0002 (FINISH SLOT)\n" + slot(40.0) + "M99\n%\n"
    )
    code = paths_of(text, dialect=Dialect.FANUC)
    assert [part.is_finishing for part in code.parts] == [False, True, False]
    comments = [each for _, each in code.prepared(0.0).blocks if isinstance(each, Comment)]
    assert [each.text for each in comments if each.workingstep] == ["T1", "T1 (2)", "T1 (3)"]
    assert [each.text for each in comments if not each.workingstep] == ["FINISH SLOT", "ROUGH"]


def test_coolant_and_stops_of_any_code_run() -> None:
    text = HEAD + "M8\n" + slot(10.0) + "/M7\nM9\nM0\n" + END
    found = [each for _, each in paths_of(text, dialect=Dialect.FANUC).prepared(0.0).blocks]
    flood = Coolant(kinds=frozenset({CoolantKind.FLOOD}))
    # What the operator may skip does not run.
    assert [each for each in found if isinstance(each, Coolant)] == [flood, Coolant()]
    assert ProgramStopBlock() in found


def test_lines_that_run_more_than_once_are_not_split() -> None:
    text = HEAD + "M98 P2 L3\nM30\nO0002\n" + slot(40.0) + "M99\n%\n"
    code = paths_of(text, dialect=Dialect.FANUC)
    line = lines_of(text, "G1 X110.")[0]
    assert code.can_change[line]
    assert not code.can_split[line]


def test_the_contour_of_a_lathe_cycle_stays() -> None:
    text = (
        "%\nO0001\nG21 G99\nT0101\nG97 S800 M3\nG0 X55. Z2.\nG71 U2. R1.\n"
        "G71 P10 Q20 U0.4 W0.1 F0.25\nN10 G0 X20.\nG1 Z-20. F0.15\nX40. Z-30.\nN20 X52.\n"
        "G0 X60. Z5.\nX46.\nG1 Z-10. F0.2\nG0 X60.\nM30\n%\n"
    )
    code = paths_of(text, stock=BAR)
    assert not code.can_change[lines_of(text, "G1 Z-20.", "X40. Z-30.", "N20")].any()
    assert code.can_change[lines_of(text, "G1 Z-10.")[0]]


def test_an_unknown_spindle_speed_keeps_the_feed() -> None:
    text = HEAD + "S#1 M3\n" + slot(10.0) + "S3000 M3\n" + slot(40.0) + END
    code = paths_of(text, dialect=Dialect.FANUC)
    unknown, known = lines_of(text, "G1 X110.")
    assert (code.can_change[unknown], code.can_change[known]) == (False, True)
    assert volume(code) == pytest.approx(2.0 * SLOT, rel=0.01)


def test_a_cycle_whose_feed_serves_other_moves_keeps_it() -> None:
    text = (
        "N10 G71 G90 G17 G54\nN20 T5 D1\nN30 M6\nN40 S2000 M3\nN50 G0 X20 Y20 Z5\n"
        "N60 G1 X30 F150\nN70 CYCLE82(5,0,2,-10,0,0.5)\nN80 G0 Z50\nM30\n"
    )
    code = paths_of(text, dialect=Dialect.SINUMERIK)
    assert not code.can_change[lines_of(text, "CYCLE82")[0]]
    assert "the feed of a cycle serves other moves as well" in reasons(code)


def test_the_plain_program_runs_whole() -> None:
    code = paths_of(PLAIN)
    assert not code.findings
    assert volume(code) == pytest.approx(SLOT, rel=0.01)
    assert np.flatnonzero(code.can_change).tolist() == lines_of(PLAIN, "G1 X110.")


WORN = (
    "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000 F300{wear}\n2 L X-20 Y+40 R0 FMAX M3\n"
    "3 L Z+5 FMAX\n4 L Z-4 FMAX\n5 L X-10 Y+40 {side} F300\n6 L X+110\n7 L X+130 Y+50 R0\n"
    "8 L Z+50 FMAX M30\n9 END PGM A MM\n"
)


def worn(wear: str, side: str = "R0") -> CodePaths:
    """Pass through the block with a tool whose call states its wear."""
    return paths_of(WORN.format(wear=wear, side=side), dialect=Dialect.HEIDENHAIN)


@pytest.mark.parametrize("length", [0.5, -0.25])
def test_a_tool_call_with_a_length_cuts_that_much_higher(length: float) -> None:
    removed = volume(worn(f" DL{length:+g}"))
    assert removed == pytest.approx((4.0 - length) / 4.0 * volume(worn("")), rel=0.002)


@pytest.mark.parametrize("radius", [0.0, 0.05, -0.05])
def test_a_tool_call_with_a_radius_goes_that_much_farther_from_the_contour(
    radius: float,
) -> None:
    moves = worn(f" DR{radius:+g}" if radius else "", "RL").program.moves
    row = int(np.flatnonzero(moves.end[:, 0] == 110.0)[0])
    assert moves.end[row, 1] == pytest.approx(40.0 + 6.0 + radius)


def test_moves_with_a_length_from_a_variable_are_left_out_and_told() -> None:
    code = worn(" DLQ5")
    assert volume(code) == 0.0
    assert "the length of the tool (DL) is not known" in reasons(code)
