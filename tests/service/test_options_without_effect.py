"""Options that can do nothing for a program are refused, or said to do nothing."""

from pathlib import Path

import pytest

from benchmarks.end_to_end import run

PAPER = Path(__file__).parents[2] / "examples" / "parts" / "paper002.stpnc"

TABLE = "number,id,kind,diameter_mm,teeth\n1,{name},endmill,18,4\n"


def advised(*options: str | Path) -> tuple[int, str]:
    done = run("optimise", PAPER, "--dry-run", *options)
    return done.code, done.told + done.out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--feed", "240"), "--feed 240 has no effect: each technology gives a feed"),
        (("-o", "other.stpnc"), "--dry-run: other.stpnc is not written"),
        (
            ("--set", "#40.axial_cutting_depth=99"),
            "a depth of 99 mm is more than there is: one pass of 3 mm",
        ),
    ],
)
def test_what_has_no_effect_is_said(options: tuple[str, ...], words: str) -> None:
    code, told = advised(*options)
    assert code == 0
    assert words in told


@pytest.mark.parametrize(("name", "is_said"), [("NOSUCH", True), ("MILL 18MM", False)])
def test_a_table_without_the_program_s_tools_is_said(
    name: str, is_said: bool, tmp_path: Path
) -> None:
    table = tmp_path / "tools.csv"
    table.write_text(TABLE.format(name=name), encoding="utf-8")
    code, told = advised("--tools", table)
    assert code == 0
    assert ("--tools has no effect: the program has tools 'MILL 18MM'" in told) == is_said


def test_exact_stops_need_code() -> None:
    code, told = advised("--exact-path")
    assert code == 3
    assert "needs --nc" in told


@pytest.mark.parametrize("words", [("--material", ""), ("--material=",)])
def test_an_empty_value_is_no_value(words: tuple[str, ...]) -> None:
    code, told = advised(*words)
    assert code == 2
    assert "leave it out, or give its value" in told
