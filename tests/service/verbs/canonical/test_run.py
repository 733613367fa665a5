"""The verb ``canonical``: the same commands of STEP-NC and of NC code for any control."""

import logging
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from service.errors import BAD_INPUT
from stepnc_model.errors import StepNcError
from stepnc_model.post.dialect import Dialect

PARTS = Path(__file__).parents[4] / "examples" / "parts"


@pytest.fixture
def bracket(tmp_path: Path) -> Path:
    path = tmp_path / "bracket.stpnc"
    path.write_bytes((PARTS / "bracket.stpnc").read_bytes())
    return path


def test_canonical_commands_of_nc_code_equal_those_of_the_program(bracket: Path) -> None:
    for control in ("linuxcnc", "sinumerik"):
        stepnc.post(bracket, control=control)
    one = stepnc.canonical(bracket.with_suffix(".ngc")).commands
    other = stepnc.canonical(bracket.with_suffix(".mpf")).commands
    feeds = [
        [each.name for each in found if each.name == "STRAIGHT_FEED"] for found in (one, other)
    ]
    assert len(feeds[0]) == len(feeds[1]) > 100


def test_a_line_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    code = tmp_path / "part.nc"
    code.write_text("%\nO0001\nG21\nG1 X10. Q?\nM30\n%\n")
    with pytest.raises(StepNcError, match=r"part\.nc: line 4: "):
        stepnc.canonical(code, dialect="fanuc")


def test_canonical_prints_commands(bracket: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stepnc.post(bracket, control="haas")
    with pytest.raises(SystemExit) as ended:
        main(["canonical", str(bracket.with_suffix(".nc")), "--control", "haas"])
    assert ended.value.code == 0
    assert "PROGRAM_END()" in capsys.readouterr().out


def test_a_program_has_the_commands_that_post_writes(bracket: Path) -> None:
    stepnc.post(bracket, control="canonical")
    lines = bracket.with_suffix(Dialect.CANONICAL.suffix).read_text().splitlines()
    found = stepnc.canonical(bracket)
    assert str(found).splitlines() == [line.split(maxsplit=1)[1] for line in lines]
    assert found.control is None
    again = stepnc.canonical(bracket.with_suffix(Dialect.CANONICAL.suffix), dialect="canonical")
    assert [each.name for each in again.commands] == [each.name for each in found.commands]


@pytest.mark.parametrize("control", ["linuxcnc", "fanuc", "haas", "sinumerik", "heidenhain"])
def test_the_control_is_guessed_and_told(
    control: str, bracket: Path, caplog: pytest.LogCaptureFixture
) -> None:
    written = stepnc.post(bracket, control=control).written  # type: ignore[arg-type]
    with caplog.at_level(logging.INFO, logger="stepnc"):
        found = stepnc.canonical(written)
    assert found.control == control
    assert f"control: {control}, guessed from " in caplog.messages[-1]
    named = stepnc.canonical(written, dialect=control)  # type: ignore[arg-type]
    assert found.commands == named.commands


def test_code_of_a_lathe_is_guessed_or_named(tmp_path: Path) -> None:
    code = tmp_path / "shaft.nc"
    stepnc.post(PARTS / "shaft.stpnc", control="fanuc", output=code)
    named = stepnc.canonical(code, dialect="fanuc", is_lathe=True)
    assert stepnc.canonical(code).commands == named.commands
    with pytest.raises(StepNcError, match="use --lathe for lathe code"):
        stepnc.canonical(code, dialect="fanuc")


def test_commands_are_a_table(bracket: Path) -> None:
    found = stepnc.canonical(bracket)
    rows = found.record()["commands"]
    assert rows[0] == {"name": "COMMENT", "arguments": ["bracket"]}
    assert [row["name"] for row in rows] == [each.name for each in found.commands]


def test_what_is_left_out_of_a_program_is_bad_input(tmp_path: Path) -> None:
    text = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
    part = tmp_path / "part.stpnc"
    part.write_text(text.replace("'',(0.,0.,-12.)", "'',(0.,0.,0.)"), encoding="ascii")
    found = stepnc.canonical(part, keep_going=True)
    assert found.exit_code == BAD_INPUT
    assert found.record()["left_out"]


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        ({"dialect": "fanuc"}, "--control cannot be used with a STEP-NC program"),
        ({"is_lathe": True}, "--lathe cannot be used with a STEP-NC program"),
    ],
)
def test_options_of_code_are_refused_with_a_program(
    words: dict[str, object], refused: str, bracket: Path
) -> None:
    with pytest.raises(StepNcError, match=refused):
        stepnc.canonical(bracket, **words)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        ({"keep_going": True}, "--keep-going cannot be used with NC code"),
        ({"stock": "0,0,-1,1,1,0"}, "--stock cannot be used with NC code"),
    ],
)
def test_options_of_programs_are_refused_with_code(
    words: dict[str, object], refused: str, tmp_path: Path
) -> None:
    code = tmp_path / "part.txt"
    code.write_text("G21 G90\nG1 X10 F100\nM2\n")
    with pytest.raises(StepNcError, match=refused):
        stepnc.canonical(code, **words)  # type: ignore[arg-type]
