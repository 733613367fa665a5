"""What the documents show is what the commands print."""

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from service.cli.main import main, optimise_main

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_command_prints_what_the_readme_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    shown = re.search(r"    \$ optimise (.*) -o part\.stpnc\n((?:    [^$].*\n)+)", README)
    assert shown is not None
    with pytest.raises(SystemExit) as stopped:
        optimise_main([*shown[1].split(), "-o", str(tmp_path / "part.stpnc")])
    assert stopped.value.code == 0
    printed = capsys.readouterr().out
    for line in shown[2].splitlines():
        assert line.removeprefix("    ") in printed


def test_the_simulation_prints_what_the_readme_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    part = tmp_path / "part.stpnc"
    first = re.search(r"    \$ optimise (.*) -o part\.stpnc\n", README)
    shown = re.search(
        r"    \$ stepnc simulate part\.stpnc (.*) -o run\.csv --report run\.html\n"
        r"((?:    [^$].*\n)+)",
        README,
    )
    assert first is not None
    assert shown is not None
    with pytest.raises(SystemExit):
        optimise_main([*first[1].split(), "-o", str(part)])
    capsys.readouterr()
    run, page = tmp_path / "run.csv", tmp_path / "run.html"
    with pytest.raises(SystemExit) as stopped:
        main([
            "simulate", str(part), *shown[1].split(), "-o", str(run), "--report", str(page)
        ])  # fmt: skip
    assert stopped.value.code == 0
    printed = capsys.readouterr().out
    for line in shown[2].splitlines():
        assert line.removeprefix("    ") in printed
    assert run.exists()
    assert page.exists()


def test_the_python_of_the_readme_prints_its_comment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    code = re.search(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert code is not None
    expected = re.search(r"print\(.*\)  # (.*)", code[1])
    assert expected is not None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code[1], "README.md", "exec"), {})
    assert printed.getvalue().strip() == expected[1]


def test_the_control_loop_runs_as_the_readme_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = re.search(r"    \$ optimise (.*) -o part\.stpnc\n", README)
    shown = re.search(r"    \$ stepnc (control .*)\n", README)
    assert first is not None
    assert shown is not None
    monkeypatch.setenv("STEPNC_KB", "")
    source = first[1].replace("examples", str(ROOT / "examples"))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit):
        optimise_main([*shlex.split(source), "-o", "part.stpnc"])
    with pytest.raises(SystemExit) as stopped:
        main(shlex.split(shown[1]))
    assert stopped.value.code == 0
    assert {"shop.db", "control.html"} <= {path.name for path in tmp_path.iterdir()}
