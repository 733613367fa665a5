"""Record of a story: exit codes, outputs and files of its commands, and its comparison.

``python -m tests.golden.record [STORY ...]`` writes the records anew; without names, all.
A long file is recorded by its number of lines, the checksum of its words and its numbers' sum.
"""

import contextlib
import io
import json
import os
import re
import shutil
import sys
import tempfile
import zlib
from base64 import b64decode
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from math import fsum, isclose
from pathlib import Path

import numpy as np

from kbe.rows import OUTCOME
from service.cli.main import main
from tests.golden.stories import CODE, EXAMPLES, PARTS, STORIES, TOOLS
from tests.service.shop import shop

RECORDS = Path(__file__).parent / "records"

LONGEST = 4000
"""Number of characters up to which a text is recorded whole."""

RELATIVE = 1e-6
"""Relative difference of equal numbers, beside one unit of the last digit."""

FADING = dict.fromkeys(("closed_loop", "evaluation", "knowledge"), 1e-5)
"""The same where numbers are learned: they fade with the age of runs, by 1e-6 in a minute."""

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w])")

ARRAY = re.compile(r'"dtype":"(\w+)","bdata":"([^"]*)"')
"""Array of a figure in a page."""

CHANGING = (
    (re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(Z|\+00:00)?"), "<time>"),
    (re.compile(r"\b01[0-9a-hjkmnp-tv-z]{24}\b", re.IGNORECASE), "<id>"),
    (re.compile(r"\b[0-9a-f]{32,}\b"), "<digest>"),
    (re.compile(r"\bstepnc_[0-9a-z]{26}_[0-9a-f]{64}\b"), "<key>"),
    (re.compile(r"\b\d{4}-\d\d-\d\d\b"), "<day>"),
    (re.compile(r"\b\d+\.\d+ times real time"), "<rate> times real time"),
)
"""What differs between two runs of a command."""

PASSING = re.compile(
    r"^(\r?\[[#-]{20}\]|compiling |\d+ of \d+ workingsteps|\s*\d+ % ).*$\n?", re.MULTILINE
)
"""Lines that depend on the time: progress, and kernels that are compiled."""


def recorded(story: str) -> str:
    """Run the commands of a story in a new folder and return their record."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for part in PARTS:
            shutil.copy(EXAMPLES / "parts" / f"{part}.stpnc", folder)
        Path("plate.nc").write_text(CODE, encoding="ascii")
        Path("plate.csv").write_text(TOOLS, encoding="ascii")
        Path("outcomes.json").write_text(_outcomes(), encoding="utf-8")
        return "".join(_ran(words) for words in STORIES[story])


def _outcomes() -> str:
    """Runs of a shop until now: what is learned from them depends on their age."""
    runs = list(shop(30))
    age = datetime.now(UTC) - max(each.recorded_at for each in runs)
    now = [replace(each, recorded_at=each.recorded_at + age) for each in runs]
    return json.dumps([OUTCOME.row(each) for each in now], default=str)


def _ran(words: Sequence[str]) -> str:
    """Record of one command."""
    before = _files()
    out, told = io.StringIO(), io.StringIO()
    code: object = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(told):
        try:
            main(list(words))
        except SystemExit as end:
            code = end.code
    written = {name: data for name, data in _files().items() if before.get(name) != data}
    return "\n".join([
        f"$ {' '.join(words)}",
        f"[exit {code}]",
        _shown(out.getvalue()),
        "[told]",
        _shown(told.getvalue()),
        *(f"[file {name}]\n{_shown(text)}" for name, text in sorted(written.items())),
        "",
    ])


def _files() -> dict[str, str]:
    """Texts of the files in this folder; of binary ones, nothing."""
    found = {}
    for path in Path().rglob("*"):
        # A database that is still open has files beside it, until it is closed.
        if path.is_file() and not path.name.endswith(("-shm", "-wal")):
            is_binary = b"\0" in (data := path.read_bytes())
            found[str(path)] = "" if is_binary else data.decode("utf-8", errors="replace")
    return found


def _shown(text: str) -> str:
    """Text without what differs between runs; a long one in short."""
    text = PASSING.sub("", text.replace(f"{os.getcwd()}/", "").replace("\r", ""))
    text = ARRAY.sub(_array, text)
    for pattern, word in CHANGING:
        text = pattern.sub(word, text)
    if len(text) <= LONGEST:
        return text
    numbers = [float(each) for each in NUMBER.findall(text)]
    words = zlib.crc32(NUMBER.sub("#", text).encode())
    total = fsum(abs(each) for each in numbers if abs(each) < 1e12)
    lines = text.count("\n")
    digest = f"{lines} lines, words {words:08x}, {len(numbers)} numbers of {total:.9g}"
    return f"{text[:400]}\n[{digest}]"


def _array(found: re.Match[str]) -> str:
    """Size and sum of an array, whose last bits differ between processors."""
    data = b64decode(json.loads(f'"{found[2]}"'))
    values = np.frombuffer(data, dtype=found[1]).astype(np.float64)
    total = np.abs(values[np.isfinite(values)]).sum()
    return f'"size":{values.size},"sum":{total:.9g}'


def differences(old: str, new: str, relative: float = RELATIVE) -> Iterator[str]:
    """Lines of a record that differ by more than rounding."""
    before, after = old.splitlines(), new.splitlines()
    for number, (one, other) in enumerate(zip(before, after, strict=False), 1):
        if not _is_same(one, other, relative):
            yield f"line {number}: was {one!r}, is {other!r}"
    if len(before) != len(after):
        yield f"{len(after)} lines instead of {len(before)}"


def _is_same(one: str, other: str, relative: float) -> bool:
    if one == other:
        return True
    if NUMBER.sub("#", one).split() != NUMBER.sub("#", other).split():
        return False
    numbers = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return all(_is_near(a, b, relative) for a, b in numbers)


def _is_near(one: str, other: str, relative: float) -> bool:
    """True if two printed numbers differ by rounding alone."""
    digits = len(one.partition(".")[2]) if "e" not in one.lower() else 0
    step = 1.001 * 10.0**-digits if "." in one else 0.0
    return isclose(float(one), float(other), rel_tol=relative, abs_tol=step)


if __name__ == "__main__":
    RECORDS.mkdir(exist_ok=True)
    for name in sys.argv[1:] or STORIES:
        (RECORDS / f"{name}.txt").write_text(recorded(name), encoding="utf-8")
