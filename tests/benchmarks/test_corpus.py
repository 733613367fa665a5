"""The table of programs and commands."""

from pathlib import Path

import pytest

from benchmarks.corpus import AFTER, BEFORE, OPTIMISE, Entry, entry, main, table

PARTS = Path(__file__).parents[2] / "examples" / "parts"
CHECK, TOOLPATH = BEFORE
POST = AFTER[0]


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A program that works."""
    path = tmp_path / "part.stpnc"
    path.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    return path


def without_feed(part: Path) -> None:
    """Take the feed out of a program."""
    text = part.read_text(encoding="ascii")
    place = text.index("=MILLING_TECHNOLOGY(")
    begin = place + len("=MILLING_TECHNOLOGY(")
    values = text[begin : text.index(")", begin)].split(",")
    assert values[0] == "$"
    values[4] = "$"
    end = text.index(")", begin)
    part.write_text(text[:begin] + ",".join(values) + text[end:], encoding="ascii")


def test_what_works_needs_no_option(part: Path) -> None:
    assert entry(part, CHECK) == Entry(works=True)
    assert entry(part, POST) == Entry(works=True)


def test_a_refusal_is_kept_with_the_option_that_helps(part: Path) -> None:
    without_feed(part)
    assert entry(part, TOOLPATH).works
    refused = entry(part, POST)
    assert not refused.works
    assert "MILLING_TECHNOLOGY.feedrate: neither feedrate nor" in refused.error
    helped = entry(part, OPTIMISE)
    assert helped.works
    assert helped.options == ("--feed", "240")
    assert helped.error == refused.error


def test_a_refusal_is_printed_once_with_its_number() -> None:
    rows = {
        "a.stp": {"check": Entry(works=True), "post": Entry(works=False, error="no feed")},
        "b.stp": {
            "check": Entry(works=True, options=("--units", "auto"), error="too fast"),
            "post": Entry(works=True, left=2, is_after=True, error="no feed"),
        },
    }
    assert table(rows).splitlines() == [
        "| program | check | post |",
        "|---|---|---|",
        "| a.stp | yes | no (1) |",
        "| b.stp | yes with `--units auto` (2) | after `optimise`, 2 left out (3) |",
        "",
        "1. a.stp: no feed",
        "2. b.stp: too fast",
        "3. b.stp: no feed",
    ]


def test_a_folder_without_programs_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main([str(tmp_path)])
    assert capsys.readouterr().out == "no program in these folders: nothing to print\n"
