"""Output of feeds along the paths: text, JSON, CSV and the report, from the command line."""

import csv
import json
from pathlib import Path

import pytest

from service.cli.main import optimise_main
from tests.service.along_path.samples import SHAFT


def run(*options: str) -> int:
    """Run ``optimise`` and return its exit code."""
    with pytest.raises(SystemExit) as ended:
        optimise_main([str(SHAFT), "--along-path", *options])
    return int(ended.value.code or 0)


def test_text_report_and_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report, feeds = tmp_path / "r.html", tmp_path / "f.csv"
    words = [
        "-o",
        str(tmp_path / "o.stpnc"),
        "--report",
        str(report),
        "--feeds-csv",
        str(feeds),
    ]
    assert run(*words, "--jerk", "--smooth", "0.05") == 0
    shown = capsys.readouterr().out
    assert "one feed per part -> along the path" in shown
    assert "s with limited jerk" in shown
    assert "s as the smoothest profile" in shown
    assert "share of the path by active limit: " in shown
    page = report.read_text()
    assert "Along the paths" in page
    assert "Path, coloured by feed" in page
    with feeds.open() as lines:
        rows = list(csv.DictReader(lines))
    assert {row["unit"] for row in rows} <= {"mm/min", "mm/rev"}
    assert all(float(row["feed"]) > 0.0 for row in rows)
    last = {row["block"]: float(row["end_of_block"]) for row in rows}
    assert set(last.values()) == {1.0}


def test_json_tells_the_certificate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("-o", str(tmp_path / "o.stpnc"), "--json", "--levels", "4") == 0
    found = json.loads(capsys.readouterr().out)["along_path"]
    assert found["time_s"]["after"] < found["time_s"]["before"]
    assert found["free_profile"]["bound_s"] <= found["free_profile"]["time_s"]
    assert found["free_profile"]["greatest_excess"] < 1e-9
    assert sum(found["active_limits"].values()) == pytest.approx(1.0)
    assert all(part["feeds"] is None or part["feeds"] <= 4 for part in found["parts"])
