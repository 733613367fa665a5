"""Tables on a terminal: data to stdout, colours only where they are wanted."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from service import chosen
from service.cli.verbs import print_result
from service.contents import Contents, check
from service.contents_output import print_contents
from service.library_output import print_entries, print_entry
from service.rendering.text import MOST_FINDINGS
from service.verbs.optimise import program as advising
from simulator.library import load_machine
from simulator.machine_file import machine_toml
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from stepnc_model.errors import Finding, Severity
from tests.asking import asked_advice

PARTS = Path(__file__).parents[4] / "examples" / "parts"
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
    request = asked_advice(file=PARTS / "paper002.stpnc", machine="paper002", dry_run=True)
    print_result(advising.advise_program(*request))
    shown, told = capsys.readouterr()
    assert "123.8 -> 290.0" in shown
    assert "618.9" in shown
    assert "motor power 0.29 kW reaches its bound of 0.29 kW" in shown
    assert not told


def test_columns_of_a_plan_are_aligned(capsys: pytest.CaptureFixture[str]) -> None:
    request = asked_advice(file=PARTS / "bracket.stpnc", dry_run=True)
    print_result(advising.advise_program(*request))
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
    assert shown.endswith("  advice: yes\n")


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


MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="END MILL 20MM",
    direction=ModeDirection.XY,
    natural_frequency=1_150.0,
    damping_ratio=0.03,
    stiffness=5_000.0,
    source="tap test",
)


def test_a_plan_tells_what_is_stable_or_why_that_is_not_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = tmp_path / "tapped.toml"
    text = machine_toml(replace(load_machine("vmc15"), modes=(MODE,)))
    machine.write_text(text, encoding="utf-8")
    request = asked_advice(
        file=PARTS / "bracket.stpnc",
        machine=str(machine),
        material="al7075",
        free="feed,depth,speed",
        workingsteps=("ROUGH CONTOUR", "FINISH CONTOUR", "MILL SLOT"),
        dry_run=True,
    )
    print_result(advising.advise_program(*request))
    lines = capsys.readouterr().out.splitlines()
    (bounded,) = (line for line in lines if line.startswith("  ROUGH CONTOUR: "))
    (thin,) = (line for line in lines if line.startswith("  FINISH CONTOUR: "))
    (unknown,) = (line for line in lines if line.startswith("  MILL SLOT: "))
    assert re.search(
        r"; stable to \S+ mm at this speed, \S+ mm at any \(1 measured mode\)", bounded
    )
    assert re.search(r"stability not bounded: a_e/D \S+ is below 0\.1, where the zero", thin)
    assert "stab" not in unknown
    notes = [line for line in lines if "no modes are measured" in line]
    assert len(notes) == 1
    assert "'END MILL 12MM'" in notes[0]


def test_a_machine_shows_its_measured_modes(capsys: pytest.CaptureFixture[str]) -> None:
    work = replace(MODE, part=VibratingPart.WORKPIECE, tool="", direction=ModeDirection.X)
    wide = replace(MODE, tool="", tool_diameter=12.0)
    print_entry(replace(load_machine("vmc15"), modes=(MODE, work, wide)))
    shown = capsys.readouterr().out
    assert re.search(
        r"mode of tool END MILL 20MM along xy +1150 Hz, damping 0\.03, 5 N/µm", shown
    )
    assert "mode of workpiece along x " in shown
    assert "mode of tool 12 mm along xy " in shown
