"""Pages of the documentation as the tests read them: fenced blocks, and commands in them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
PROMPT = "$ "
LEFT_OUT = "..."


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """One fenced block."""

    language: str
    text: str
    line: int
    """of the page, counted from 1"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """One command and what the page shows of its standard output."""

    words: str
    shown: str


def section(text: str, title: str) -> str:
    """Section of a page with a title, which must be there."""
    found = re.search(
        rf"^## {re.escape(title)}(?: \{{.*\}})?\n.*?(?=^## |\Z)", text, flags=re.S | re.M
    )
    assert found is not None, title
    return found[0]


def name_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def blocks(text: str) -> Iterator[Block]:
    """Fenced blocks of a page, in order."""
    for found in re.finditer(r"^```(\w*)\n(.*?)^```$", text, flags=re.DOTALL | re.MULTILINE):
        line = text.count("\n", 0, found.start()) + 1
        yield Block(language=found[1], text=found[2], line=line)


def commands(block: Block) -> list[Command]:
    """Commands of a console block; a command ends where its line has no backslash."""
    found: list[tuple[list[str], list[str]]] = []
    is_open = False
    for line in block.text.splitlines():
        if line.startswith(PROMPT):
            found.append(([line.removeprefix(PROMPT)], []))
        elif is_open:
            found[-1][0].append(line)
        else:
            assert found, f"line {block.line}: output before the first command"
            found[-1][1].append(line)
        is_open = (is_open or line.startswith(PROMPT)) and line.endswith("\\")
    return [Command(words="\n".join(words), shown="\n".join(lines)) for words, lines in found]


def pattern_of(shown: str) -> re.Pattern[str]:
    """What output looks like: ``...`` alone on a line is any lines, elsewhere any text."""
    lines = []
    for line in shown.splitlines():
        if line.strip() == LEFT_OUT:
            lines.append(r"(?:.*\n)*?")
        else:
            lines.append(".*?".join(re.escape(part) for part in line.rstrip().split(LEFT_OUT)))
            lines.append(r"[ ]*\n")
    return re.compile("".join(lines))


def is_as_shown(printed: str, shown: str) -> bool:
    """Whether a page shows what was printed; a page that shows nothing leaves all out."""
    if not shown:
        return True
    text = printed if printed.endswith("\n") else printed + "\n"
    return pattern_of(shown).fullmatch(text) is not None
