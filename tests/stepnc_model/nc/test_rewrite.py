"""Only feeds change, blocks are divided where they may, and programmed feeds come back."""

from math import hypot

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from stepnc_model.nc.advice import BlockAdvice, RewrittenCode
from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case


def rewritten(
    code: bytes,
    control: Dialect,
    *advice: tuple[int, tuple[float, ...], tuple[float, ...]],
    machine: MachineType = MachineType.MILL,
    mark: bool = False,
) -> RewrittenCode:
    """Advice by block, with feeds in mm/min."""
    program = read_program(code, dialect=control, machine=machine)
    given = [
        BlockAdvice(block=b, ends=e, feeds=tuple(f / 60.0 for f in feeds), reason="power")
        for b, e, feeds in advice
    ]
    return rewrite(program, given, mark=mark)


ISO = b"G21 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\n"


@every_case(
    ("control", "code", "advice", "wanted"),
    [
        (
            Dialect.LINUXCNC,
            ISO + b"N7 X10 F200 M8 (cut) ; now\r\nX20\n",
            (5, (0.25, 1.0), (300.0, 400.0)),
            ISO + b"N7 X2.5 F300 M8 (cut) ; now\r\nX10 F400\r\nX20 F200\n",
        ),
        (
            Dialect.LINUXCNC,
            ISO + b"G2 X10 Y10 I10 J0 M0\n",
            (5, (0.5, 1.0), (50.0, 100.0)),
            ISO + b"G2 X2.9289 Y7.0711 I10 J0 F50\nG2 X10 Y10 I7.0711 J-7.0711 F100 M0\n",
        ),
        (
            Dialect.FANUC,
            b"O1\n" + ISO + b"/N3G91G1X10.Y-5.F200.M9\n",
            (6, (0.333, 1.0), (150.0, 250.0)),
            b"O1\n" + ISO + b"/N3G91G1X3.33Y-1.665F150.\n/ G1 X6.67 Y-3.335 F250. M9\n",
        ),
        (
            Dialect.HAAS,
            b"O00001\n" + ISO + b"G3 X5. Y5. R-5. F90.\n",
            (6, (0.25, 1.0), (60.0, 70.0)),
            b"O00001\n" + ISO + b"G3 X3.087 Y-4.619 R5. F60.\nG3 X5. Y5. R-5. F70.\n",
        ),
        (
            Dialect.SINUMERIK,
            b"G710 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG2 X10 Y10 CR=10 M5\n",
            (5, (0.5, 1.0), (80.0, 100.0)),
            b"G710 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\n"
            b"G2 X2.929 Y7.071 CR=10 F80\nG2 X10 Y10 CR=10 F100 M5\n",
        ),
        (
            Dialect.HEIDENHAIN,
            b"0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S900\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n"
            b"3 L X+10 R0 F500\n4 CC X+10 Y+10\n5 C X+20 Y+10 DR+ M9\n6 L IY+5\n"
            b"7 END PGM A MM\n",
            (5, (0.5, 1.0), (200.0, 300.0)),
            b"0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S900\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n"
            b"3 L X+10 R0 F500\n4 CC X+10 Y+10\n5 C X+17.071 Y+2.929 DR+ F200\n"
            b"C X+20 Y+10 DR+ F300 M9\n6 L IY+5 F500\n7 END PGM A MM\n",
        ),
    ],
)
def test_a_block_is_divided_in_the_manner_of_its_control(
    control: Dialect,
    code: bytes,
    advice: tuple[int, tuple[float, ...], tuple[float, ...]],
    wanted: bytes,
) -> None:
    assert rewritten(code, control, advice).data == wanted


def test_a_full_circle_gets_the_ends_that_its_pieces_need() -> None:
    result = rewritten(ISO + b"G2 I10\n", Dialect.LINUXCNC, (5, (0.5, 1.0), (50.0, 70.0)))
    assert result.data == ISO + b"G2 X20 Y0 I10 J0 F50\nG2 X0 Y0 I-10 J0 F70\n"


@pytest.mark.parametrize(
    ("control", "word", "first", "second"),
    [(Dialect.LINUXCNC, "P3", "P1", "P3"), (Dialect.SINUMERIK, "TURN=2", "TURN=0", "TURN=2")],
)
def test_the_pieces_of_a_helix_count_their_own_turns(
    control: Dialect, word: str, first: str, second: str
) -> None:
    head = b"G710 G90 G17\nT1 M6\nS900 M3\nG0 X0 Y0 Z0\n"
    if control is Dialect.LINUXCNC:
        head = head.replace(b"G710", b"G21")
    code = head + f"G2 X0 Y0 Z-3 I10 J0 {word} F100\n".encode()
    result = rewritten(code, control, (4, (0.25, 1.0), (50.0, 70.0)))
    assert result.data == head + (
        f"G2 X10 Y-10 Z-0.75 I10 J0 {first} F50\nG2 X0 Y0 Z-3 I0 J10 {second} F70\n".encode()
    )


def test_inverse_time_counts_the_time_of_each_piece() -> None:
    code = b"G21 G90\nG0 X0 Y0 Z0\nG93 G1 X30 F2\n"
    result = rewritten(code, Dialect.LINUXCNC, (2, (0.5, 1.0), (30.0, 60.0)))
    assert result.data == b"G21 G90\nG0 X0 Y0 Z0\nG93 G1 X15 F2\nG1 X30 F4\n"


def test_a_feed_per_revolution_and_a_diameter_stay_in_their_units() -> None:
    code = b"O1\nG97 S600 M3\nT0101\nG0 X20. Z0.\nG99 G1 X40. Z-10. F0.3\nZ-20.\n"
    result = rewritten(
        code,
        Dialect.FANUC,
        (4, (0.5, 1.0), (120.0, 60.0)),
        machine=MachineType.LATHE,
    )
    assert result.data == (
        b"O1\nG97 S600 M3\nT0101\nG0 X20. Z0.\nG99 G1 X30. Z-5. F0.2\n"
        b"G1 X40. Z-10. F0.1\nZ-20. F0.3\n"
    )


def test_feeds_in_inches_are_rounded_down() -> None:
    code = b"G20 G90\nG0 X0 Y0 Z0\nG1 X1.5 F10.5\n"
    result = rewritten(code, Dialect.LINUXCNC, (2, (1.0,), (25.4 * 8.29,)))
    assert result.data == b"G20 G90\nG0 X0 Y0 Z0\nG1 X1.5 F8.29\n"
    slower = rewritten(code, Dialect.LINUXCNC, (2, (1.0,), (25.4 * 8.2899,)))
    assert slower.data == b"G20 G90\nG0 X0 Y0 Z0\nG1 X1.5 F8.28\n"


@every_case("feed", [0.0567, 0.2677, 1.987, 19.87, 198.76, 1987.6])
def test_rounding_of_a_feed_takes_at_most_one_per_cent(feed: float) -> None:
    code = b"G20 G90\nG0 X0 Y0 Z0\nG1 X1.5 F10.5\n"
    result = rewritten(code, Dialect.LINUXCNC, (2, (1.0,), (25.4 * feed,)))
    assert 0.99 * feed < float(result.data.split(b"F")[1]) <= feed


@every_case(
    ("code", "block", "reason"),
    [
        (b"G41 D1\nG1 X5 F9\n", 6, "cutter radius compensation"),
        (b"G1 X5 F9\nG81 X1 Y1 Z-3 R1 F50\n", 6, "a canned cycle"),
        (b"G1 X5 F9\nG91 G1 X5 Y#1 Z3\n", 6, "the block is not understood"),
        (b"G1 X5 F9 M66 P1\n", 5, "words that act once"),
        (b"G1 X0.0003 F9\n", 5, "too short"),
        (b"G1 X5 A3 F9\n", 5, "another axis"),
    ],
)
def test_what_may_not_be_divided_stays_whole(code: bytes, block: int, reason: str) -> None:
    result = rewritten(ISO + code, Dialect.LINUXCNC, (block, (0.5, 1.0), (20.0, 30.0)))
    assert result.added == 0
    assert [each.block for each in result.unchanged] == [block]
    expected = reason if reason != "the block is not understood" else ""
    assert expected in result.unchanged[0].reason


def test_a_feed_from_a_variable_refuses_the_advice_before_it() -> None:
    code = ISO + b"F#1\nG1 X5\nX6\n"
    result = rewritten(code, Dialect.LINUXCNC, (6, (1.0,), (20.0,)))
    assert result.data == code
    assert result.unchanged[0].reason == "a feed from a variable that is not known"


@every_case(
    ("code", "block", "wanted"),
    [
        ("{}G1 X5. F#9\nX9. F50.\n", 6, "{}G1 X5. F80.\nX9. F50.\n"),
        ("{}G1 X5. F[#9*2] M8\nX9. F50.\n", 6, "{}G1 X5. F80. M8\nX9. F50.\n"),
        # Where it is in force a word at the move suffices; the word that sets it stays.
        ("{}G1 X5. F#9\nX9.\nX12. F50.\n", 7, "{}G1 X5. F#9\nX9. F80.\nX12. F50.\n"),
        # What follows without advice would need the value of the variable again.
        ("{}G1 X5. F#9\nX9.\n", 6, "{}G1 X5. F#9\nX9.\n"),
    ],
)
def test_a_known_feed_from_a_variable_gives_way_to_a_word(
    code: str, block: int, wanted: str
) -> None:
    head = ISO.decode().replace("F100", "F100.") + "#9=60.\n"
    result = rewritten(code.format(head).encode(), Dialect.FANUC, (block, (1.0,), (80.0,)))
    assert result.data.decode() == wanted.format(head)


KLARTEXT = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S900\n2 M3\nQ1 = 60\nL X+0 Y+0 Z-1 F100\n"
ISO_HEAD = "G21 G90\nT1 M6\nS900 M3\n{}\nG0 X0 Y0 Z-1\n"


@every_case(
    ("control", "code", "word"),
    [
        (Dialect.LINUXCNC, ISO_HEAD.format("#<cut>=60") + "G1 X5 {}\nX9 F50\n", "F#<cut>"),
        (Dialect.SINUMERIK, ISO_HEAD.format("R1=60") + "G1 X5 {}\nX9 F50\n", "F=R1"),
        (Dialect.HEIDENHAIN, KLARTEXT + "L X+5 {}\nL X+9 F50\n", "FQ1"),
    ],
)
def test_feeds_of_variables_by_control(control: Dialect, code: str, word: str) -> None:
    result = rewritten(code.format(word).encode(), control, (5, (1.0,), (80.0,)))
    again = read_program(result.data, dialect=control).moves
    assert result.changed == 1
    assert word.encode() not in result.data
    assert again.word[-2:] * 60.0 == pytest.approx([80.0, 50.0])


def test_calls_with_different_feeds_get_the_least_advice() -> None:
    code = b"O1\n" + ISO + b"G65 P2 F60.\nG65 P2 F90.\nG1 X9. F50.\nM30\nO2\n"
    code += b"G1 X5. F#9\nG0 X0\nM99\n"
    block = code.split(b"\n").index(b"G1 X5. F#9")
    advice = ((block, (1.0,), (120.0,)), (block, (1.0,), (100.0,)))
    result = rewritten(code, Dialect.FANUC, *advice)
    assert result.data == code.replace(b"F#9", b"F100.")


@pytest.mark.parametrize(
    ("skipped", "wanted"),
    [
        (b"/N3 X30.\nX40.\n", b"F100.\n/N3 X30.\nX40.\n"),
        (b"/2 N3 X30. F70.\nX40.\n", b"F100.\n/2 N3 X30. F70.\nX40.\n"),
        (b"/F70.\nX40.\n", b"F100.\n/F70.\nX40.\n"),
        (b"X30.\n/X40.\nX50.\n", b"X30. F100.\n/X40.\nX50.\n"),
    ],
)
def test_the_programmed_feed_is_back_before_what_the_operator_may_skip(
    skipped: bytes, wanted: bytes
) -> None:
    code = b"O1\n" + ISO.replace(b"F100", b"F100.") + b"X10."
    result = rewritten(code + b"\n" + skipped, Dialect.FANUC, (6, (1.0,), (300.0,)))
    assert result.data == code + b" F300.\n" + wanted


def test_an_advised_feed_is_written_where_the_one_before_it_may_be_skipped() -> None:
    code = b"O1\n" + ISO + b"/X10. F70.\nX20.\n"
    result = rewritten(code, Dialect.FANUC, (7, (1.0,), (70.0,)))
    assert result.data == b"O1\n" + ISO + b"/X10. F70.\nX20. F70.\n"


@pytest.mark.parametrize("control", [Dialect.FANUC, Dialect.HAAS])
def test_a_whole_feed_has_a_point_where_others_have_one(control: Dialect) -> None:
    code = b"G20 G90\nT1 M6\nS900 M3\nG0 X0. Y0. Z1.\nG1 Z-.1 F6.16\nX1. F12.5\n"
    result = rewritten(code, control, (5, (1.0,), (25.4 * 20.0,)))
    assert result.data == code.replace(b"F12.5", b"F20.")


def test_a_subprogram_called_with_two_feeds_refuses_the_advice_before_it() -> None:
    code = (
        b"O1\n" + ISO + b"G1 X5. F50.\nX6.\nM98 P2\nG1 X7. F80.\nX8.\nM98 P2\nM30\n"
        b"O2\nG91 G1 Y1.\nG90\nM99\n"
    )
    result = rewritten(code, Dialect.FANUC, (7, (1.0,), (20.0,)), (10, (1.0,), (30.0,)))
    reasons = {each.block: each.reason for each in result.unchanged}
    assert reasons == {10: "a later block is called with different feeds"}


def test_a_relative_block_is_divided_for_all_of_its_calls() -> None:
    code = b"O1\n" + ISO + b"M98 P2 L2\nG90 X0. F70.\nM30\nO2\nG91 G1 X10. F90.\nM99\n"
    result = rewritten(code, Dialect.FANUC, (10, (0.3, 1.0), (50.0, 60.0)))
    assert result.data == code.replace(b"G91 G1 X10. F90.\n", b"G91 G1 X3. F50.\nG1 X7. F60.\n")


def test_several_pieces_of_advice_on_one_block_give_the_least() -> None:
    code = ISO + b"G1 X10\n"
    result = rewritten(
        code,
        Dialect.LINUXCNC,
        (5, (0.5, 1.0), (50.0, 70.0)),
        (5, (0.3, 1.0), (60.0, 40.0)),
    )
    assert result.data == ISO + b"G1 X3 F50\nG1 X10 F40\n"


def test_a_mark_is_written_once_in_the_manner_of_the_control() -> None:
    code = ISO + b"G1 X10 ; a\nX20\n"
    once = rewritten(code, Dialect.LINUXCNC, (5, (1.0,), (50.0,)), mark=True)
    assert b"G1 X10 F50 (power) ; a\n" in once.data
    klartext = b"BEGIN PGM A MM\nL X+0 Y+0 Z+0 FMAX\nL X+10 F99\nL X+20\nEND PGM A MM\n"
    other = rewritten(klartext, Dialect.HEIDENHAIN, (2, (1.0,), (50.0,)), mark=True)
    assert b"L X+10 F50 ; power\nL X+20 F99\n" in other.data


def test_no_advice_changes_no_byte() -> None:
    code = b"%\r\n\xff(\xe4)\x00\tG1X1F2\r\rN;\n%"
    for control in Dialect:
        if control is not Dialect.CANONICAL:
            assert rewritten(code, control).data == code


@st.composite
def programs(draw: st.DrawFn) -> tuple[bytes, Dialect]:
    """Lines and arcs with and without feeds, absolute and relative."""
    control = draw(st.sampled_from([Dialect.LINUXCNC, Dialect.FANUC, Dialect.HAAS]))
    lines = ["G21 G90 G17", "T1 M6", "S900 M3", "G0 X0. Y0. Z0.", "F100."]
    numbers = st.integers(-20_000, 20_000).map(lambda n: f"{n / 1000:.3f}")
    for _ in range(draw(st.integers(1, 12))):
        kind = draw(st.sampled_from(["line", "line", "arc", "rapid", "F", "G91"]))
        feed = draw(st.sampled_from(["", " F80.", " F333.5"]))
        if kind == "line":
            lines.append(f"G1 X{draw(numbers)} Y{draw(numbers)} Z{draw(numbers)}{feed}")
        elif kind == "arc":
            sense = draw(st.sampled_from(["G2", "G3"]))
            lines.append(f"{sense} I{draw(numbers)} J{draw(numbers)} Z{draw(numbers)}{feed}")
        elif kind == "rapid":
            lines.append(f"G0 X{draw(numbers)}{feed}")
        elif kind == "F":
            lines.append("F222.")
        else:
            lines.append(draw(st.sampled_from(["G91", "G90"])))
    return "\n".join(lines).encode() + b"\n", control


def advice_for(program: NcProgram, chance: np.random.Generator) -> list[BlockAdvice]:
    moves = program.moves
    advice = []
    for block in np.unique(moves.block[moves.is_advisable]):
        if chance.random() < 0.6:
            cuts = np.unique(np.round(chance.uniform(0.02, 0.98, chance.integers(0, 4)), 3))
            ends = (*cuts.tolist(), 1.0)
            feeds = tuple(chance.uniform(0.5, 30.0, len(ends)).tolist())
            advice.append(BlockAdvice(block=int(block), ends=ends, feeds=feeds))
    return advice


@settings(max_examples=100, deadline=None)
@given(programs(), st.integers(0, 10_000))
def test_moves_keep_their_ends_and_no_feed_exceeds_its_advice(
    drawn: tuple[bytes, Dialect], seed: int
) -> None:
    code, control = drawn
    program = read_program(code, dialect=control, machine=MachineType.MILL)
    # An arc without a radius is no arc: what follows has no known start.
    assume(not any("not understood" in each.message for each in program.findings))
    advice = advice_for(program, np.random.default_rng(seed))
    result = rewrite(program, advice)
    again = read_program(result.data, dialect=control, machine=MachineType.MILL)
    wanted = {each.block: each for each in advice}
    place, before, after = 0, program.moves, again.moves
    lengths, pieces = np.nan_to_num(before.length), np.nan_to_num(after.length)
    for row in range(len(before)):
        given = wanted.get(int(before.block[row]))
        done = 0.0
        while True:
            feed = after.feed[place]
            if given is None or before.kind[row] == MoveKind.RAPID:
                assert feed == before.feed[row] or (
                    np.isnan(feed) == np.isnan(before.feed[row])
                )
            else:
                middle = min(1.0, (done + 0.5 * pieces[place]) / max(lengths[row], 1e-9))
                allowed = next(
                    f for e, f in zip(given.ends, given.feeds, strict=True) if middle <= e
                )
                assert feed <= allowed * (1.0 + 1e-6)
            done += pieces[place]
            place += 1
            is_there = bool((np.abs(after.end[place - 1] - before.end[row]) < 1e-9).all())
            if is_there and done >= 0.5 * lengths[row]:
                break
        assert abs(done - lengths[row]) < 2e-2 + 1e-3 * lengths[row]
    assert place == len(after)


@settings(max_examples=50, deadline=None)
@given(programs(), st.integers(0, 10_000))
def test_the_same_feeds_again_change_nothing(drawn: tuple[bytes, Dialect], seed: int) -> None:
    code, control = drawn
    program = read_program(code, dialect=control, machine=MachineType.MILL)
    once = rewrite(program, advice_for(program, np.random.default_rng(seed)))
    again = read_program(once.data, dialect=control, machine=MachineType.MILL)
    same = [
        BlockAdvice(block=int(again.moves.block[row]), ends=(1.0,), feeds=(feed,))
        for row, feed in enumerate(again.moves.feed.tolist())
        if again.moves.is_advisable[row]
    ]
    assert rewrite(again, same).data == once.data


def test_a_helix_rises_with_its_turn() -> None:
    result = rewritten(
        ISO + b"G3 X10 Y10 Z3 I0 J10\n", Dialect.LINUXCNC, (5, (0.5, 1.0), (50.0, 70.0))
    )
    again = read_program(result.data, dialect=Dialect.LINUXCNC)
    x, y, z = again.moves.end[-2]
    assert hypot(x, y - 10.0) == pytest.approx(10.0, abs=1e-4)
    assert z == pytest.approx(1.0)
