"""Q parameters of Klartext are evaluated as far as the program sets them."""

from math import isnan

import numpy as np

from stepnc_model.nc.moves import MoveFlag, NcMoves
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case

HEAD = "BEGIN PGM A MM\nTOOL CALL 1 Z S3000\nL X+0 Y+0 Z+5 R0 FMAX M3\n"
END = "END PGM A MM\n"


def moves(body: str) -> NcMoves:
    code = HEAD + body + END
    return read_program(code.encode(), dialect=Dialect.HEIDENHAIN).moves


SAME = {
    "axes and feed": (
        "Q1 = 10\nFN 0: Q2 = +5\nL X+Q1 Y-Q2 R0 FQ3\nQ3=600\nL X+Q2 FQ3\n",
        "L X+10 Y-5 R0 FQ9\nL X+5 F600\n",
    ),
    "formulas": (
        "Q1 = 10\nQ2 = ( Q1 + 2 ) * SIN 30\nFN 4: Q3 = +Q1 DIV +4\nL X+Q2 Y-Q3 F100\n",
        "L X+6 Y-2.5 F100\n",
    ),
    "increments": ("Q1 = 3\nQ1 = Q1 + 1\nL IX+Q1 F100\nL IX-Q1\n", "L X+4 F100\nL X+0\n"),
    "arcs": (
        "Q5 = 10\nCC X+Q5 Y+0\nC X+20 Y+0 DR+ F100\n",
        "CC X+10 Y+0\nC X+20 Y+0 DR+ F100\n",
    ),
    "cycles": (
        "Q5 = 10\nCYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-Q5 ~\n Q206=+150 ~\n Q202=10 ~\n"
        " Q203=+0 ~\n Q204=50\nL X+20 Y+20 FMAX M99\n",
        "CYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-10 ~\n Q206=+150 ~\n Q202=10 ~\n"
        " Q203=+0 ~\n Q204=50\nL X+20 Y+20 FMAX M99\n",
    ),
    "a loop by jumps": (
        "Q1 = 0\nLBL 1\nQ1 = Q1 + 2\nL X+Q1 F100\nFN 12: IF +Q1 LT +6 GOTO LBL 1\n"
        "L Z+50 FMAX\n",
        "L X+2 F100\nL X+4\nL X+6\nL Z+50 FMAX\n",
    ),
    "a condition that does not hold": (
        "Q1 = 3\nFN 9: IF +Q1 EQU +4 GOTO LBL 5\nL X+9 F100\nLBL 5\nL X+1\n",
        "L X+9 F100\nL X+1\n",
    ),
    "a label called again and again": (
        "Q1 = 0\nLBL 1\nQ1 = Q1 + 5\nL X+Q1 F100\nCALL LBL 1 REP2\n",
        "L X+5 F100\nL X+10\nL X+15\n",
    ),
}


@every_case("name", SAME)
def test_a_program_with_parameters_moves_as_one_with_numbers(name: str) -> None:
    one, other = map(moves, SAME[name])
    assert len(one) == len(other)
    assert np.allclose(one.end, other.end, equal_nan=True)
    assert np.allclose(one.turn, other.turn)
    assert np.allclose(one.feed, other.feed, equal_nan=True)


UNKNOWN = {
    "never set": "L X+Q1 F100\n",
    "set in a block that may be skipped": "Q1 = 5\n/Q1 = 7\nL X+Q1 F100\n",
    "set by another program": "Q1 = 5\nCALL PGM B\nL X+Q1 F100\n",
    "set behind an unknown condition": (
        "Q1 = 5\nFN 9: IF +Q9 EQU +4 GOTO LBL 5\nQ1 = 6\nLBL 5\nL X+Q1 F100\n"
    ),
    "read from the control": "FN 18: SYSREAD Q1 = ID20 NR1\nL X+Q1 F100\n",
    "of the control": "Q108 = 5\nL X+Q108 F100\n",
    "a division by zero": "Q1 = 0\nQ2 = 1 / Q1\nL X+Q2 F100\n",
}


@every_case("name", UNKNOWN)
def test_what_is_not_known_stays_unknown(name: str) -> None:
    assert isnan(moves(UNKNOWN[name]).end[-1, 0])


def test_blocks_with_parameters_are_not_split() -> None:
    found = moves("Q1 = 10\nQ2 = 100\nL X+Q1 F200\nL Y+5 FQ2\nL X+20\nL X+30 F50\n")
    with_end, with_feed, behind, plain = range(1, 5)
    assert found.is_advisable.tolist()[1:] == [True, True, True, True]
    assert found.flags[with_end] & MoveFlag.MACRO
    assert not found.is_splittable[with_end]
    assert found.flags[with_feed] & MoveFlag.MACRO
    assert not found.is_splittable[with_feed]
    assert (found.word[[with_feed, behind]] * 60.0).round(9).tolist() == [100.0, 100.0]
    assert found.is_splittable[plain]


def test_a_feed_of_an_unknown_parameter_stays() -> None:
    found = moves("L X+10 F200\nL Y+5 FQ2\nL X+20\nL X+30 F50\n")
    assert found.is_advisable.tolist()[1:] == [True, False, False, True]
    assert found.flags[2] & MoveFlag.MACRO_FEED
    assert found.flags[3] & MoveFlag.MACRO_FEED


def test_without_advice_all_bytes_stay() -> None:
    code = (HEAD + "".join(body for body, _ in SAME.values()) + END).encode()
    assert rewrite(read_program(code, dialect=Dialect.HEIDENHAIN), []).data == code
