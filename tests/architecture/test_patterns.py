"""Regular expressions mean the same on every Python that the project runs on."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = sorted(
    path
    for package in ("stepnc_model", "simulator", "optimiser", "service")
    for path in (ROOT / package).rglob("*.py")
)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_group_is_possessive(path: Path) -> None:
    """CPython before 3.11.5 mismatches ``(?:…)*+`` (gh-106052); ``(?>(?:…)*)`` is right."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = [line for line in lines if re.search(r"(?<!\\)\)[*+?]\+", line)]
    assert [line for line in found if "``(?:…)*+``" not in line] == []
