"""Every file that the overview names is there."""

import re
from collections.abc import Iterator

from benchmarks.house import PRODUCT, ROOT

PAGE = ROOT / "docs" / "overview.md"


def named() -> Iterator[str]:
    """Files and folders; a bare file lies in the folder that its paragraph named last."""
    folder = ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if re.match(r"[*#|]|$", line):
            folder = ""
        for word in re.findall(r"`([^`\s]+)`", line):
            if word.split("/")[0] in PRODUCT:
                yield word
                folder = word.rpartition("/")[0] if word.endswith(".py") else word
            elif word.endswith(".py"):
                yield f"{folder}/{word}" if folder else word


def test_files_of_the_overview_are_there() -> None:
    assert [file for file in sorted(set(named())) if not (ROOT / file).exists()] == []


def test_the_overview_passes_every_room() -> None:
    rooms = {file.split("/")[0] for file in named()}
    assert [room for room in PRODUCT if room not in rooms and (ROOT / room).is_dir()] == []


def test_contributing_points_to_the_overview() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert "docs/overview.md" in text
