"""NC code that repeats: how often is bounded, said with the line, and may be raised."""

from pathlib import Path

import pytest

from service.cli.main import main
from stepnc_model.errors import PostError
from stepnc_model.nc.program import read_program
from stepnc_model.nc.unroll import unrolled
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case
from tests.limited import refusals

HEAD = "%\nO1000\nG21 G90 G17\nT1 M6\nS1000 M3\nG0 X0. Y0. Z10.\nG1 Z-1. F100\n"
CYCLE = "G81 G91 X0.001 Z-2. R1. F50 L9999\n"
LONG = "G1 " + " ".join(f"(comment {number})" for number in range(200)) + " X1. F100\n"

CASES = {
    "cycles": (HEAD + CYCLE * 3 + "M30\n", Dialect.FANUC, 8),
    "pecks": (
        HEAD + "G83 G91 X0.001 Z-900. R1. Q0.1 F50 L9999\nM30\n", Dialect.FANUC, 8,
    ),
    "calls": (HEAD + "M98 P2000 L9999\nM30\nO2000\nG1 X1. F100\nX0.\nM99\n", Dialect.FANUC, 11),
    "long blocks": (
        HEAD + "M98 P2000 L500\nM30\nO2000\n" + LONG + "M99\n", Dialect.FANUC, 11,
    ),
    "sinumerik": (
        "G71 G90\nT1 M6\nS1000 M3\nMARK: G1 X1 F100\nX0\nREPEAT MARK P=9999\nM30\n",
        Dialect.SINUMERIK, 5,
    ),
    "klartext": (
        "0 BEGIN PGM A MM\n1 LBL 1\n2 L X+1 F100\n3 CALL LBL 1 REP 9999\n4 END PGM A MM\n",
        Dialect.HEIDENHAIN, 4,
    ),
}  # fmt: skip


@every_case("name", CASES)
def test_a_program_that_repeats_too_much_is_refused_at_its_line(name: str) -> None:
    text, dialect, _ = CASES[name]
    with pytest.raises(PostError) as caught:
        read_program(text.encode(), dialect=dialect, most_repeats=5000)
    assert caught.value.line is not None
    assert "--most-repeats" in str(caught.value)


def test_the_bound_can_be_raised_and_goes_with_the_program() -> None:
    text = HEAD + "M98 P2000 L60\nM30\nO2000\nG1 X1. F100\nX0.\nM99\n"
    program = read_program(text.encode(), dialect=Dialect.FANUC, most_repeats=300)
    assert len(program.moves) == 2 + 2 * 60
    with pytest.raises(PostError):
        read_program(text.encode(), dialect=Dialect.FANUC, most_repeats=20)
    assert len(unrolled(program).program.moves) == len(program.moves)


def test_blocks_that_are_executed_once_are_never_too_many() -> None:
    text = HEAD + "G81 X1. Z-2. R1. F50\n" + "X2.\nX3.\n" * 100 + "G80\nM30\n"
    assert len(read_program(text.encode(), most_repeats=0).moves) > 3 * 200


def test_the_command_line_bounds_and_raises(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "repeats.nc"
    file.write_text(HEAD + "G81 G91 X0.001 Z-2. R1. F50 L400\nM30\n")
    for words, code in (([], 0), (["--most-repeats", "100"], 3)):
        with pytest.raises(SystemExit) as ended:
            main(["check", str(file), *words])
        assert ended.value.code == code
    assert "line 8" in capsys.readouterr().err


def test_the_usual_bound_costs_little_memory_and_time(tmp_path: Path) -> None:
    file = tmp_path / "repeats.nc"
    file.write_text(HEAD + CYCLE * 200 + "M30\n")
    (text,) = refusals(
        "stepnc.check(path)",
        [file],
        imports="import stepnc, service.verbs.check.run",
        memory=1000,
        seconds=25,
    )
    assert "moves" in text
