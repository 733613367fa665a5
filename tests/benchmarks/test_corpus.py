"""The table of programs and commands."""

import re
from pathlib import Path

import pytest

from benchmarks.corpus import (
    AFTER,
    BEFORE,
    FOLDERS,
    OPTIMISE,
    Entry,
    attempt,
    entry,
    main,
    programs,
    table,
)

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
    assert (
        "MILLING_TECHNOLOGY.feedrate: neither feedrate nor"
        in attempt(part, POST, (), output=None).error
    )
    for command in (POST, OPTIMISE):
        helped = entry(part, command)
        assert helped.works
        assert helped.options == ("--feed", "240")
        assert "MILLING_TECHNOLOGY.feedrate: neither feedrate nor" in helped.error


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


PLACE = re.compile(r"line \d+: #\d+ \w+")
OPTION = re.compile(
    r" --(set|teeth|stock|feed|units|keep-going|machine|material|part)\b",
)
SIMULATE = AFTER[1]
REFUSING = (SIMULATE, OPTIMISE)


def refusals(program: Path) -> dict[str, str]:
    """First refusal of each command; what `post` takes would only take long."""
    tried = {POST.name: attempt(program, POST, (), output=None)}
    if not tried[POST.name].error:
        return {}
    tried |= {each.name: attempt(program, each, (), output=None) for each in REFUSING}
    return {name: each.error for name, each in tried.items() if each.error}


@pytest.mark.parametrize(
    "program", [each for folder in FOLDERS for each in programs(folder)], ids=lambda p: p.name
)
def test_each_refusal_names_a_place_and_the_option_that_helps(program: Path) -> None:
    found = refusals(program)
    for command, text in found.items():
        assert OPTION.search(text), f"{command}: {text}"
        # A material that no instance names has no place.
        assert PLACE.search(text) or "names no workpiece material" in text, f"{command}: {text}"


def test_what_has_no_tool_path_is_refused_so_too() -> None:
    for program in (FOLDERS[0] / "testePrecedencias.p21", FOLDERS[0] / "nine_workingsteps.p21"):
        if not program.exists():
            pytest.skip(f"{program.name} is not beside the project")
        refused = attempt(program, TOOLPATH, (), output=None).error
        assert PLACE.search(refused)
        assert OPTION.search(refused)


def test_a_program_without_a_feed_is_refused_by_all(part: Path) -> None:
    """The test above does not only pass because nothing is refused."""
    without_feed(part)
    found = refusals(part)
    assert set(found) == {"post", "simulate", "optimise"}
    assert all("; --feed gives one" in text for text in found.values())
