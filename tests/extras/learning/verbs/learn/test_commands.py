"""``stepnc dataset``, ``learn``, ``predict`` and ``score`` as a user types them."""

import json
from pathlib import Path

import pytest

from service.cli.main import main
from tests.extras.learning.tables import changed, law_table, written
from tests.service.waiting import ROOT


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


def test_a_learning_curve_is_printed_and_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, page = written(tmp_path, law_table(200, noise=0.05)), tmp_path / "page.html"
    asked = ("learn", data, "--model", "power-law", "--train", 80, "--test", 60, "--curve")
    assert run(*asked, "--report", page) == 0
    lines = capsys.readouterr().out.splitlines()
    at = lines.index("learning curve, of the same test rows")
    assert [line.split()[0] for line in lines[at + 3 : at + 6]] == ["20", "40", "80"]
    text = page.read_text(encoding="utf-8")
    assert "Learning curve" in text
    assert "training rows" in text
    assert run(*asked, "--json") == 0
    curve = json.loads(capsys.readouterr().out)["curve"]
    assert [each["rows"] for each in curve] == [20, 40, 80]


def test_a_factor_on_k_c_is_written_for_the_knowledge_base(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = ROOT / "examples" / "parts" / "paper003_pocket.stpnc"
    table = law_table(200, noise=0.005)
    more = table["total_power_w"].to_numpy() + 0.15 * table["cutting_power_w"].to_numpy()
    data, file = written(tmp_path, changed(table, "total_power_w", more)), tmp_path / "kc.json"
    asked = ("learn", data, "--model", "power-law", "--train", 100, "--test", 60)
    on = (*asked, "--on-physics", "--outcome", file, "--program", part)
    assert run(*on) == 0
    assert "k_c × 1.1" in capsys.readouterr().out
    (outcome,) = json.loads(file.read_text(encoding="utf-8"))
    assert (outcome["machine"], outcome["tool"]) == ("mill", "END MILL 8MM")
    for words, message in (
        ((*asked, "--on-physics", "--outcome", file), "--outcome and --program belong"),
        ((*asked, "--outcome", file, "--program", part), "needs --on-physics"),
        ((*on, "--target", "energy_j"), "no factor on k_c: it needs the target total_power_w"),
    ):
        file.unlink(missing_ok=True)
        assert run(*words) == 3
        assert message in capsys.readouterr().err
        assert not file.exists()


def test_a_bad_design_file_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    design = tmp_path / "design.toml"
    design.write_text(
        'program = "p.stpnc"\nmachine = "vmc15"\nfeed_mm_s = [9, 3]\n', encoding="utf-8"
    )
    assert run("dataset", design, "-n", 3, "-o", tmp_path / "data") == 3
    assert "design.toml: feed_mm_s: [9, 3]: expected a lower" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()
