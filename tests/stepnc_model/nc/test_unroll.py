"""Programs without calls and repeats make the same moves."""

from pathlib import Path

import numpy as np
import pytest

from stepnc_model.errors import PostError
from stepnc_model.nc.program import read_program
from stepnc_model.nc.unroll import unrolled
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from tests.service.verbs.optimise.test_code import PROGRAMS
from tests.stepnc_model.nc.conftest import Oracle

FANUC = (
    "%\nO0001 (PART)\nG21 G90 G17 G54\nT1 M6\nS3000 M3\nG0 X0. Y0. Z5.\nN50 M98 P2 L2\n"
    "N60 G90 G0 Z20.\nM30\nO0002 (PASS)\nN10 G91 G1 X10. F100. (along)\nN20 Y5.\nM99\n%\n"
)
HAAS = FANUC.replace("M98 P2 L2", "M97 P10 L2").replace("O0002 (PASS)\n", "")
LINUXCNC = (
    "G21 G90 G17 G54\nT1 M6\nS3000 M3\no100 sub\nG91 G1 X10 F100\nG90\no100 endsub\n"
    "G0 X0 Y0 Z0\no100 call\n#1=0\no200 while [#1 lt 3]\nG1 Y[#1*5] F200\n#1=[#1+1]\n"
    "o200 endwhile\no100 call\nM2\n"
)
SINUMERIK = (
    "N10 G71 G90 G17 G54\nN20 T1 D1\nN30 M6\nN40 S3000 M3\nN50 G0 X0 Y0 Z0\n"
    "MARK1: G91 G1 X10 F60\nG90\nREPEAT MARK1 P=2\nN100 G0 Z50\nM30\n"
)
KLARTEXT = (
    "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000 F500\n2 L X+0 Y+0 Z+5 R0 FMAX M3\n3 L Z-1 F100\n"
    "4 LBL 1\n5 L IX+10 F200\n6 CALL LBL 1 REP2\n7 CALL LBL 2\n8 L Z+50 FMAX M30\n"
    "9 LBL 2\n10 L IY+5\n11 LBL 0\n12 END PGM A MM\n"
)
CASES = {
    "fanuc": (FANUC, Dialect.FANUC, 4),
    "haas": (HAAS, Dialect.HAAS, 4),
    "linuxcnc": (LINUXCNC, Dialect.LINUXCNC, 5),
    "sinumerik": (SINUMERIK, Dialect.SINUMERIK, 3),
    "heidenhain": (KLARTEXT, Dialect.HEIDENHAIN, 5),
}
STEERS = ("M98", "M97", "M99", "o100", "o200", "REPEAT", "MARK1", "LBL", "O0002")


@pytest.mark.parametrize("name", CASES)
def test_calls_and_repeats_are_written_out(name: str) -> None:
    text, dialect, feeds = CASES[name]
    program = read_program(text.encode(), dialect=dialect, machine=MachineType.MILL)
    found = unrolled(program)
    words = found.program.text.data.decode()
    assert not [each for each in STEERS if each in words]
    assert np.array_equal(found.program.moves.end, program.moves.end, equal_nan=True)
    fed = found.program.moves.feed > 0.0
    assert fed.sum() == feeds
    blocks = found.program.moves.block[fed]
    assert len(np.unique(blocks)) == feeds
    assert found.program.moves.is_advisable[fed].all()
    ends = [each.splitlines()[-1].lstrip("0123456789 ") for each in (words, text)]
    assert ends[0] == ends[1]
    again = unrolled(found.program)
    assert again.program.text.data == found.program.text.data


def test_numbers_of_blocks_are_there_once() -> None:
    program = read_program(FANUC.encode(), dialect=Dialect.FANUC)
    words = unrolled(program).program.text.data.decode()
    assert words.count("N10 ") == 1
    assert words.count("G91 G1 X10. F100. (along)") == 2
    program = read_program(KLARTEXT.encode(), dialect=Dialect.HEIDENHAIN)
    lines = unrolled(program).program.text.data.decode().splitlines()
    assert [int(line.split()[0]) for line in lines] == list(range(len(lines)))


def test_variables_of_a_subprogram_are_refused() -> None:
    text = (
        "G21 G90\nT1 M6\nS3000 M3\no100 sub\nG1 X#1 F100\no100 endsub\nG0 X0 Y0 Z0\n"
        "o100 call [5]\no100 call [10]\nM2\n"
    )
    program = read_program(text.encode(), dialect=Dialect.LINUXCNC)
    with pytest.raises(PostError, match=r"cannot be unrolled: .* variables of its own"):
        unrolled(program)


@pytest.mark.parametrize("name", PROGRAMS)
def test_samples_make_the_same_moves(name: str) -> None:
    text, request = PROGRAMS[name]
    program = read_program(text.encode("latin-1"), dialect=request.dialect)
    found = unrolled(program)
    assert np.array_equal(found.program.moves.end, program.moves.end, equal_nan=True)
    if name not in {"subprograms", "sinumerik"}:
        assert found.program.text.data == program.text.data


def straight(data: bytes) -> bytes:
    program = read_program(data, dialect=Dialect.LINUXCNC)
    return unrolled(program).program.text.data


@pytest.mark.parametrize("name", ["", "cds.ngc", "skeleton.ngc"])
def test_linuxcnc_executes_the_unrolled_program_the_same(
    name: str, samples: Path, linuxcnc: Oracle
) -> None:
    data = (samples / name).read_bytes() if name else LINUXCNC.encode()
    assert linuxcnc(straight(data)) == linuxcnc(data)
