"""The command ``stepnc control``: options, exit codes, what goes where."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from service.cli.main import main
from service.errors import LIMIT_EXCEEDED, OK
from tests.asking import AskedControl

Controlled = Callable[..., AskedControl]


@pytest.fixture
def words(controlled: Controlled) -> list[str]:
    """A short slot."""
    _, asked = controlled()
    assert asked.code is not None
    return [str(asked.file), "--nc", str(asked.code.code), "--machine", "vmc15"]


def run(*words: object) -> object:
    """Exit code of ``stepnc control``."""
    with pytest.raises(SystemExit) as stopped:
        main(["control", *map(str, words)])
    return stopped.value.code


def test_a_table_goes_to_stdout_and_events_to_stderr(
    words: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    output, report = tmp_path / "run.parquet", tmp_path / "run.html"
    assert run(*words, "-o", output, "--report", report, "--preview") == OK
    out, told = capsys.readouterr()
    assert "MILL SLOT" in out
    assert "log-pi with preview of 8 revolutions" in out
    assert " s  workingstep: MILL SLOT: force bound " in told
    assert f"written: {output} (" in told
    assert f"report: {report}" in told
    assert report.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert {each.name for each in tmp_path.iterdir()} == {"run.html", "run.parquet"}


def test_json_is_json(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(*words, "--json", "--law", "pi", "--band", "50,110", "--mode", "qc") == OK
    shown = json.loads(capsys.readouterr().out)
    assert (shown["law"], shown["mode"], shown["override_band"]) == ("pi", "QC", [0.5, 1.1])


def test_a_broken_tooth_is_an_exit_code_of_its_own(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words, "--disturb", "tooth:1@7s") == LIMIT_EXCEEDED
    out, told = capsys.readouterr()
    assert "breakage: tooth 1 of " in told
    assert "limit exceeded: stopped at " in out


def test_a_force_that_stays_above_is_the_same_exit_code(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing acts, and the force asked for is far below what the feed takes."""
    assert run(*words, "--law", "none", "--force", "50") == LIMIT_EXCEEDED
    assert "with chips above 1.05 times the set point of 50 N" in capsys.readouterr().out


def test_the_power_of_the_drive_can_be_the_sensor(
    words: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The drive's idle power is learnt while the program waits for the spindle."""
    program, option, code, *rest = words
    waiting = tmp_path / "waiting.ngc"
    text = Path(code).read_text(encoding="ascii").replace("M3\n", "M3\nG4 P3\n")
    waiting.write_text(text, encoding="ascii")
    assert run(program, option, waiting, *rest, "--sensor", "power", "--json") == OK
    (*_, slot) = json.loads(capsys.readouterr().out)["workingsteps"]
    assert slot["kc_factor"]["value"] == pytest.approx(1.0, abs=0.2)


def test_help_names_every_option_and_disturbance(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == OK
    shown = capsys.readouterr().out
    for word in (
        "--law", "--preview", "--look-ahead", "--disturb", "--seed", "--force", "--band",
        "--sensor", "--report", "--kb", "depth:+50%@12s", "Exit code 5",
    ):  # fmt: skip
        assert word in shown
    assert "%%" not in shown
