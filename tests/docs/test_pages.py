"""Every command of every page is run, in order, and prints what the page shows.

Commands in ``console`` blocks, and Python in ``python`` blocks, are run page by page, each
page in a folder of its own that has ``examples`` in it. What stands in ``sh`` blocks, or in the
text, is not run; ``tests/tree/test_mentions.py`` asks whether it exists.
"""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from service.cli.main import main, optimise_main
from tests.docs.pages import PAGES, ROOT, Block, Command, blocks, commands, is_as_shown, name_of

OURS = {"stepnc": main, "optimise": optimise_main}
RUN = ("console", "python")

WITH_COMMANDS = [
    page
    for page in PAGES
    if any(block.language in RUN for block in blocks(page.read_text(encoding="utf-8")))
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the examples, and nothing of the user's in the environment."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    for name in ("STEPNC_KB", "COLUMNS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("NO_COLOR", "1")
    programs = Path(sys.executable).parent
    monkeypatch.setenv("PATH", os.pathsep.join([str(programs), os.environ["PATH"]]))
    return tmp_path


@pytest.mark.parametrize("page", WITH_COMMANDS, ids=name_of)
def test_the_page_shows_what_is_printed(page: Path, folder: Path) -> None:
    names: dict[str, object] = {}
    for block in blocks(page.read_text(encoding="utf-8")):
        if block.language == "console":
            for command in commands(block):
                printed = run(command)
                assert is_as_shown(printed, command.shown), (
                    f"{name_of(page)}, block of line {block.line}: {command.words}\n"
                    f"printed:\n{printed}\nshown:\n{command.shown}"
                )
        elif block.language == "python":
            execute(block, names, name_of(page))


def run(command: Command) -> str:
    """Standard output of a command, which must succeed."""
    words = shlex.split(command.words)
    is_plain = not re.search(r"[|;&<>]", command.words)
    if not is_plain or words[0] not in OURS:
        done = subprocess.run(
            command.words, shell=True, check=True, stdout=subprocess.PIPE, timeout=300
        )
        return done.stdout.decode()
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), pytest.raises(SystemExit) as stopped:
        OURS[words[0]](words[1:])
    assert not stopped.value.code, command.words
    return printed.getvalue()


def execute(block: Block, names: dict[str, object], page: str) -> None:
    """Run Python; ``# text`` behind a ``print`` is what it prints."""
    expected = re.findall(r"^print\(.*\)  # (.*)$", block.text, flags=re.MULTILINE)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(block.text, f"{page}:{block.line}", "exec"), names)
    assert printed.getvalue().splitlines() == expected


def test_pages_with_commands_are_found() -> None:
    assert "tutorial.md" in {name_of(page) for page in WITH_COMMANDS}


@pytest.mark.parametrize(
    ("printed", "shown", "is_same"),
    [
        ("one\ntwo\nthree\n", "one\n...\nthree", True),
        ("one\nthree\n", "one\n...\nthree", True),
        ("one\ntwo\nthree\n", "one\n...", True),
        ("one\ntwo\nthree\n", "one\nthree", False),
        ("took 1.5 s\n", "took ... s", True),
        ("took 1.5 s\nmore\n", "took ... s", False),
        ("feed 12.3\n", "feed 12.4", False),
        ("feed 12.34\n", "feed 12.3", False),
        ("wide   \n", "wide", True),
    ],
)
def test_dots_stand_for_what_is_left_out(printed: str, shown: str, is_same: bool) -> None:
    assert is_as_shown(printed, shown) is is_same


def test_a_command_may_go_over_several_lines() -> None:
    block = Block(language="console", text="$ one \\\n  --two\nout\n$ three\n", line=1)
    assert commands(block) == [
        Command(words="one \\\n  --two", shown="out"),
        Command(words="three", shown=""),
    ]
