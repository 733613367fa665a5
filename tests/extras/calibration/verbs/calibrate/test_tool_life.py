"""``stepnc calibrate --life``: a table for a material's file, and what is refused."""

import json
import tomllib
from pathlib import Path

import pytest

from service.cli.main import main
from tests.every_case import every_case

BAD_INPUT, USAGE = 3, 2
PAIRS = ("--life", "160:5", "--life", "100:41")


def calibrated(*words: object) -> int:
    """Exit code of ``stepnc calibrate``."""
    try:
        main(["calibrate", *map(str, words)])
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def test_pairs_become_a_table_of_a_material(capsys: pytest.CaptureFixture[str]) -> None:
    assert calibrated(*PAIRS) == 0
    (table,) = tomllib.loads(capsys.readouterr().out)["tool_life"]
    assert table["cutting_material"] == "carbide"
    assert table["exponent"] == pytest.approx(0.2234)
    assert table["constant_m_min"] == pytest.approx(229.22)
    assert "2 pairs, 100 to 160 m/min" in table["source"]


def test_a_file_adds_pairs_and_then_there_is_an_interval(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows, output = tmp_path / "lives.csv", tmp_path / "life.toml"
    rows.write_text("tool,speed_m_min,life_min\nA,130,12\nB,115,20\n", encoding="utf-8")
    words = (*PAIRS, "--tool-life", rows, "--edge", "hss", "-o", output, "--json")
    assert calibrated(*words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["pairs"] == 4
    assert found["exponent_low"] < found["exponent"] < found["exponent_high"]
    (table,) = tomllib.loads(output.read_text(encoding="utf-8"))["tool_life"]
    assert table["cutting_material"] == "hss"
    assert "(95 %)" in table["source"]


@every_case(
    ("words", "message"),
    [
        (("--life", "160:5"), "at least 2"),
        (("--life", "160"), "write 120:25"),
        (("--life", "160:x", "--life", "100:3"), "must be two numbers"),
        ((*PAIRS, "--edge", "wood"), "hss, carbide, ceramic"),
        ((*PAIRS, "-o", "life.csv"), "must end with .toml"),
        ((*PAIRS, "run.csv"), "in separate calls"),
        (("--tool-life", "/nowhere/lives.csv"), "No such file"),
    ],
)
def test_what_is_no_pair_is_refused(
    words: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert calibrated(*words) == BAD_INPUT
    assert message in capsys.readouterr().err


def test_a_file_without_the_columns_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = tmp_path / "lives.csv"
    rows.write_text("speed,life\n1,2\n", encoding="utf-8")
    assert calibrated("--tool-life", rows) == BAD_INPUT
    assert "missing column speed_m_min and life_min" in capsys.readouterr().err


def test_neither_runs_nor_lives_is_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert calibrated() == USAGE
    assert "--life" in capsys.readouterr().err
