"""The commands ``stepnc simulate`` and ``calibrate``: options, exit codes, what goes where."""

import json
import re
from pathlib import Path

import pytest

from service.cli.main import main
from service.errors import BAD_INPUT, LIMIT_EXCEEDED, OK
from simulator.library import load_machine

USAGE = 2

PARTS = Path(__file__).parents[3] / "examples" / "parts"
SLOT = PARTS / "paper003_case1.stpnc"


@pytest.fixture
def code(tmp_path: Path) -> Path:
    path = tmp_path / "slot.ngc"
    path.write_text(
        "G21 G90 G94\nT1 M6\nS3000 M3\nG0 X-20 Y0 Z5\nZ-2\nG1 X60 F300\nM30\n", encoding="ascii"
    )
    table = '[[tool]]\nnumber = 1\nkind = "endmill"\ndiameter_mm = 10\nteeth = 4\n'
    path.with_name("tools.toml").write_text(table, encoding="ascii")
    return path


def run(*words: object) -> object:
    """Exit code of ``stepnc simulate``."""
    with pytest.raises(SystemExit) as stopped:
        main(["simulate", *map(str, words)])
    return stopped.value.code


def test_a_table_goes_to_stdout_and_messages_to_stderr(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    output = tmp_path / "run.csv"
    assert run(SLOT, "--machine", "vmc15", "-o", output) == OK
    out, told = capsys.readouterr()
    assert "MILL SLOT" in out
    assert "energy" in out
    assert re.search(rf"^written: {output} \(\d+ samples\)$", told, re.MULTILINE)
    assert output.exists()


def test_json_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(SLOT, "--machine", "vmc15", "--json") == OK
    shown = json.loads(capsys.readouterr().out)
    assert shown["machine"] == "vmc15"
    assert shown["control"] == "fir"
    assert shown["total"]["time_s"] > 0.0


def test_a_report_needs_no_output(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    report = tmp_path / "run.html"
    assert run(SLOT, "--machine", "vmc15", "--report", report, "--json") == OK
    out, told = capsys.readouterr()
    assert f"report: {report}" in told
    assert json.loads(out)["samples"] == 0
    page = report.read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert "MILL SLOT" in page
    assert [each.name for each in tmp_path.iterdir()] == ["run.html"]


def test_coordinates_may_be_negative(code: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--nc", code, "--machine", "vmc15", "--tools", code.with_name("tools.toml")]
    words += ["--material", "c45", "--stock", "-10,-10,-5,50,10,0", "--zero", "-.5e3,250,450"]
    assert run(*words, "--json") == BAD_INPUT
    assert (
        "X = -20 mm is outside the travel of the axis, 500 to 1300" in capsys.readouterr().err
    )
    assert run(*words[:-2], "--json") == OK
    assert json.loads(capsys.readouterr().out)["total"]["volume_mm3"] == pytest.approx(
        60.0 * 10.0 * 2.0, rel=1e-4
    )


def test_a_drive_above_its_limit_is_an_exit_code_of_its_own(
    code: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fast = code.read_text(encoding="ascii").replace("F300", "F9000").replace("Z-2", "Z-15")
    code.write_text(fast, encoding="ascii")
    words = ["--nc", code, "--machine", "vmc15", "--tools", code.with_name("tools.toml")]
    words += ["--material", "c45", "--stock", "-10,-10,-20,50,10,0"]
    assert run(*words) == LIMIT_EXCEEDED
    assert "limit exceeded" in capsys.readouterr().out


def test_the_dialect_wants_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(SLOT, "--dialect", "x") == BAD_INPUT
    assert "needs NC code: name it with --nc" in capsys.readouterr().err


def test_help_names_every_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == OK
    shown = capsys.readouterr().out
    for option in ("--nc", "--rate", "--control", "--seed", "--report", "--noise", "--wear"):
        assert option in shown


def calibrate(*words: object) -> object:
    """Exit code of ``stepnc calibrate``."""
    with pytest.raises(SystemExit) as stopped:
        main(["calibrate", *map(str, words)])
    return stopped.value.code


def test_a_run_calibrates_the_machine_that_made_it(
    code: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ["--nc", code, "--machine", "vmc15", "--tools", code.with_name("tools.toml")]
    words += ["--material", "c45", "--stock", "-10,-10,-5,50,10,0"]
    output, mine = tmp_path / "run.csv", tmp_path / "mine.toml"
    assert run(*words, "--noise", "normal", "--rate", "5", "-o", output) == OK
    capsys.readouterr()
    assert calibrate(output, *words, "-o", mine) == OK
    out, told = capsys.readouterr()
    assert out.startswith("machine vmc15")
    assert re.search(r"^run +\d+\.\d +\d+\.\d +[+-]0\.\d\d%$", out, re.MULTILINE)
    assert f"machine file: {mine}" in told
    assert load_machine(str(mine)).title == load_machine("vmc15").title


def test_calibrate_says_what_it_wants(
    code: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert calibrate() == USAGE
    assert calibrate("--help") == OK
    shown = capsys.readouterr().out
    for option in ("RUN.csv", "--program", "--machine", "--nc", "--output"):
        assert option in shown
    path = tmp_path / "run.csv"
    rows = "".join(f"{row},{500 + row}\n" for row in range(20))
    path.write_text(f"time_s,electric_wattage\n{rows}", encoding="ascii")
    assert calibrate(path, "--machine", "vmc15") == BAD_INPUT
    told = capsys.readouterr().err
    assert told == "error: name a STEP-NC program, or NC code with --nc\n"
