"""Variables, expressions, conditions and loops: what follows from the program's own numbers."""

from collections.abc import Sequence
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from stepnc_model.nc import flow
from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case
from tests.stepnc_model.nc.conftest import Oracle

SAMPLES = ["3D_Chips.ngc", "daisy.ngc", "factorial.ngc", "flowsnake.ngc"]
"""samples of variables, nested and recursive subprograms, conditions and loops"""

MACROS = (
    "G21 G90 G17\nT1 M6\nF100\n#1=10 #2=[#1*2+5]\n#<depth>=-1.5\n"
    "o100 sub\n#4=0\no110 while [#4 LT #2]\nG0 X[#1+#4*10] Y#3\nG1 Z#<_d>\n"
    "X[#1+#4*10+5*cos[60]] F[#1*30]\nG0 Z5\n#4=[#4+1]\n"
    "o111 if [#4 EQ 2]\no110 continue\no111 elseif [#4 GE 4]\nX[#3-1]\no111 else\nY[#3+1]\n"
    "o111 endif\no110 endwhile\no100 endsub\n"
    "#<_d>=#<depth>\nG0 X0 Y0 Z5\no100 call [1] [6] [#1/2]\n"
    "o120 do\nG1 X#1 Y[-#1]\n#1=[#1-2]\no120 while [#1 GT 3]\n"
    "o130 repeat [#1]\nG91 G0 X1\nG90\no130 endrepeat\n"
    "G1 X[atan[1]/[1]] Y[sqrt[16]**2 MOD 7] Z[round[2.5]-fix[-1.2]]\n"
    "G1 X[fup[-1.2]] Y[abs[-3]*ln[exp[2]]] Z[asin[0.5]-acos[0.5]]\n"
    "G1 X[[1 EQ 1] + [2 NE 2]] Y[[1 GT 2] OR [3 LE 3]] Z[[1 AND 0] XOR 1]\n"
    "o200 sub\no201 if [#1 LE 0]\no200 return [1]\no201 else\no200 call [#1-1]\n"
    "o200 return [#<_value>*#1+#1]\no201 endif\no200 endsub\n"
    "o200 call [4]\nG1 X#<_value>\n##2=7\nG1 Y#25\nM2\n"
)


def read(text: str, dialect: Dialect = Dialect.LINUXCNC) -> NcProgram:
    return read_program(text.encode("latin-1"), dialect=dialect)


def require_same(moves: NcMoves, truth: Sequence[tuple[float, ...]], *, digit: float) -> None:
    """Require the ends of LinuxCNC's moves."""
    rows = np.flatnonzero(moves.kind <= MoveKind.ARC)
    assert len(rows) == len(truth)
    for row, wanted in zip(rows.tolist(), truth, strict=True):
        for value, true in zip(moves.end[row], wanted, strict=True):
            assert isnan(value) or value == pytest.approx(true, abs=digit)


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_evaluated_as_by_linuxcnc(
    name: str, samples: Path, linuxcnc: Oracle
) -> None:
    data = (samples / name).read_bytes()
    moves = read_program(data, dialect=Dialect.LINUXCNC).moves
    require_same(moves, [each.end for each in linuxcnc(data)], digit=2.6e-3)
    assert not (moves.flags & int(MoveFlag.CONDITIONAL)).any()


def test_expressions_and_statements_are_those_of_linuxcnc(linuxcnc: Oracle) -> None:
    truth = [each.end for each in linuxcnc(MACROS.encode())]
    require_same(read(MACROS).moves, truth, digit=1e-4)


def ends(text: str, dialect: Dialect) -> list[float]:
    """Ends in X of the moves at a feed."""
    moves = read(text, dialect).moves
    found: list[float] = moves.end[moves.kind == MoveKind.LINE][:, 0].tolist()
    return found


FANUC_HEAD = "O1\nG21 G90 G17\nT1 M6\nG0 X0. Y0. Z0.\nF100.\n"


@every_case(
    ("code", "wanted"),
    [
        ("#100=1\nWHILE [#100 LE 3] DO1\nG1 X[#100*10]\n#100=#100+1\nEND1\n", [10, 20, 30]),
        (
            "#1=0\nWHILE[#1LT2]DO1\n#2=0\nWHILE[#2LT2]DO2\nG1 X[#1*10+#2]\n#2=#2+1\nEND2\n"
            "#1=#1+1\nEND1\n",
            [0, 1, 10, 11],
        ),
        ("#1=3\nN10 G1 X#1\n#1=#1-1\nIF [#1 GT 0] GOTO 10\nG1 X-#1\n", [3, 2, 1, 0]),
        ("#1=2\nIF [#1 EQ 2] THEN #3=8\nIF [#1 NE 2] THEN #3=9\nG1 X#3\n", [8]),
        ("GOTO 20\nG1 X5.\nN20 G1 X7.\n", [7]),
        ("G65 P2 L2 A4. X5.\n#24=1\nG1 X#24\n", [9, 9, 1]),
        ("#1=1\n#33=2\nM98 P3\nG1 X#1\n", [3, 3]),
        ("#5=FIX[-1.5]\nG1 X[#5*ROUND[2.4]]\nX[SQRT[9]+ATAN[1]/[1]]\n", [-2, 48]),
    ],
)
def test_fanuc_evaluates_conditions_loops_jumps_and_arguments(
    code: str, wanted: list[float]
) -> None:
    subprograms = "M30\nO2\nG1 X[#1+#24]\nM99\nO3\n#1=#1+#33\nG1 X#1\nM99\n"
    assert ends(FANUC_HEAD + code + subprograms, Dialect.FANUC) == pytest.approx(wanted)


@every_case(
    ("dialect", "code"),
    [
        (Dialect.FANUC, "G1 X#100\n"),
        (Dialect.FANUC, "#1=#5021\nG1 X#1\n"),
        (Dialect.FANUC, "#1=[6 AND 3]\nG1 X#1\n"),
        (Dialect.FANUC, "/#1=5\nG1 X#1\n"),
        (Dialect.FANUC, "#1=5\nIF [#500 EQ 1] GOTO 5\n#1=6\nN5 G1 X#1\n"),
        (Dialect.FANUC, "#1=5\nM98 P77\nG1 X#1\n"),
        (Dialect.LINUXCNC, "#1=[1/0]\nG1 X#1\n"),
        (Dialect.LINUXCNC, "#5161=3\nG1 X#5161\n"),
        (Dialect.LINUXCNC, "#1=acos[2]\nG1 X#1\n"),
        (Dialect.LINUXCNC, "#1=5\no1 if [#500 GT 0]\n#1=6\no1 endif\nG1 X#1\n"),
        (Dialect.LINUXCNC, "#1=5\n#[#500]=7\nG1 X#1\n"),
        (Dialect.LINUXCNC, "G1 X[[[[[1]]]]\n"),
    ],
)
def test_what_does_not_follow_from_the_program_is_unknown(dialect: Dialect, code: str) -> None:
    found = ends(FANUC_HEAD[3:] + code + "M30\n", dialect)
    assert all(map(isnan, found))


@pytest.mark.parametrize(
    ("dialect", "code"),
    [
        (Dialect.LINUXCNC, "o1 while [1 EQ 1]\nG1 X1\nX2\no1 endwhile\nG90 G1 Y5\n"),
        (Dialect.LINUXCNC, "o1 do\nG1 X1\nX2\no1 while [1]\nG90 G1 Y5\n"),
        (Dialect.FANUC, "WHILE [1 EQ 1] DO 1\nG1 X1.\nX2.\nEND 1\nG90 G1 Y5.\n"),
        (Dialect.FANUC, "N7 G1 X1.\nX2.\nIF [1 EQ 1] GOTO 7\nG1 Y5.\n"),
    ],
)
def test_an_endless_loop_ends(
    dialect: Dialect, code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flow, "MOST_LOOPED", 3_000)
    program = read(FANUC_HEAD[3:] + code + "M30\n", dialect)
    moves = program.moves
    assert 1_000 < len(moves) < 4_000
    last = moves.move(len(moves) - 1)
    assert last.end[1] == 5.0
    assert isnan(last.end[0])
    assert program.findings


def test_a_loop_is_left_and_continued_by_its_name() -> None:
    text = (
        "G21 G90\nF100\nG0 X0 Y0 Z0\n#1=0\no1 while [#1 LT 9]\n#1=[#1+1]\n"
        "o2 if [#1 EQ 2]\no1 continue\no2 endif\no3 if [#1 GE 4]\no1 break\no3 endif\n"
        "G1 X#1\no1 endwhile\nG1 X50\nM2\n"
    )
    assert ends(text, Dialect.LINUXCNC) == [1.0, 3.0, 50.0]


def test_feeds_of_known_variables_are_advised_and_no_macro_block_is_split() -> None:
    text = "G21 G90\nG0 X0 Y0 Z0\n#1=60 #2=30\nG1 X#2 F#1\nX[#2*2] F120\nY#2\nM2\n"
    program = read(text)
    moves = program.moves
    cuts = np.flatnonzero(moves.kind == MoveKind.LINE)
    assert moves.feed[cuts].tolist() == pytest.approx([1.0, 2.0, 2.0])
    assert moves.is_advisable[cuts].all()
    assert not moves.is_splittable[cuts].any()
    advice = [BlockAdvice(block=block, ends=(0.5, 1.0), feeds=(3.0, 4.0)) for block in (3, 4)]
    result = rewrite(program, advice)
    assert result.data.decode() == text.replace("F#1\n", "F180\n").replace(
        "F120\nY#2", "F180\nY#2 F120"
    )
    assert [each.block for each in result.unchanged] == [3, 4]
