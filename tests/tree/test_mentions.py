"""Commands that a page mentions without running them exist: target, module, command, options.

Not run, and why:

- ``make`` targets and activation of ``.venv``: they make the environment in which tests run;
- ``python -m benchmarks…``: minutes, and their figures are of one machine;
- ``python examples/…``: run, or its parts, in ``tests/examples``;
- ``curl`` and what stands in its blocks: run by ``tests/docs/test_service_page.py`` and
  ``tests/extras/agent/model/test_puts.py``;
- commands in the text, ``like this``: fragments, with ``part.stpnc`` for any program.
"""

import re
import shlex
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from docs.hooks.command_page import commands as commands_below
from service.cli.commands import parser
from tests.docs.pages import PAGES, ROOT, blocks, name_of

LANGUAGES = {
    "console": "run by tests/docs/test_pages.py",
    "python": "run by tests/docs/test_pages.py",
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


def prose_of(page: Path) -> str:
    """Text of a page without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)


def mentions(page: Path) -> Iterator[str]:
    """Commands within the text."""
    for found in re.findall(r"`([^`\n]+)`", prose_of(page)):
        if re.match(rf"(?:{'|'.join(FIRST)}) [a-z.\-]", found):
            yield found


def exists(line: str) -> bool:
    """Whether a command names only what there is."""
    words = [each for each in shlex.split(line, comments=True) if each != "…"]
    match words:
        case ["make", *targets]:
            return {each for each in targets if "=" not in each} <= make_targets()
        case ["python", "-m", module, *_]:
            text = source_of(module)
            return bool(text) and all(each in text for each in words if each.startswith("--"))
        case ["python", script, *_] if script.endswith(".py"):
            return (ROOT / script).is_file()
        case ["stepnc", *_]:
            return command_exists(words)
        case ["optimise", *_]:
            return command_exists(["stepnc", *words])
        case [first, *_]:
            return first in SHELL
    return True


def test_commands_that_are_not_run_exist() -> None:
    lines = [
        (name_of(page), line) for page in PAGES for line in (*lines_of(page), *mentions(page))
    ]
    assert len(lines) > 100
    assert [each for each in lines if not exists(each[1])] == []


def test_languages_of_blocks_are_known() -> None:
    """A block without a language, or with another one, would be run by nobody."""
    used = [
        (name_of(page), block.line, block.language)
        for page in PAGES
        for block in blocks(page.read_text(encoding="utf-8"))
    ]
    assert [each for each in used if each[2] not in LANGUAGES] == []


def test_no_command_hides_in_an_indented_block() -> None:
    hidden = [
        (name_of(page), line)
        for page in PAGES
        for line in prose_of(page).splitlines()
        if re.match(rf"    (?:\$ |(?:{'|'.join(FIRST)}) )", line)
    ]
    assert hidden == []


@cache
def make_targets() -> set[str]:
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY: (.*)$", text, flags=re.M)
    assert phony is not None
    return set(phony[1].split())


def source_of(module: str) -> str:
    """Text of a module; empty where there is none."""
    found = find_spec(module)
    path = found.origin if found is not None else None
    return Path(path).read_text(encoding="utf-8") if path is not None else ""


def command_exists(words: list[str]) -> bool:
    """The command, its verb, and every option of it; words after them may be anything."""
    verbs = re.fullmatch(r"stepnc kbe ([a-z]+(?:, [a-z]+)*)", " ".join(words))
    if verbs is not None:
        return {f"stepnc kbe {verb}" for verb in verbs[1].split(", ")} <= options().keys()
    names = (" ".join(words[:count]) for count in (3, 2))
    known = next((options()[name] for name in names if name in options()), None)
    given = {word.partition("=")[0] for word in words if re.match(r"--?[a-z]", word)}
    return known is not None and given <= known


@cache
def options() -> dict[str, set[str]]:
    """Options of each command."""
    return {each.prog: set(each._option_string_actions) for each in commands_below(parser())}
