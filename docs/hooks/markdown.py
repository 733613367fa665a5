"""Markdown out of values: tables, code, links, and what must be escaped in them."""

from collections.abc import Iterable, Sequence


def cell(text: str) -> str:
    """Text of a cell: on one line, with no bar that would end it and no tag."""
    line = " ".join(text.split())
    return line.replace("|", "\\|").replace("<", "&lt;")


def code(text: str) -> str:
    """Code within a line; empty text stays empty."""
    return f"`{text}`" if text else ""


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; cells are made ready here."""
    lines = [
        "| " + " | ".join(heads) + " |",
        "|" + "---|" * len(heads),
        *("| " + " | ".join(cell(each) for each in row) + " |" for row in rows),
    ]
    return "\n".join(lines)


def block(text: str, language: str = "text") -> str:
    """A fenced block."""
    return f"```{language}\n{text.rstrip()}\n```"


def first_line(docstring: str | None) -> str:
    """First sentence of a docstring, that of the summary line."""
    return (docstring or "").strip().split("\n\n")[0].replace("\n", " ").strip()


def page(title: str, parts: Iterable[str]) -> str:
    """A page of parts, one empty line between them."""
    return "\n\n".join([f"# {title}", *(part for part in parts if part)]) + "\n"
