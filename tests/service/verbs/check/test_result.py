"""Text and JSON of ``check``."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import stepnc
from service.rendering.text import MOST_FINDINGS, print_line
from service.verbs.check.result import ProgramContents
from service.verbs.result import Result
from stepnc_model.errors import Finding, Severity
from tests.checked import check
from tests.service.verbs.check.test_run import CODE

PARTS = Path(__file__).parents[4] / "examples" / "parts"
ESCAPE = "\x1b"


def show(result: Result) -> None:
    """Print a result as the command line does."""
    for text, colour in result.view().lines(width=200):
        print_line(text, colour)


def warning(number: int) -> Finding:
    return Finding(severity=Severity.WARNING, message=f"finding {number}")


def contents(*findings: Finding) -> ProgramContents:
    return replace(check(PARTS / "paper002.stpnc"), findings=findings)


class Terminal:
    """Text that claims to be shown on a terminal."""

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> None:
        self.text += text

    def isatty(self) -> bool:
        return True


def test_contents_show_the_tree_and_whether_it_is_usable(
    capsys: pytest.CaptureFixture[str],
) -> None:
    show(check(PARTS / "bracket.stpnc"))
    shown = capsys.readouterr().out
    assert "workplan" in shown
    assert "REAM HOLE 2" in shown
    assert shown.endswith("  advice: yes\n")


def test_nobody_sees_colours_in_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    show(contents(warning(1)))
    assert ESCAPE not in capsys.readouterr().out


def test_a_terminal_has_colours_unless_it_wants_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for wish, is_coloured in (("", True), ("1", False)):
        terminal = Terminal()
        monkeypatch.setattr("sys.stdout", terminal)
        monkeypatch.setenv("NO_COLOR", wish)
        show(contents(warning(1)))
        assert (ESCAPE in terminal.text) is is_coloured


def test_equal_findings_are_told_once_and_errors_first(
    capsys: pytest.CaptureFixture[str],
) -> None:
    fault = Finding(severity=Severity.ERROR, message="cannot be")
    show(contents(warning(1), warning(1), fault))
    shown = capsys.readouterr().out
    assert shown.count("finding 1") == 1
    assert shown.index("cannot be") < shown.index("finding 1")


def test_many_findings_are_counted_rather_than_told(capsys: pytest.CaptureFixture[str]) -> None:
    show(contents(*(warning(number) for number in range(MOST_FINDINGS + 7))))
    assert "... and 7 more findings (--json has all)" in capsys.readouterr().out


def test_contents_tell_the_workingsteps_in_order() -> None:
    contents = json.loads(json.dumps(check(PARTS / "bracket.stpnc").record()))
    assert contents["is_usable"] is True
    assert contents["schemas"] == ["MACHINING_SCHEMA", "MILLING_SCHEMA"]
    assert [step["id"] for step in contents["workingsteps"]][:3] == [
        "ROUGH FACE", "FINISH FACE", "ROUGH CONTOUR",
    ]  # fmt: skip


@pytest.fixture
def code(tmp_path: Path) -> Result:
    path = tmp_path / "part.nc"
    path.write_bytes(CODE)
    return stepnc.check(path)


def test_control_tools_feeds_and_what_is_not_understood_are_told(code: Result) -> None:
    shown = str(code)
    assert "fanuc mill (guessed from O0100, G65 P), mm, 14 blocks" in shown
    assert "line 9: not understood: a macro call; --keeps-state P9100 if it" in shown
    assert "rewriting without advice gives the file byte for byte" in shown


def test_json_counts_moves_by_tool_and_kind(code: Result) -> None:
    found = json.loads(json.dumps(code.record()))
    lines = next(each for each in found["moves"] if each["kind"] == "line")
    assert (lines["tool"], lines["least_feed_mm_min"], lines["greatest_feed_mm_min"]) == (
        3,
        50.0,
        300.0,
    )
    assert lines["advisable"] >= 2
    assert found["is_lossless"] is True
    assert next(each["line"] for each in found["findings"]) == 9
