"""Tables on a terminal: data to stdout, colours only where they are wanted."""

from dataclasses import replace
from pathlib import Path

import pytest

from service import chosen, usecases
from service.contents import Contents, check
from service.tables import (
    MOST_FINDINGS,
    print_contents,
    print_entries,
    print_entry,
    print_plan,
)
from stepnc_model.errors import Finding, Severity

PARTS = Path(__file__).parents[2] / "examples" / "parts"
ESCAPE = "\x1b"


class Terminal:
    """Text that claims to be shown on a terminal."""

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> None:
        self.text += text

    def isatty(self) -> bool:
        return True


def contents(*findings: Finding) -> Contents:
    return replace(check(PARTS / "paper002.stpnc"), findings=findings)


def warning(number: int) -> Finding:
    return Finding(severity=Severity.WARNING, message=f"finding {number}")


def test_a_plan_shows_both_feeds_and_the_limit_that_binds(
    capsys: pytest.CaptureFixture[str],
) -> None:
    request = usecases.Request(file=PARTS / "paper002.stpnc", machine="paper002", dry_run=True)
    print_plan(usecases.optimise(request).plan)
    shown, told = capsys.readouterr()
    assert "123.8 -> 290.0" in shown
    assert "618.9" in shown
    assert "motor power 0.29 kW reaches its bound of 0.29 kW" in shown
    assert not told


def test_columns_of_a_plan_are_aligned(capsys: pytest.CaptureFixture[str]) -> None:
    request = usecases.Request(file=PARTS / "bracket.stpnc", dry_run=True)
    print_plan(usecases.optimise(request).plan)
    lines = capsys.readouterr().out.splitlines()
    header = next(line for line in lines if line.startswith("workingstep"))
    rule = lines[lines.index(header) + 1]
    assert set(rule) == {"-", " "}
    for name in ("operation", "tool", "rpm"):
        assert rule[header.index(name) - 1 : header.index(name) + 1] == " -"


def test_contents_show_the_tree_and_whether_it_is_usable(
    capsys: pytest.CaptureFixture[str],
) -> None:
    print_contents(check(PARTS / "bracket.stpnc"))
    shown = capsys.readouterr().out
    assert "workplan" in shown
    assert "REAM HOLE 2" in shown
    assert shown.endswith("usable\n")


def test_nobody_sees_colours_in_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    print_contents(contents(warning(1)))
    assert ESCAPE not in capsys.readouterr().out


def test_a_terminal_has_colours_unless_it_wants_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for wish, is_coloured in (("", True), ("1", False)):
        terminal = Terminal()
        monkeypatch.setattr("sys.stdout", terminal)
        monkeypatch.setenv("NO_COLOR", wish)
        print_contents(contents(warning(1)))
        assert (ESCAPE in terminal.text) is is_coloured


def test_equal_findings_are_told_once_and_errors_first(
    capsys: pytest.CaptureFixture[str],
) -> None:
    fault = Finding(severity=Severity.ERROR, message="cannot be")
    print_contents(contents(warning(1), warning(1), fault))
    shown = capsys.readouterr().out
    assert shown.count("finding 1") == 1
    assert shown.index("cannot be") < shown.index("finding 1")


def test_many_findings_are_counted_rather_than_told(capsys: pytest.CaptureFixture[str]) -> None:
    print_contents(contents(*(warning(number) for number in range(MOST_FINDINGS + 7))))
    assert "... and 7 more findings (--json has all)" in capsys.readouterr().out


@pytest.mark.parametrize("kind", ["machines", "materials"])
def test_a_library_is_a_row_an_entry(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    entries = chosen.library_entries(kind)
    print_entries(kind, entries)
    rows = capsys.readouterr().out.splitlines()[2:]
    assert [row.split()[0] for row in rows] == [entry.name for entry in entries]


@pytest.mark.parametrize(("kind", "name"), [("machines", "vmc15"), ("materials", "c45")])
def test_an_entry_tells_its_source(
    kind: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    print_entry(chosen.library_entry(kind, name))
    shown = capsys.readouterr().out
    assert shown.startswith(f"{name}: ")
    assert "\nsource: " in shown
