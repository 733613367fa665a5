"""Every file that a walk names is there."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "walks.md"
PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service")


def named() -> Iterator[str]:
    """Files and folders; a bare file lies in the folder named last before it in its step."""
    folder = ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if re.match(r"\d+\. |#", line):
            folder = ""
        for word in re.findall(r"`([^`\s]+)`", line):
            if word.split("/")[0] in PACKAGES:
                yield word
                folder = word.rpartition("/")[0] if word.endswith(".py") else word
            elif word.endswith(".py"):
                yield f"{folder}/{word}" if folder else word


@pytest.mark.parametrize("file", sorted(set(named())))
def test_the_file_is_there(file: str) -> None:
    assert (ROOT / file).exists()


def test_every_walk_names_its_files() -> None:
    walks = PAGE.read_text(encoding="utf-8").split("\n## ")[1:]
    assert len(walks) >= 5
    assert all(walk.count(".py`") >= 5 for walk in walks)


def test_contributing_points_to_the_walks() -> None:
    assert "docs/walks.md" in (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
