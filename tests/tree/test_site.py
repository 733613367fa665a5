"""Settings of the site, its target in the Makefile, and the size of the README."""

import re

from docs.hooks.site import WHEN_THERE
from tests.docs.pages import ROOT


def test_the_readme_is_one_screen() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 66


def test_pages_that_may_be_missing_are_in_the_navigation_of_the_settings() -> None:
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    settings = ("  font: false", "strict: true")
    assert [each for each in settings if each not in text.splitlines()] == []
    assert [name for name in WHEN_THERE if f": {name}\n" not in text] == []


def test_make_docs_builds_it() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    rules = (r"^docs: \$\(TESTS_READY\)\n.*mkdocs build --strict", r"^\t@echo \"make docs  ")
    assert [rule for rule in rules if not re.search(rule, makefile, flags=re.M)] == []
