"""Regular expressions mean the same on every Python that the project runs on."""

import re

from tests.tree.sources import modules


def test_no_group_is_possessive() -> None:
    """CPython before 3.11.5 mismatches ``(?:…)*+`` (gh-106052); ``(?>(?:…)*)`` is right."""
    lines = [(module, line) for module, text in modules().items() for line in text.splitlines()]
    found = [each for each in lines if re.search(r"(?<!\\)\)[*+?]\+", each[1])]
    assert [each for each in found if "``(?:…)*+``" not in each[1]] == []
