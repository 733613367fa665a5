"""Damaged programs are read without loss, and rewritten without a traceback."""

import random

import numpy as np
import pytest

from stepnc_model.errors import PostError
from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.neutral_blocks import neutral_blocks
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.blocks import Cycles, MachineType
from stepnc_model.post.dialect import Dialect
from tests.stepnc_model.nc.test_program import PROGRAMS, code_of

RUNS = 42
"""of each of 12 programs: 504"""

BYTES = b"XYZFSGMTNRIJKPQHLABCODEU0123456789.-+()%;=,\"'#[]* \t<>/$\\\x00\xe9~\r\n"
EXTRA = (
    *(b"M98 P1\n", b"o1 repeat [5]\n", b"CALL LBL 1 REP 5\n", b"REPEAT LAB P=3\n", b"G91\n"),
    *(b"F0\n", b"G93\n", b"G20\n", b"G41 D1\n", b"G1 X1E5\n", b"X" + b"9" * 400 + b"\n"),
    *(b"G68 R45\n", b"#1=[2*3]\n", b"G2 X1 Y1 R0\n", b"M99\n", b"%\n", b"G96 S0\n", b"N\n"),
)


def damaged(code: bytes, chance: random.Random) -> bytes:
    """Code with one to eight faults."""
    data = bytearray(code)
    for _ in range(chance.choice((1, 2, 4, 8))):
        at = chance.randrange(len(data))
        kind = chance.randrange(4)
        if kind == 0:
            del data[at : at + chance.randrange(1, 30)]
        elif kind == 1:
            data[at:at] = bytes(chance.choice(BYTES) for _ in range(chance.randrange(1, 4)))
        elif kind == 2:
            data[at:at] = b"\n" + chance.choice(EXTRA)
        else:
            data[at] = chance.randrange(256)
    return bytes(data)


@pytest.mark.parametrize(("machine", "control", "cycles"), PROGRAMS)
def test_damaged_code_loses_no_byte_and_raises_no_surprise(
    machine: MachineType, control: Dialect, cycles: Cycles
) -> None:
    whole = code_of(machine, control, cycles).splitlines(keepends=True)
    code = b"".join(whole[:60] + whole[-20:])
    refused: list[int] = []
    for seed in range(RUNS):
        data = damaged(code, random.Random(seed))
        dialect = None if seed % 4 == 0 else control
        try:
            program = read_program(data, dialect=dialect)
        except PostError as error:
            refused.append(error.line)
            continue
        assert rewrite(program, ()).data == data
        moves = program.moves
        advice = [
            BlockAdvice(block=int(block), ends=(0.3, 1.0), feeds=(3.0, 4.0))
            for block in np.unique(moves.block)[:40]
        ]
        result = rewrite(program, advice, mark=True)
        assert len(read_program(result.data, dialect=program.dialect).moves) >= 0
        assert sum(1 for _ in neutral_blocks(program)) > 1
    assert all(line > 0 for line in refused)
