"""The numbered example scripts run, and are short."""

import runpy
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).parents[2] / "examples").glob("*.py"))
MOST_LINES = 60
DRAWING = [script for script in SCRIPTS if "[PICTURE]" in script.read_text(encoding="utf-8")]


def test_scripts_are_numbered_in_order() -> None:
    numbers = [int(script.name.split("_")[0]) for script in SCRIPTS]
    assert numbers == list(range(1, len(SCRIPTS) + 1))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_script_is_short(script: Path) -> None:
    assert len(script.read_text(encoding="utf-8").splitlines()) < MOST_LINES


@pytest.mark.parametrize("script", DRAWING, ids=lambda script: script.name)
def test_script_draws_its_picture(
    script: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    picture = tmp_path / "new" / "picture.png"
    monkeypatch.setattr("sys.argv", [script.name, str(picture)])
    runpy.run_path(str(script))
    assert capsys.readouterr().out.splitlines()[-1] == f"picture: {picture}"
    assert picture.read_bytes().startswith(b"\x89PNG")
