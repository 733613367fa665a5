"""Triangles of an STL file, binary or text, in mm."""

import re
from pathlib import Path

import numpy as np

from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError

HEADER, RECORD = 84, 50
"""Bytes before the first triangle of a binary file, and of each triangle."""

MOST_TRIANGLES = 200_000

VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def stl_triangles(content: bytes, path: Path) -> Floats:
    """Corners of the triangles of a file, (T, 3, 3), mm.

    Parameters
    ----------
    content : bytes
    path : Path
        Path of the file, for messages.

    Raises
    ------
    StepNcError
        When the file is damaged, or has too many triangles.
    """
    triangles = _binary(content) if is_binary_stl(content) else _text(path, content)
    if not len(triangles) and len(content) >= HEADER:
        count = int.from_bytes(content[HEADER - 4 : HEADER], "little")
        raise StepNcError(
            f"{path}: no triangles as text, and as a binary file its {count} triangles need "
            f"{HEADER + RECORD * count} bytes; it has {len(content)}: is it cut off?"
        )
    if not len(triangles):
        raise StepNcError(f"{path}: no triangles: expected an STL or STEP file")
    _require_few(path, len(triangles))
    if not np.isfinite(triangles).all():
        raise StepNcError(f"{path}: a corner of a triangle is not finite")
    return triangles


def _require_few(path: Path, count: int) -> None:
    if count > MOST_TRIANGLES:
        raise StepNcError(f"{path}: {count} triangles; at most {MOST_TRIANGLES} are accepted")


def is_binary_stl(content: bytes) -> bool:
    """Whether a file has the size of as many triangles as it says."""
    if len(content) < HEADER:
        return False
    count = int.from_bytes(content[HEADER - 4 : HEADER], "little")
    return len(content) == HEADER + RECORD * count


def _binary(content: bytes) -> Floats:
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records = np.frombuffer(content, dtype=kind, offset=HEADER)
    return np.asarray(records["corners"], dtype=np.float64)


def _text(path: Path, content: bytes) -> Floats:
    # Counted first: each vertex takes many times its text in memory.
    _require_few(path, content.count(b"vertex") // 3)
    try:
        found = [[float(each) for each in match] for match in VERTEX.findall(content)]
    except ValueError as error:
        raise StepNcError(f"{path}: damaged vertex: {error}") from error
    if len(found) % 3:
        raise StepNcError(f"{path}: {len(found)} vertices: triangles have three each")
    return np.array(found, dtype=np.float64).reshape(-1, 3, 3)
