"""LinuxCNC's interpreter and the samples of its package, and programs of several origins."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from stepnc_model.units import mm_from_inches
from tests.stepnc_model.post.conftest import PLACE, interpreter_in

SAMPLES = PLACE / "usr" / "share" / "linuxcnc" / "ncfiles"
COMMAND = re.compile(r"\s*\d+\s+N\S*\s+([A-Z_0-9]+)\((.*)\)")
AXES = {"CANON_PLANE_XY": (0, 1, 2), "CANON_PLANE_XZ": (2, 0, 1), "CANON_PLANE_YZ": (1, 2, 0)}


@dataclass(frozen=True, slots=True)
class CanonicalMove:
    """Move as LinuxCNC executes it."""

    name: str
    end: tuple[float, float, float]
    feed: float
    """mm/min"""
    centre: tuple[float, float] | None = None
    axes: tuple[int, int, int] = (0, 1, 2)
    rotation: int = 0


Oracle = Callable[[bytes], list[CanonicalMove]]


def moves_of(text: str) -> list[CanonicalMove]:
    """Moves of canonical commands, in mm."""
    moves: list[CanonicalMove] = []
    unit, feed, axes = 1.0, 0.0, (0, 1, 2)
    for line in text.splitlines():
        found = COMMAND.match(line)
        if found is None:
            continue
        name, words = found[1], [word.strip() for word in found[2].split(",")]
        if name == "USE_LENGTH_UNITS":
            unit = mm_from_inches(1.0) if "INCH" in words[0] else 1.0
        elif name == "SELECT_PLANE":
            axes = AXES[words[0]]
        elif name == "SET_FEED_RATE":
            feed = float(words[0]) * unit
        elif name in {"STRAIGHT_TRAVERSE", "STRAIGHT_FEED"}:
            x, y, z = (float(word) * unit for word in words[:3])
            moves.append(CanonicalMove(name, (x, y, z), feed))
        elif name == "ARC_FEED":
            u, v, p, q, w = (float(words[i]) * unit for i in (0, 1, 2, 3, 5))
            end = [0.0, 0.0, 0.0]
            end[axes[0]], end[axes[1]], end[axes[2]] = u, v, w
            turns = int(float(words[4]))
            moves.append(
                CanonicalMove(name, (end[0], end[1], end[2]), feed, (p, q), axes, turns)
            )
    return moves


@pytest.fixture(scope="session")
def linuxcnc(tmp_path_factory: pytest.TempPathFactory) -> Oracle:
    """LinuxCNC's interpreter: bytes in, moves out."""
    interpret = interpreter_in(tmp_path_factory.mktemp("rs274_nc"))
    return lambda data: moves_of(interpret(data))


@pytest.fixture(scope="session")
def samples(linuxcnc: Oracle) -> Path:
    """Folder of the samples in LinuxCNC's package."""
    if not SAMPLES.is_dir():
        pytest.skip("the package of LinuxCNC holds no samples")
    return SAMPLES
