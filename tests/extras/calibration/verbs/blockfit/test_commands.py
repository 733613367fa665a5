"""Commands on block rate and cycle time, as typed."""

import json
from pathlib import Path

import pytest

from service.cli.main import main


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


def test_blocktest_writes_nc_code(tmp_path: Path) -> None:
    output = tmp_path / "test.ngc"
    code = run("blocktest", "--machine", "vmc15", "-o", output, "--unit", "mm",
               "--spacing", "0.05,0.1", "--radius", "20", "--lines", "50")  # fmt: skip
    assert code == 0
    assert output.read_text().count("G4 P1") == 4


def test_bad_numbers_end_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = run("blocktest", "--machine", "vmc15", "-o", tmp_path / "a.ngc", "--spacing", "x")
    assert code == 3
    assert "spacing 'x': expected a number" in capsys.readouterr().err


def test_a_block_time_is_found_and_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, log, found = tmp_path / "t.ngc", tmp_path / "t.parquet", tmp_path / "found.toml"
    page = tmp_path / "page.html"
    lists = ("--unit", "mm", "--spacing", "0.05,0.1,0.2", "--radius", "20", "--lines", "200")
    assert run("blocktest", "--machine", "vmc15", "-o", code, *lists) == 0
    assert run("simulate", "--nc", code, "--machine", "vmc15", "--rate", 50, "-o", log) == 0
    capsys.readouterr()
    assert run("blockfit", log, "--program", code, "--machine", "vmc15", "-o", found,
               "--report", page) == 0  # fmt: skip
    assert "block time 4.2" in capsys.readouterr().out
    assert run("cycletime", code, log, "--machine", found, "--json", "--report", page) == 0
    total = json.loads(capsys.readouterr().out)["total"]
    assert total["predicted_s"] == pytest.approx(total["actual_s"], rel=0.01)
    assert "Cycle time of t.ngc" in page.read_text(encoding="utf-8")


def test_an_unknown_control_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("cycletime", "a.ngc", "--machine", "vmc15", "--control", "spline") == 3
    assert "unknown control 'spline'" in capsys.readouterr().err
