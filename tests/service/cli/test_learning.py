"""``stepnc dataset``, ``learn`` and ``predict`` as a user types them."""

import json
from pathlib import Path

import pytest

from service.cli.main import main
from tests.service.learning.tables import law_table, written


def run(*words: object) -> object:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return ended.value.code


def test_learn_then_predict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = written(tmp_path, law_table(200, noise=0.05))
    model, page = tmp_path / "model.skops", tmp_path / "page.html"
    asked = ("learn", data, "--model", "power-law", "--train", 100, "--test", 60)
    assert run(*asked, "-o", model, "--report", page) == 0
    shown = capsys.readouterr()
    assert "ceiling: R² 0." in shown.out
    assert [line.split()[0] for line in shown.out.splitlines() if "(" in line][:3] == [
        "power-law", "mean", "physics",
    ]  # fmt: skip
    assert f"model: {model}" in shown.err
    assert "predicted total_power_w" in page.read_text(encoding="utf-8")
    settings = ("--feed-mm-s", 50, "--spindle-rad-s", 100, "--depth-mm", 3)
    assert run("predict", model, *settings) == 0
    name, value, unit = capsys.readouterr().out.split()
    assert (name, unit) == ("total_power_w", "W")
    assert float(value) == pytest.approx(10.0 * 50.0**0.5 * 100.0**0.3, rel=0.02)
    assert run("predict", model, *settings, "--json") == 0
    assert json.loads(capsys.readouterr().out)["values"] == [
        pytest.approx(float(value), rel=1e-5)
    ]
    assert run("predict", model, "--feed-mm-s", 500, *settings[2:]) == 3
    assert "feed_mm_s 500 mm/s exceeds" in capsys.readouterr().err


def test_learn_in_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = written(tmp_path, law_table(200, noise=0.05))
    asked = ("learn", data, "--model", "forest", "--train", 100, "--test", 60, "--json")
    assert run(*asked) == 0
    shown = json.loads(capsys.readouterr().out)
    assert set(shown["scores"]) == {"forest", "mean", "power-law", "physics"}
    assert shown["ceiling"] == shown["scores"]["physics"]["r2"]


def test_a_bad_design_file_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    design = tmp_path / "design.toml"
    design.write_text(
        'program = "p.stpnc"\nmachine = "vmc15"\nfeed_mm_s = [9, 3]\n', encoding="utf-8"
    )
    assert run("dataset", design, "-n", 3, "-o", tmp_path / "data") == 3
    assert "design.toml: feed_mm_s: [9, 3]: expected a lower" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()
