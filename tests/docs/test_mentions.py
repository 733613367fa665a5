"""Commands that a page mentions without running them exist: target, module, command, options.

Not run, and why:

- ``make`` targets and activation of ``.venv``: they make the environment in which tests run;
- ``python -m benchmarks…``: minutes, and their figures are of one machine;
- ``python examples/…``: run, or its parts, in ``tests/examples``;
- ``curl`` and what stands in its blocks: run by ``test_service_page.py`` and
  ``tests/simulator/agent/test_puts.py``;
- commands in the text, ``like this``: fragments, with ``part.stpnc`` for any program.
"""

import argparse
import re
import shlex
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from docs.hooks.command_page import commands as commands_below
from service.cli.commands import parser
from tests.docs.pages import PAGES, ROOT, blocks, name_of

LANGUAGES = {
    "console": "run by test_pages.py",
    "python": "run by test_pages.py",
    "sh": "checked here",
    "text": "no commands",
    "json": "no commands",
    "toml": "no commands",
    "xml": "no commands",
    "express": "no commands",
}
SHELL = {".", "curl", "sha256sum", "cp", "export", "cd", "apt-get", "sudo", "pip", "docker"}
"""first words that belong to the shell or to other programs"""

FIRST = ("make", "python", "stepnc", "optimise")


def lines_of(page: Path) -> list[str]:
    """Commands of ``sh`` blocks."""
    found: list[str] = []
    for block in blocks(page.read_text(encoding="utf-8")):
        if block.language == "sh" and "curl" not in block.text:
            text = block.text.replace("\\\n", " ")
            found += [line for line in text.splitlines() if line.strip(" #")]
    return [line for line in found if not line.lstrip().startswith("#")]


def mentions(page: Path) -> Iterator[str]:
    """Commands within the text."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    for found in re.findall(r"`([^`\n]+)`", text):
        if re.match(rf"(?:{'|'.join(FIRST)}) [a-z.\-]", found):
            yield found


def checked() -> list[tuple[str, str]]:
    return [
        (name_of(page), line) for page in PAGES for line in (*lines_of(page), *mentions(page))
    ]


@pytest.mark.parametrize(("page", "line"), checked())
def test_what_is_not_run_exists(page: str, line: str) -> None:
    words = [each for each in shlex.split(line, comments=True) if each != "…"]
    match words:
        case ["make", *targets]:
            assert {each for each in targets if "=" not in each} <= make_targets()
        case ["python", "-m", module, *_]:
            assert find_spec(module) is not None
            options = {each for each in words if each.startswith("--")}
            assert all(option in source_of(module) for option in options)
        case ["python", script, *_] if script.endswith(".py"):
            assert (ROOT / script).is_file()
        case ["stepnc" | "optimise", *_]:
            assert_command_exists(words)
        case [first, *_]:
            assert first in SHELL, f"{page}: is this run, or can it be asked for? {line}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_languages_of_blocks_are_known(page: Path) -> None:
    """A block without a language, or with another one, would be run by nobody."""
    used = {block.language for block in blocks(page.read_text(encoding="utf-8"))}
    assert used <= set(LANGUAGES)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_no_command_hides_in_an_indented_block(page: Path) -> None:
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    assert not re.search(rf"^    (?:\$ |(?:{'|'.join(FIRST)}) )", text, flags=re.M)


def make_targets() -> set[str]:
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY: (.*)$", text, flags=re.M)
    assert phony is not None
    return set(phony[1].split())


def source_of(module: str) -> str:
    found = find_spec(module)
    assert found is not None
    assert found.origin is not None
    return Path(found.origin).read_text(encoding="utf-8")


def assert_command_exists(words: list[str]) -> None:
    """The command, its verb, and every option of it; words after them may be anything."""
    if words[0] == "optimise":
        words = ["stepnc", *words]
    known = {each.prog: each for each in commands_below(parser())}
    name = max(
        (" ".join(words[:count]) for count in (2, 3)),
        key=lambda each: (each in known, len(each)),
    )
    verbs = re.fullmatch(r"stepnc kbe ([a-z]+(?:, [a-z]+)*)", " ".join(words))
    if verbs is not None:
        assert {f"stepnc kbe {verb}" for verb in verbs[1].split(", ")} <= set(known)
        return
    assert name in known
    for option in (each for each in words if re.match(r"--?[a-z]", each)):
        assert option.partition("=")[0] in options_of(known[name])


def options_of(command: argparse.ArgumentParser) -> set[str]:
    return set(command._option_string_actions)
