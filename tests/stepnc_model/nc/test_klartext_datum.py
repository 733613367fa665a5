"""Datum of Klartext: what stands at another place is another frame, or keeps its feeds."""

import pytest

from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

KLARTEXT = b"BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL X+0 Y+0 Z+5 R0 FMAX\nL X+1 F100\n"
ANEW = b"\nL X+0 Y+0 Z+5\nL X+9\n"


@pytest.mark.parametrize(
    ("on", "off"),
    [
        (b"CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30", b"CYCL DEF 10.1 ROT+0"),
        (b"CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 IROT-5", b"CYCL DEF 10.1 ROT+0"),
        (b"CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+Q5", b"CYCL DEF 10.1 ROT+0"),
        (b"CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.995", b"CYCL DEF 11.1 SCL 1"),
        (b"TRANS ROTATION ROT30", b"TRANS ROTATION RESET"),
    ],
)
def test_rotated_and_scaled_klartext_keeps_its_feeds(on: bytes, off: bytes) -> None:
    program = read_program(KLARTEXT + on + ANEW + off + ANEW, dialect=Dialect.HEIDENHAIN)
    cuts = program.moves.is_advisable[program.moves.kind == MoveKind.LINE]
    assert cuts.tolist() == [True, False, False, False, True]


@pytest.mark.parametrize(
    ("shift", "frame"),
    [
        (b"CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10", "preset shifted by X 10"),
        (b"TRANS DATUM AXIS X+10", "preset shifted by X 10"),
        (b"CYCL DEF 247 DATUM SETTING ~\nQ339=+3 ;DATUM NUMBER", "preset 3"),
        (
            b"CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 #5",
            "preset shifted by X by an unknown distance, Y by an unknown distance, "
            "Z by an unknown distance in block 6",
        ),
    ],
)
def test_another_datum_of_klartext_is_another_frame(shift: bytes, frame: str) -> None:
    moves = read_program(KLARTEXT + shift + ANEW, dialect=Dialect.HEIDENHAIN).moves
    assert moves.frames[moves.move(len(moves) - 1).setting.frame] == frame


@pytest.mark.parametrize(
    ("words", "frame"),
    [
        ("PRESET SELECT #3", "preset 3"),
        ("TCH PROBE 410 DATUM INSIDE RECTAN.", "preset shifted"),
    ],
)
def test_a_datum_that_is_set_on_the_way_is_another_frame(words: str, frame: str) -> None:
    moves = read_program(KLARTEXT + words.encode() + ANEW, dialect=Dialect.HEIDENHAIN).moves
    assert moves.frames[moves.move(len(moves) - 1).setting.frame].startswith(frame)
