"""R parameters of Sinumerik are evaluated as far as the program sets them."""

from math import isnan

import numpy as np

from stepnc_model.nc.moves import MoveFlag, NcMoves
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case

HEAD = "G710 G90 G17 G54\nT1 D1\nM6\nS3000 M3\nG0 X0 Y0 Z5\n"


def moves(body: str) -> NcMoves:
    return read_program((HEAD + body).encode(), dialect=Dialect.SINUMERIK).moves


SAME = {
    "axes and feed": (
        "R1=10 R2=5\nG1 X=R1+R2 Y=-R1 Z=-R2/2 F=R1*60\n",
        "G1 X15 Y-10 Z-2.5 F600\n",
    ),
    "its own value": ("R1=10\nR1=R1+1\nG1 X=R1 F100\n", "G1 X11 F100\n"),
    "increments": ("R1=4\nG1 X=IC(R1+1) F100\nX=IC(R1)\n", "G1 X5 F100\nX9\n"),
    "arcs": ("R5=10\nG2 X=2*R5 Y0 CR=R5 F100\n", "G2 X20 Y0 CR=10 F100\n"),
    "cycles": (
        "R3=-8\nG0 X10\nCYCLE82(5,0,2,R3-2,0,0.5)\n",
        "G0 X10\nCYCLE82(5,0,2,-10,0,0.5)\n",
    ),
    "a loop by jumps": (
        "R1=0\nMARK1:\nR1=R1+2\nG1 X=R1 F100\nIF R1<6 GOTOB MARK1\nG0 Z50\n",
        "G1 X2 F100\nX4\nX6\nG0 Z50\n",
    ),
    "a jump ahead": ("R1=3\nIF R1==3 GOTOF N50\nG1 X99 F100\nN50 G1 X1 F100\n", "G1 X1 F100\n"),
    "a condition that does not hold": (
        "R1=3\nIF R1==4 GOTOF N50\nG1 X9 F100\nN50 X1\n",
        "G1 X9 F100\nX1\n",
    ),
    "repeats": (
        "R1=0\nMARK1: R1=R1+5\nG1 X=R1 F100\nREPEAT MARK1 P=2\n",
        "G1 X5 F100\nX10\nX15\n",
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
    "never set": "G1 X=R1 F100\n",
    "set in a block that may be skipped": "R1=5\n/R1=7\nG1 X=R1 F100\n",
    "set by another program": "R1=5\nSUB7\nG1 X=R1 F100\n",
    "set twice in its own block": "R1=5\nR1=6 R2=R1\nG1 X=R2 F100\n",
    "counted by a loop": "R1=5\nFOR R1=1 TO 3\nENDFOR\nG1 X=R1 F100\n",
    "set behind an unknown condition": "R1=5\nIF R9>0 GOTOF M1A\nR1=6\nM1A:\nG1 X=R1 F100\n",
    "a division by zero": "R1=0\nR2=1/R1\nG1 X=R2 F100\n",
}


@every_case("name", UNKNOWN)
def test_what_is_not_known_stays_unknown(name: str) -> None:
    assert isnan(moves(UNKNOWN[name]).end[-1, 0])


def test_blocks_with_parameters_are_not_split_and_known_feeds_are_advised() -> None:
    found = moves("R1=10 R2=100\nG1 X=R1 F200\nG1 Y5 F=R2\nX20\nX30 F50\n")
    with_end, with_feed, behind, plain = range(1, 5)
    assert found.is_advisable.tolist()[1:] == [True, True, True, True]
    assert found.flags[with_end] & MoveFlag.MACRO
    assert not found.is_splittable[with_end]
    # MACRO_FEED is for feeds that are not known.
    assert not found.flags[with_feed] & MoveFlag.MACRO_FEED
    assert not found.flags[behind] & MoveFlag.MACRO_FEED
    assert found.is_splittable[plain]


def test_without_advice_all_bytes_stay() -> None:
    code = (HEAD + "".join(body for body, _ in SAME.values())).encode()
    assert rewrite(read_program(code, dialect=Dialect.SINUMERIK), []).data == code
