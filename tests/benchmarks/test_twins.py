"""Two programs of the same part are compared by one command."""

from pathlib import Path

import pytest

import stepnc
from benchmarks.twins import ONE, OTHER, comparison, main

PART = Path("examples/parts/bracket.stpnc")
SLOT = PART.with_name("paper003_case1.stpnc")


def test_a_program_and_its_conversion_have_the_same_paths(tmp_path: Path) -> None:
    other = tmp_path / "slot.238"
    stepnc.convert(SLOT, to="ap238", output=other)
    lines = list(comparison(SLOT, other))
    steps = lines[2 : lines.index("")]
    assert len(steps) == 1
    assert all(line.endswith(" moves | same |") for line in steps)
    data = lines[lines.index("") + 3 : -1]
    assert not [line for line in data if "TECHNOLOGY" in line or "feed, speed" in line]


def test_what_differs_is_printed(tmp_path: Path) -> None:
    other = tmp_path / "other.stpnc"
    text = PART.read_text("utf-8")
    for old, new in (
        ("'REAM HOLE 1',#43", "'REAM',#43"),
        ("#172=CARTESIAN_POINT('',(127.,65.,0.))", "#172=CARTESIAN_POINT('',(127.,65.5,0.))"),
        ("2.33333333333333,$,0.1,", "2.33333333333333,$,0.12,"),
    ):
        assert old in text, old
        text = text.replace(old, new)
    other.write_text(text, "utf-8")
    lines = list(comparison(PART, other))
    assert "| REAM HOLE 1 | | missing | |" in lines
    assert "| MILLING_TECHNOLOGY.feedrate_per_tooth | 0.1 | 0.12 |" in lines
    moved = [line for line in lines if line.endswith("| 0.5 |")]
    assert [line.split(" | ")[0] for line in moved] == [
        "| CENTRE HOLE 2",
        "| DRILL HOLE 2",
        "| REAM HOLE 2",
    ]


def test_the_public_twins_differ_as_the_documentation_says(
    capsys: pytest.CaptureFixture[str],
) -> None:
    if not (ONE.is_file() and OTHER.is_file()):
        pytest.skip("the public programs are not here")
    main([])
    told = capsys.readouterr().out
    assert "| PLANE_FINISH_MILLING.overcut_length | not given | 5.0 |" in told
    assert "| MILLING_TECHNOLOGY.inhibit_feedrate_override | False | True |" in told
    refusal = "neither feedrate nor feedrate_per_tooth is given (ISO 14649-11 WR2)"
    [row] = [line for line in told.splitlines() if refusal in line]
    assert row.endswith("| both |")


def test_one_program_is_not_compared(capsys: pytest.CaptureFixture[str]) -> None:
    main([str(PART)])
    assert capsys.readouterr().out == "two programs are needed: nothing to print\n"
