"""Every file that a walk names is there."""

import re
from collections.abc import Iterator

from benchmarks.house import PRODUCT, ROOT

PAGE = ROOT / "docs" / "walks.md"


def named() -> Iterator[str]:
    """Files and folders; a bare file lies in the folder named last before it in its step."""
    folder = ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if re.match(r"\d+\. |#", line):
            folder = ""
        for word in re.findall(r"`([^`\s]+)`", line):
            if word.split("/")[0] in PRODUCT:
                yield word
                folder = word.rpartition("/")[0] if word.endswith(".py") else word
            elif word.endswith(".py"):
                yield f"{folder}/{word}" if folder else word


def test_files_of_walks_are_there() -> None:
    assert [file for file in sorted(set(named())) if not (ROOT / file).exists()] == []


def test_every_walk_names_its_files() -> None:
    walks = PAGE.read_text(encoding="utf-8").split("\n## ")[1:]
    assert len(walks) >= 5
    assert [walk.splitlines()[0] for walk in walks if walk.count(".py`") < 5] == []


def test_contributing_points_to_the_walks() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert [page for page in ("docs/walks.md",) if page not in text] == []
