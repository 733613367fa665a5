"""Hooks of mkdocs: generated pages and navigation.

Pages are made in memory; none is under version control. A page of ``mkdocs.yml`` that does not
exist is left out of the navigation if it is named in ``WHEN_THERE``, and an error otherwise.
"""

import re
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from docs.hooks import rest_page
from docs.hooks.command_page import command_page
from docs.hooks.decision_pages import INDEX, decision_files, decision_page
from docs.hooks.entity_page import entity_page
from docs.hooks.error_page import error_page
from docs.hooks.file_page import file_page, schemas

ROOT = Path(__file__).parents[2]
REST = "reference/rest.md"
DECISIONS = "decisions/"
"""stands in the navigation of ``mkdocs.yml`` for the list of all of them"""

WHEN_THERE = {REST, "service.md"}

OTHER_HOSTS = re.compile(r"https?://(?:unpkg\.com|cdn\.jsdelivr\.net|fonts\.g[a-z]+\.com)/")
"""from which the theme's script would fetch diagrams and substitutes for old browsers"""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Complete the navigation."""
    docs = Path(config.docs_dir)
    made = set(makers(docs))
    config.nav = [
        each for entry in config.nav or [] for each in _completed(entry, docs=docs, made=made)
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made, and the schemas that one of them links."""
    made = {name: make() for name, make in makers(Path(config.docs_dir)).items()}
    made |= {f"reference/{name}": text for name, text in schemas().items()}
    for name, content in made.items():
        files.append(File.generated(config, name, content=content))
    return files


def on_post_build(config: MkDocsConfig) -> None:
    """Take addresses of other hosts out of the theme's scripts, so that none is asked.

    Its stemmers for other languages, which no page uses, go as a whole.
    """
    shutil.rmtree(Path(config.site_dir) / "assets" / "javascripts" / "lunr", ignore_errors=True)
    for path in Path(config.site_dir).rglob("*.js"):
        text = path.read_text(encoding="utf-8")
        local = OTHER_HOSTS.sub("", text)
        if local != text:
            path.write_text(local, encoding="utf-8")


def makers(docs: Path) -> dict[str, Callable[[], str]]:
    """Functions that make a page, by the name of the page in the site."""
    found: dict[str, Callable[[], str]] = {
        "reference/commands.md": command_page,
        "reference/entities.md": partial(entity_page, ROOT),
        "reference/errors.md": partial(error_page, ROOT),
        "reference/files.md": file_page,
        "changelog.md": partial((ROOT / "CHANGELOG.md").read_text, encoding="utf-8"),
        INDEX: partial(decision_page, docs),
    }
    document = rest_page.openapi_document()
    if document is not None:
        found[REST] = partial(rest_page.rest_page, document)
    return found


def _completed(entry: Any, *, docs: Path, made: set[str]) -> list[Any]:
    """An entry of the navigation with the decisions in it, and without what is not there."""
    if isinstance(entry, str):
        if entry == DECISIONS:
            return [{"All decisions": INDEX}, *decision_files(docs)]
        is_there = entry not in WHEN_THERE or entry in made or (docs / entry).exists()
        return [entry] if is_there else []
    ((title, below),) = entry.items()
    if isinstance(below, str):
        found = _completed(below, docs=docs, made=made)
        return [{title: found if below == DECISIONS else below}] if found else []
    return [{title: [one for each in below for one in _completed(each, docs=docs, made=made)]}]
