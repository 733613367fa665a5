"""The decisions: their list for the navigation, and a page that says what each one is about."""

from pathlib import Path

from docs.hooks.markdown import page, table

FOLDER = "decisions"
INDEX = f"{FOLDER}/index.md"

INTRODUCTION = """Choices that somebody will question one day, a page each: what was asked,
what was chosen, what was refused, what it costs. A new one is a file
`docs/decisions/NNNN-title.md`; it appears here by itself."""


def decision_files(docs: Path) -> list[str]:
    """Pages in the order of their numbers, as the site names them."""
    return [f"{FOLDER}/{path.name}" for path in sorted((docs / FOLDER).glob("[0-9]*.md"))]


def decision_page(docs: Path) -> str:
    """The list of all decisions."""
    rows = []
    for name in decision_files(docs):
        number, title = _title(docs / name)
        rows.append((f"[{number}]({Path(name).name})", title))
    return page("Decisions", [INTRODUCTION, table(("no.", "decision"), rows)])


def _title(path: Path) -> tuple[str, str]:
    """Number and title, from the heading."""
    heading = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
    number, _, title = heading.partition(" ")
    return number, title
