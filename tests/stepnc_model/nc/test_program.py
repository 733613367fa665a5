"""NC code of every control, read as what it says."""

from collections.abc import Iterable
from functools import cache
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.nc.moves import MoveFlag, MoveKind
from stepnc_model.nc.neutral_blocks import neutral_blocks
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.post.blocks import Block, Cycles, Linear, MachineType, Rapid
from stepnc_model.post.canonical import commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import PLACES, write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate
from tests.every_case import every_case
from tests.stepnc_model.post.trace import TracedEvent, trace

PARTS = Path(__file__).parents[3] / "examples" / "parts"
CONTROLS = [control for control in Dialect if control is not Dialect.CANONICAL]
PROGRAMS = [
    (MachineType.MILL, control, cycles) for control in CONTROLS for cycles in Cycles
] + [
    (MachineType.LATHE, control, Cycles.EXPANDED)
    for control in CONTROLS
    if control is not Dialect.HEIDENHAIN
]


@cache
def posted(machine: MachineType) -> tuple[Block, ...]:
    name = "bracket" if machine is MachineType.MILL else "shaft"
    program = Program.load(PARTS / f"{name}.stpnc")
    return tuple(blocks_of(program, list(generate(program)), name="P"))


@cache
def code_of(machine: MachineType, control: Dialect, cycles: Cycles) -> bytes:
    lines = write(posted(machine), control, cycles=cycles)
    return "".join(f"{line}\n" for line in lines).encode()


CUTS = {"feed", "arc", "thread", "tap"}


def cuts(blocks: Iterable[Block], places: int) -> list[TracedEvent]:
    """Moves at a feed, with all that holds while they run."""
    return [each for each in trace(commands(blocks, places=places)) if each.kind in CUTS]


@pytest.mark.parametrize(("machine", "control", "cycles"), PROGRAMS)
def test_our_own_code_reads_back_as_it_was_meant(
    machine: MachineType, control: Dialect, cycles: Cycles
) -> None:
    program = read_program(code_of(machine, control, cycles))
    assert (program.dialect, program.machine) == (control, machine)
    assert not [each for each in program.findings if "not understood" in each.message]
    mine = cuts((block for _, block in neutral_blocks(program)), PLACES[control])
    blocks: Iterable[Block] = posted(machine)
    if cycles is Cycles.OWN:
        # Cycles of the control approach holes in rapid.
        blocks = read_blocks(code_of(machine, control, cycles).decode().splitlines(), control)
    meant = cuts(blocks, PLACES[control])
    assert len(mine) == len(meant)
    for one, other in zip(mine, meant, strict=True):
        assert (one.kind, one.state) == (other.kind, other.state)
        assert one.numbers == pytest.approx(other.numbers, abs=2.5e-3)
        assert one.speeds == pytest.approx(other.speeds, abs=0.5)


@pytest.mark.parametrize(("machine", "control", "cycles"), PROGRAMS)
def test_blocks_laid_end_to_end_are_the_file(
    machine: MachineType, control: Dialect, cycles: Cycles
) -> None:
    code = code_of(machine, control, cycles)
    text = read_program(code).text
    assert "".join(text.blocks()).encode("latin-1") == code


def fed(program: NcProgram) -> list[tuple[float, ...]]:
    moves = program.moves
    return [
        (*moves.end[row].tolist(), moves.feed[row])
        for row in range(len(moves))
        if moves.kind[row] in {MoveKind.LINE, MoveKind.ARC}
    ]


def test_a_program_of_a_haas_with_subprograms_in_every_frame() -> None:
    program = read_program(
        b"%\nO00010 (HAAS)\nT1 M6\nG0 G90 G54 X0. Y0. S2000 M3\nG43 H1 Z10.\nM97 P100\n"
        b"G55 X0. Y0.\nM97 P100 L2\nM30\nN100 G0 Z2.\nG1 Z-1. F200.\nX10.\nG0 Z2.\nM99\n%\n",
    )
    assert program.dialect is Dialect.HAAS
    assert program.moves.frames == ("G54", "G55")
    cuts = program.moves.kind == MoveKind.LINE
    assert program.moves.frame[cuts].tolist() == [0, 0, 1, 1, 1, 1]
    assert program.moves.call[cuts].tolist() == [1, 1, 2, 2, 3, 3]
    assert program.moves.calls == ((0, -1), (0, 5), (0, 7), (0, 7))
    assert [feed[3] for feed in fed(program)] == pytest.approx([200.0 / 60.0] * 6)


def test_a_feed_per_revolution_and_a_surface_speed_are_resolved() -> None:
    program = read_program(
        b"O1234\nG50 S2000\nT0101\nG96 S100 M3\nG0 X40. Z2.\nG1 Z-10. F0.2\nX60.\nG97 S600\n"
        b"G98 G1 Z-20. F120.\nM30\n",
        dialect=Dialect.FANUC,
        machine=MachineType.LATHE,
    )
    feeds = [values[3] for values in fed(program)]
    # n = v_c / (π d): 100 m/min at 40 mm are 795.77 rpm, at 60 mm 530.52 rpm.
    assert feeds == pytest.approx([0.2 * 795.7747 / 60, 0.2 * 530.5165 / 60, 2.0], rel=1e-6)
    assert program.moves.end[-1].tolist() == [30.0, 0.0, -20.0] or isnan(
        program.moves.end[-1][1]
    )


def test_inverse_time_gives_the_feed_of_each_move() -> None:
    program = read_program(b"G21 G0 X0 Y0 Z0\nG93 G1 X30 F2\nY40 F4\nG94 X0 F100\n")
    feeds = [values[3] * 60.0 for values in fed(program)]
    assert feeds == pytest.approx([60.0, 160.0, 100.0])


def test_repeats_are_expanded_in_every_dialect() -> None:
    programs = {
        Dialect.LINUXCNC: b"G0 X0 Y0 Z0\nF60\no1 repeat [3]\nG91 G1 X1\no1 endrepeat\nM2\n",
        Dialect.FANUC: b"O1\nG0 X0. Y0. Z0.\nF60.\nM98 P30002\nM30\nO2\nG91 G1 X1.\nM99\n",
        Dialect.SINUMERIK: b"G0 X0 Y0 Z0\nF60\nLAB: G91 G1 X1\nREPEAT LAB P=2\nM30\n",
        Dialect.HEIDENHAIN: b"BEGIN PGM A MM\nL X+0 Y+0 Z+0 FMAX\nLBL 1\nL IX+1 F60\n"
        b"CALL LBL 1 REP2\nEND PGM A MM\n",
    }
    for control, code in programs.items():
        program = read_program(code, dialect=control, machine=MachineType.MILL)
        assert [values[0] for values in fed(program)] == [1.0, 2.0, 3.0], control
        assert not [each for each in program.findings if "not und" in each.message]


@pytest.mark.parametrize(
    ("control", "code", "line"),
    [
        (Dialect.FANUC, b"O1\nG1 X1. F1.\nM98 P1\nM30\n", "line 3: calls and repeats"),
        (Dialect.LINUXCNC, b"o1 repeat [99999999]\nG4 P0\no1 endrepeat\n", "line"),
    ],
)
def test_endless_programs_are_refused_with_a_line(
    control: Dialect, code: bytes, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("stepnc_model.nc.flow.MOST_REPEATED", 2000)
    with pytest.raises(PostError, match=line):
        read_program(code, dialect=control)


def test_what_is_not_understood_stops_only_what_depends_on_it() -> None:
    program = read_program(
        b"G21 G90\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX10\nG5.3 X20 Y5\nG1 Y10\nX30\n"
        b"X40 Y11 Z-1\nX[#1]\nY3\nX0 Y0\n",
        dialect=Dialect.LINUXCNC,
    )
    lines = {each.line for each in program.findings if "not understood" in each.message}
    assert lines == {6}
    moves = program.moves
    advisable = {program.text.line(int(block)) for block in moves.block[moves.is_advisable]}
    assert advisable == {4, 5}
    assert np.isnan(moves.end[moves.block == 9][:, 0]).all()


def test_missing_values_are_found_by_line() -> None:
    program = read_program(
        b"G21\nG0 X0 Y0 Z0\nG1 X1\nX2 F0\nG95 X3 F0.1\nT1 M6\nS500 M3\nG1 X4\n",
        dialect=Dialect.LINUXCNC,
    )
    found = {(each.line, each.message.split(":")[0]) for each in program.findings}
    assert (3, "no feed F is in force") in found
    assert (4, "the feed is 0") in found
    assert (5, "a feed per revolution while the spindle is stopped") in found
    assert (3, "no tool was called before this cut") in found


def test_rapids_lead_to_where_the_first_cut_begins() -> None:
    program = read_program(b"G21\nT2 M6\nS600 M3\nG0 X1 Y2\nZ3\nG1 Z0 F60\n")
    blocks = [block for _, block in neutral_blocks(program, name="x")]
    assert Rapid(end=(1.0, 2.0, 3.0)) in blocks
    assert isinstance(blocks[-2], Linear)


@pytest.mark.parametrize(
    "control", [each for each in CONTROLS if each is not Dialect.HEIDENHAIN]
)
def test_short_blocks_mean_the_same_as_with_a_comment(control: Dialect) -> None:
    lines = [
        *("G90", "T1 M6", "S900 M3", "G0 X1.0 Y2.5", "Z0.5 F120", "G01 Z-1.", "N7 X5.5 Y-3."),
        *(
            "X.5",
            "G1X2.0Y1.0",
            "G20",
            "X1.0 F10.5",
            "G91",
            "X1.0",
            "G90",
            "G41 D1",
            "X3.0 Y3.0",
        ),
        *(
            "G40",
            "X4.0",
            "G95 F0.2",
            "X5.0",
            "G93",
            "X6.0 F2.",
            "G94",
            "X7.0 F50",
            "G0",
            "Z5.0",
        ),
        *(
            "G81 X1. Y1. Z-2. R1. F60",
            "X2.0",
            "G80",
            "G0 Z9.0",
            "G68 R5",
            "G1 X8.0",
            "A5.",
            "X9.0",
        ),
    ]
    mark = " ;a" if control is Dialect.SINUMERIK else " (a)"
    short = read_program("\n".join(lines).encode(), dialect=control, machine=MachineType.MILL)
    long = read_program(
        "\n".join(line + mark for line in lines).encode(),
        dialect=control,
        machine=MachineType.MILL,
    )
    assert short.moves.rows.tobytes() == long.moves.rows.tobytes()
    assert short.moves.settings == long.moves.settings


def test_a_tool_may_have_a_name() -> None:
    for control, code in (
        (Dialect.SINUMERIK, b'G71\nT="MILL 10"\nM6\nG0 X0 Y0 Z0\nG1 X1 F100\nM30\n'),
        (Dialect.HEIDENHAIN, b'TOOL CALL "MILL 10" Z S900\nL X+0 Y+0 Z+0 FMAX\nL X+1 F100\n'),
    ):
        program = read_program(code, dialect=control)
        move = program.moves.move(len(program.moves) - 1)
        assert (move.setting.tool, move.setting.tool_name) == (None, "MILL 10")
        assert [each.message.split(":")[0] for each in program.findings] == [
            "the tool has a name and no number"
        ]


def test_the_motion_before_a_cycle_is_in_force_after_it() -> None:
    code = b"G90 G0 X0. Y0. Z9.\nG81 X1. Z-1. R1. F60.\nG80\nZ20.\nG1 Z3.\n"
    fanuc = read_program(code, dialect=Dialect.FANUC)
    assert fanuc.moves.kind[-2:].tolist() == [MoveKind.RAPID, MoveKind.LINE]
    linuxcnc = read_program(code, dialect=Dialect.LINUXCNC)
    assert linuxcnc.moves.kind[-2:].tolist() == [MoveKind.UNKNOWN, MoveKind.LINE]


@every_case(
    ("dialect", "code", "said"),
    [
        (Dialect.FANUC, "G1 X5. F100.\nG1 X9.\n", "states no unit (G20 or G21)"),
        (Dialect.SINUMERIK, "G1 X5 F100\n", "states no unit (G70 or G71)"),
        (Dialect.FANUC, "G21\nG1 X5. F100.\n", ""),
        (Dialect.LINUXCNC, "G20\nG1 X5 F10\n", ""),
        (Dialect.SINUMERIK, "G710\nG1 X5 F100\n", ""),
        (Dialect.HEIDENHAIN, "0 BEGIN PGM A MM\n1 L X+5 F100\n2 END PGM A MM\n", ""),
        (Dialect.FANUC, "O1\nM30\n", ""),
    ],
)
def test_an_assumed_unit_is_told_once(dialect: Dialect, code: str, said: str) -> None:
    found = read_program(code.encode(), dialect=dialect).findings
    told = [each for each in found if "states no unit" in each.message]
    assert len(told) == bool(said)
    assert all(said in each.message and each.line == 0 for each in told)


@pytest.mark.parametrize("word", [b"F Q1", b"FQ1", b"F AUTO", b"FAUTO"])
def test_a_feed_of_klartext_that_is_no_number_is_not_known(word: bytes) -> None:
    code = b"BEGIN PGM A MM\nL X+0 Y+0 Z+0 FMAX\nL X+1 F100\nL X+2 " + word + b"\nL X+3\n"
    program = read_program(code, dialect=Dialect.HEIDENHAIN)
    assert np.isnan(program.moves.feed[-2:]).all()
    assert not program.moves.is_advisable[-2:].any()


@pytest.mark.parametrize("control", CONTROLS)
def test_a_byte_order_mark_is_no_word(control: Dialect) -> None:
    code = b"%\nG90 G0 X0. Y0. Z5.\nG1 Z-1. F100.\nM30\n%\n"
    if control is Dialect.HEIDENHAIN:
        code = b"0 BEGIN PGM A MM\n1 L X+0 Y+0 Z+5 FMAX\n2 L Z-1 F100\n3 END PGM A MM\n"
    plain = read_program(code, dialect=control)
    marked = read_program(b"\xef\xbb\xbf" + code, dialect=control)
    assert len(plain.moves) == 2
    assert marked.moves.rows.tobytes() == plain.moves.rows.tobytes()
    assert marked.findings == plain.findings


def test_a_byte_order_mark_does_not_hide_the_control() -> None:
    assert read_program(b"\xef\xbb\xbf0 BEGIN PGM A MM\n").dialect is Dialect.HEIDENHAIN


@every_case(
    ("control", "code", "line"),
    [
        (Dialect.FANUC, b"%\nO1\nG0 X1.\nM30\n%\n%\nO2\nG20\nG0 X2.\nM30\n%\n", 9),
        (Dialect.FANUC, b"O1\nM98 P3\nM30\nO3\nG0 X1.\nM99\nO4\nG0 X2.\nM99\n", 8),
        (Dialect.HAAS, b"O00001\nM97 P9\nM30\nN9 G0 X1.\nM99\nN10 G0 X2.\nM99\n", 6),
        (Dialect.LINUXCNC, b"G0 X1\nM2\no1 sub\nG0 X2\no1 endsub\nG0 X3\n", 6),
        (Dialect.SINUMERIK, b"%_N_A_MPF\nG0 X1\nM30\n%_N_B_MPF\nG0 X2\nM30\n", 5),
        (
            Dialect.HEIDENHAIN,
            b"BEGIN PGM A MM\nL X+1 FMAX\nL M30\nLBL 1\nL X+2 FMAX\nLBL 0\nEND PGM A MM\n"
            b"BEGIN PGM B MM\nL X+3 FMAX\nEND PGM B MM\n",
            8,
        ),
    ],
)
def test_what_stands_behind_the_end_is_told(control: Dialect, code: bytes, line: int) -> None:
    program = read_program(code, dialect=control)
    found = [each.line for each in program.findings if "behind the end" in each.message]
    assert found == [line]


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        (b"G68 X0. Y0. R30.", b"G69"),
        (b"G51 X0. Y0. P2.", b"G50"),
        (b"G51.1 X0.", b"G50.1 X0."),
    ],
)
def test_the_centre_of_a_rotation_is_no_move(begin: bytes, end: bytes) -> None:
    head = b"O1\nG21 G90\nT1 M6\nS900 M3\nG0 X5. Y5. Z5.\nG1 Z-1. F100.\n"
    code = head + begin + b"\nX10. Y10.\n" + end + b"\nX1. Y1. Z1.\nM30\n"
    moves = read_program(code, dialect=Dialect.FANUC).moves
    assert moves.block.tolist() == [4, 5, 7, 9]


KLARTEXT = b"BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL X+0 Y+0 Z+5 R0 FMAX\nL X+1 F100\n"
ANEW = b"\nL X+0 Y+0 Z+5\nL X+9\n"


def test_two_unknown_shifts_are_two_frames() -> None:
    code = b"G21 G90\nG92 X0 Y0 Z0\nG0 X0 Y0 Z0\nG1 X5 F100\nG92 X0\nG0 X0 Y0 Z0\nG1 X6\n"
    moves = read_program(code, dialect=Dialect.LINUXCNC).moves
    assert len({int(frame) for frame in moves.frame[moves.kind == MoveKind.LINE]}) == 2


SIEMENS = b"G17 G90 G94 G71\nT1 D1 M6\nS900 M3\nG54 G0 X0 Y0 Z5\nG1 Z-1 F100\n"


@pytest.mark.parametrize(
    "shift",
    [
        b"$P_UIFR[1]=CTRANS(X,10)",
        b"$P_UIFR[1,X,TR]=10",
        b"$P_PFRAME=CTRANS(X,10)",
        b"G58 X10",
        b"G59 X10 Y5",
    ],
)
def test_a_frame_that_a_sinumerik_program_sets_is_another_one(shift: bytes) -> None:
    code = SIEMENS + shift + b"\nG54 G0 X0 Y0 Z5\nG1 X7 Z-1\nM30\n"
    moves = read_program(code, dialect=Dialect.SINUMERIK).moves
    first, second = (
        moves.move(int(row)) for row in np.flatnonzero(moves.kind == MoveKind.LINE)
    )
    assert moves.frames[first.setting.frame] == "G54"
    assert moves.frames[second.setting.frame] == "G54 as set in block 6"


def test_a_subprogram_of_sinumerik_that_is_not_here_is_told() -> None:
    program = read_program(SIEMENS + b"L100 P2\nX7\nM30\n", dialect=Dialect.SINUMERIK)
    (found,) = program.findings[:1]
    assert (found.line, "the subprogram L100 is not in this file" in found.message) == (6, True)
    assert not program.moves.is_known[-1]


FANUC = b"O1\nG21 G90\nT1 M6\nS900 M3\nG54 G0 X0. Y0. Z5.\nG1 Z-1. F100.\n"


def test_other_words_of_a_block_that_calls_or_returns_are_executed() -> None:
    code = FANUC + (b"G55 X50. M98 P2 L2\nX8. F70.\nM30\nO2\nG91 G1 X1.\nF60. G90 Y5. M99\n")
    moves = read_program(code, dialect=Dialect.FANUC).moves
    assert moves.block[2:].tolist() == [6, 10, 11, 10, 11, 7]
    assert {moves.frames[int(frame)] for frame in moves.frame[2:]} == {"G55"}
    assert moves.end[2:, 0].tolist() == [50.0, 51.0, 51.0, 52.0, 52.0, 8.0]
    assert np.allclose(60.0 * moves.feed[2:], [100.0, 100.0, 60.0, 60.0, 60.0, 70.0])
    assert not moves.is_splittable[2]


def test_a_call_by_block_number_comes_after_its_block() -> None:
    code = b"O00001\nG21 G90\nG0 X0. Y0. Z0.\nG1 X1. F500. M97 P9\nX3.\nM30\nN9 Y3.\nM99\n"
    moves = read_program(code, dialect=Dialect.HAAS).moves
    assert moves.block.tolist() == [2, 3, 6, 4]
    assert moves.end[:, :2].tolist() == [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [3.0, 3.0]]


@pytest.mark.parametrize("word", [b"M198 P5", b"X5. ,A45."])
def test_what_moves_in_a_way_that_is_not_understood_is_told(word: bytes) -> None:
    program = read_program(FANUC + word + b"\nX7.\nM30\n", dialect=Dialect.FANUC)
    assert program.findings[0].line == 7
    assert not program.moves.is_known[-1]


@pytest.mark.parametrize(
    ("word", "frame"),
    [
        (b"G54 P5", "G54.1 P5"),
        (b"#5221=-300.", "G54 as set in block 7"),
        (b"#7001 = #1", "G54 as set in block 7"),
        (b"#500=3.", "G54"),
        (b"IF [#5221 EQ 3] GOTO 5", "G54"),
    ],
)
def test_frames_that_a_fanuc_program_sets(word: bytes, frame: str) -> None:
    code = FANUC + word + b"\nG0 X0. Y0. Z5.\nG1 X7.\nM30\n"
    moves = read_program(code, dialect=Dialect.FANUC).moves
    assert moves.frames[moves.move(len(moves) - 1).setting.frame] == frame


def klartext(*lines: str) -> NcProgram:
    """Klartext that ends with two cuts at a place that it states anew."""
    code = KLARTEXT + "\n".join(lines).encode() + ANEW
    return read_program(code, dialect=Dialect.HEIDENHAIN)


def test_positions_of_the_machine_are_no_positions_of_the_program() -> None:
    moves = klartext("L Z-1 R0 FMAX M91", "L X+3 F100 M92").moves
    fixed = moves.part(2, 4)
    assert np.isnan([fixed.end[0, 2], fixed.end[1, 0]]).all()
    assert (fixed.flags & int(MoveFlag.MACHINE)).all()
    assert not fixed.is_advisable.any()


def test_a_retraction_leaves_an_unknown_height() -> None:
    moves = klartext("L M140 MB MAX", "L X+5").moves
    assert moves.kind[2] == MoveKind.RAPID
    assert np.isnan(moves.end[3, 2])


def test_m136_counts_feeds_by_the_revolution() -> None:
    moves = klartext("L M3 M136", "L X+5 F0.1", "L X+6 F200 M137", "L X+7 FU0.2").moves
    assert np.allclose(60.0 * moves.feed[2:5], [90.0, 200.0, 180.0])
    again = klartext("L M3", "L X+5 FU0.2", "L X+6 F200").moves
    assert np.allclose(60.0 * again.feed[2:4], [180.0, 200.0])


def test_the_factor_of_m103_is_no_feed() -> None:
    assert np.allclose(60.0 * klartext("L X+5 M103 F0.5").moves.feed[2:], 100.0)


def test_a_contour_that_is_approached_with_compensation_is_compensated() -> None:
    contour = "APPR LT X+10 Y+10 Z-1 LEN5 RL F200", "L X+20 Y+10 Z-1", "L X+30", "DEP LT LEN5"
    moves = klartext(*contour).moves
    flagged = (moves.flags & int(MoveFlag.COMPENSATED)) != 0
    assert flagged[moves.kind == MoveKind.LINE].tolist() == [False, True, True, False, False]


@pytest.mark.parametrize("words", ["L X+5 Y+5,5", "L X+5 Y+5 R+", "L X+5 Y+5 M118 X1 Y1"])
def test_a_path_with_other_words_is_not_understood(words: str) -> None:
    program = klartext(words)
    assert [each.line for each in program.findings] == [5]
    assert np.isnan(program.moves.end[2]).any()


def test_a_position_of_the_machine_by_supa_is_none_of_the_program() -> None:
    code = SIEMENS + b"G0 SUPA Z0 D0\nG0 X3 Y3\nM30\n"
    moves = read_program(code, dialect=Dialect.SINUMERIK).moves
    assert moves.flags[-2] & int(MoveFlag.MACHINE)
    assert np.isnan(moves.end[-2:, 2]).all()
    assert moves.end[-1, :2].tolist() == [3.0, 3.0]


TURNED = b"O1\nG21 G99\nT0101\nG97 S1000 M3\nG0 X50. Z2.\n"


@pytest.mark.parametrize("word", [b"R2.", b"C2.", b",R2."])
def test_a_rounding_in_the_block_of_g1_keeps_it_whole(word: bytes) -> None:
    code = TURNED + b"G1 Z-10. " + word + b" F.1\nM30\n"
    moves = read_program(code, dialect=Dialect.FANUC, machine=MachineType.LATHE).moves
    assert moves.flags[-1] & int(MoveFlag.ROUNDED)
    assert not moves.is_splittable[-1]


@pytest.mark.parametrize("code", [b"G50 S800", b"G92 S800"])
def test_a_limit_of_the_speed_is_no_speed(code: bytes) -> None:
    turned = TURNED + code + b"\nG1 Z-10. F.1\nG96 S500\nX4.\nM30\n"
    program = read_program(turned, dialect=Dialect.FANUC, machine=MachineType.LATHE)
    assert program.findings == ()
    assert np.allclose(60.0 * program.moves.spindle[-2:], [1000.0, 800.0])


@pytest.mark.parametrize(
    ("control", "code", "lines"),
    [
        (Dialect.HAAS, b"G21\nG0 X0.\nG1 X1. F100.\nX2. F200\nX3. F300\n", [4]),
        (Dialect.FANUC, b"G20\nG0 X0.\nG1 X1. F10\n", [3]),
        (Dialect.FANUC, b"G21\nG0 X0.\nG1 X1. F100\n", []),
        (Dialect.HAAS, b"G20\nG0 X0.\nG1 X1. F.5 (F10)\n", []),
    ],
)
def test_a_feed_whose_unit_depends_on_a_setting_is_told(
    control: Dialect, code: bytes, lines: list[int]
) -> None:
    found = read_program(code, dialect=control).findings
    assert [each.line for each in found if "a feed without" in each.message] == lines


def test_text_of_two_bytes_a_character_is_told() -> None:
    program = read_program("G21 G90\nG0 X1\n".encode("utf-16"))
    assert any("the file is UTF-16 text" in each.message for each in program.findings)


NGC = b"G21 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\n"


def test_m61_names_the_tool_in_the_spindle() -> None:
    moves = read_program(NGC + b"M61 Q5\nG1 X5 Z-1\n", dialect=Dialect.LINUXCNC).moves
    assert moves.tool[-2:].tolist() == [1, 5]


@pytest.mark.parametrize("code", [b"G41.1 D5", b"G42.1 D5"])
def test_compensation_by_a_diameter_in_the_block_is_compensation(code: bytes) -> None:
    ended = NGC + code + b" X5\nX10 Y0 Z-1\nG40 X20\nX30\n"
    moves = read_program(ended, dialect=Dialect.LINUXCNC).moves
    flagged = (moves.flags[-4:] & int(MoveFlag.COMPENSATED)) != 0
    assert flagged.tolist() == [True, True, True, False]


def test_a_restored_state_is_not_known() -> None:
    code = NGC + b"M70\nG91\nM72\nG1 X5 Y5 Z-1 F200\n"
    program = read_program(code, dialect=Dialect.LINUXCNC)
    assert "M72 restores a state" in program.findings[0].message
    assert not program.moves.is_known[-1]
