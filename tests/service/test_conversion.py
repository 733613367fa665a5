"""``convert --to``: a program by the other standard, and what could not be said in it."""

import json
from pathlib import Path

import pytest

from service.cli.main import main
from service.conversion import Standard, convert_to
from stepnc_model.errors import StepNcError
from stepnc_model.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def test_a_program_goes_to_ap238_and_back(tmp_path: Path) -> None:
    there, back = tmp_path / "there.238", tmp_path / "back.stpnc"
    assert convert_to(PARTS / "bracket.stpnc", standard=Standard.AP238, output=there) == ()
    assert convert_to(there, standard=Standard.ISO14649, output=back) == ()
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
    convert_to(PARTS / "shaft.stpnc", standard=Standard.AP238, output=there)
    assert advice(there, capsys) == advice(PARTS / "shaft.stpnc", capsys)


@pytest.mark.parametrize("standard", Standard)
def test_a_program_of_that_standard_already_is_refused(
    standard: Standard, tmp_path: Path
) -> None:
    path = PARTS / "paper002.stpnc"
    if standard is Standard.AP238:
        path = tmp_path / "a.238"
        convert_to(PARTS / "paper002.stpnc", standard=standard, output=path)
    with pytest.raises(StepNcError, match=f"standard '{standard.value}' already"):
        convert_to(path, standard=standard, output=tmp_path / "b.238")
    assert not (tmp_path / "b.238").exists()


def test_the_program_itself_is_never_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(StepNcError):
        convert_to(path, standard=Standard.AP238, output=path)
    assert path.read_bytes() == (PARTS / "paper002.stpnc").read_bytes()
