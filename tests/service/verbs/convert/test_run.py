"""``convert --to``: a program by the other standard, and what could not be said in it."""

import json
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from service.verbs.convert.request import Standard
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[4] / "examples" / "parts"


def test_a_program_goes_to_ap238_and_back(tmp_path: Path) -> None:
    there, back = tmp_path / "there.238", tmp_path / "back.stpnc"
    assert stepnc.convert(PARTS / "bracket.stpnc", to="ap238", output=there).findings == ()
    assert stepnc.convert(there, to="iso14649", output=back).findings == ()
    one, other = Program.load(PARTS / "bracket.stpnc"), Program.load(back)
    assert [step.id for step in one.workingsteps] == [step.id for step in other.workingsteps]


def advice(path: Path, capsys: pytest.CaptureFixture[str]) -> object:
    """Advice about each workingstep, without the instance numbers."""
    with pytest.raises(SystemExit) as ended:
        main(["optimise", str(path), "--dry-run", "--json"])
    assert ended.value.code == 0
    steps = json.loads(capsys.readouterr().out)["workingsteps"]
    return [{name: each[name] for name in each.keys() - {"instance"}} for each in steps]


def test_the_advice_is_the_same_by_either_standard(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    there = tmp_path / "there.238"
    stepnc.convert(PARTS / "shaft.stpnc", to="ap238", output=there)
    assert advice(there, capsys) == advice(PARTS / "shaft.stpnc", capsys)


@pytest.mark.parametrize("standard", Standard)
def test_a_program_of_that_standard_already_is_refused(
    standard: Standard, tmp_path: Path
) -> None:
    path = PARTS / "paper002.stpnc"
    if standard is Standard.AP238:
        path = tmp_path / "a.238"
        stepnc.convert(PARTS / "paper002.stpnc", to="ap238", output=path)
    with pytest.raises(StepNcError, match=f"standard '{standard.value}' already"):
        stepnc.convert(path, to=standard.value, output=tmp_path / "b.238")
    assert not (tmp_path / "b.238").exists()


def test_the_program_itself_is_never_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(StepNcError):
        stepnc.convert(path, to="ap238", output=path)
    assert path.read_bytes() == (PARTS / "paper002.stpnc").read_bytes()


def test_nc_code_is_refused_by_name(tmp_path: Path) -> None:
    code = tmp_path / "part.ngc"
    code.write_text("G21 G90\nG1 X10 F100\nM2\n")
    with pytest.raises(StepNcError, match=r"part\.ngc: is NC code"):
        stepnc.convert(code, to="ap238", output=tmp_path / "a.238")


@pytest.mark.parametrize("words", [{}, {"to": "ap238", "profile": "standard"}])
def test_one_way_is_named(
    words: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part, output = PARTS / "paper002.stpnc", tmp_path / "a.238"
    with pytest.raises(StepNcError, match=f"give one of to and profile; given: {len(words)}"):
        stepnc.convert(part, output=output, **words)  # type: ignore[arg-type]
    typed = [text for name, word in words.items() for text in (f"--{name}", word)]
    with pytest.raises(SystemExit) as ended:
        main(["convert", str(part), "-o", str(output), *typed])
    assert ended.value.code == 2
    assert "--profile" in capsys.readouterr().err
    assert not output.exists()


def test_what_was_written_is_told_and_in_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "a.238"
    found = stepnc.convert(PARTS / "paper002.stpnc", to="ap238", output=output)
    assert str(found) == f"{output}: written by standard 'ap238'"
    words = ["convert", str(output), "--to", "iso14649", "-o", str(tmp_path / "b"), "--json"]
    with pytest.raises(SystemExit):
        main(words)
    record = json.loads(capsys.readouterr().out)
    assert (record["standard"], record["profile"]) == ("iso14649", None)
    assert record["written"] == str(tmp_path / "b")
