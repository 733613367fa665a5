"""The commands ``toolpath``, ``post`` and ``canonical``: options, exit codes, outputs."""

from pathlib import Path

import pytest

from service.cli.main import main
from service.cli.options import BAD_INPUT, OK

PARTS = Path(__file__).parents[3] / "examples" / "parts"
SLOT = PARTS / "paper003_case1.stpnc"


def run(*words: object) -> object:
    """Exit code of ``stepnc``."""
    with pytest.raises(SystemExit) as stopped:
        main(list(map(str, words)))
    return stopped.value.code


def test_code_is_written_and_read_again(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code = tmp_path / "slot.mpf"
    assert run("post", SLOT, "--control", "sinumerik", "-o", code) == OK
    capsys.readouterr()
    assert run("canonical", code, "--control", "sinumerik") == OK
    assert "STRAIGHT_FEED" in capsys.readouterr().out


def test_code_of_a_lathe_says_so(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code = tmp_path / "shaft.nc"
    assert run("post", PARTS / "shaft.stpnc", "--control", "fanuc", "-o", code) == OK
    assert run("canonical", code, "--control", "fanuc", "--lathe") == OK
    assert run("canonical", code, "--control", "fanuc") == BAD_INPUT


def test_what_is_left_out_is_bad_input(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
    part = tmp_path / "part.stpnc"
    part.write_text(text.replace("'',(0.,0.,-12.)", "'',(0.,0.,0.)"), encoding="ascii")
    assert run("toolpath", part, "--keep-going") == BAD_INPUT
    assert "left out: " in capsys.readouterr().err
