"""Shape of a part from a file: an STL file, or a solid of a STEP file.

The content tells which, not the name.

Triangles of an STL file, binary or text, in mm.
"""

import re
from dataclasses import dataclass
from math import inf
from pathlib import Path
from pkgutil import resolve_name

import numpy as np

from service.files import read_bytes
from service.inputs.program_bodies import SolidPlace, sag_within, triangles_of
from service.inputs.program_kind import PART21
from simulator.motion.segments import Floats
from stepnc_model.errors import Part21Error, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.regular_file import open_regular

REQUIRE_SOLIDS = "extras.brep.solid:require_solids"
"""Function of an extra that refuses a file without a solid."""

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
    """True if a file has the size of as many triangles as it says."""
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


PACKED = (b"PK\x03\x04", b"\x1f\x8b")
"""Beginning of a ZIP archive and of a gzip stream, in which STEP files come."""

MOST_BYTES = 1 << 28
"""Largest file of a part, bytes; the most triangles take 10 MB, or 60 MB as text."""

LOOKED_AT = 1 << 16
"""Bytes at the beginning of a file that tell what it is."""

CHOICE = "#"
"""Separates the name of a file from that of one of its solids."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartMesh:
    """Triangles of a part."""

    triangles: Floats
    """(T, 3, 3), mm."""
    sag: float = inf
    """Greatest distance of the triangles from the surface, mm; infinite: not known."""


def part_place(text: str) -> tuple[Path, str]:
    """Split ``part.step#SOLID`` into the file and the solid; a file of that name comes first.

    Examples
    --------
    >>> part_place("part.step#2")
    (PosixPath('part.step'), '2')
    >>> part_place("part.stl")
    (PosixPath('part.stl'), '')
    """
    name, mark, solid = text.rpartition(CHOICE)
    if not mark or not name or Path(text).is_file():
        return Path(text), ""
    return Path(name), solid


def read_part(path: Path, *, solid: str = "", tolerance: float) -> PartMesh:
    """Read the triangles of a part.

    Parameters
    ----------
    solid : str
        Solid of a STEP file, by its name or its place in the file; empty: its only one.
    tolerance : float, mm
        Size of the deviations that are to be seen; the triangles of a solid lie within a fifth
        of it of its surface.

    Raises
    ------
    StepNcError
        When the file cannot be read, or has no such part.
    """
    content = read_bytes(path, most=MOST_BYTES)
    if not _is_step(content):
        return PartMesh(triangles=stl_triangles(content, path))
    triangles = triangles_of(_solids(content, path, solid), tolerance=tolerance)
    return PartMesh(triangles=triangles, sag=sag_within(tolerance))


def require_part(path: Path) -> None:
    """Refuse a file without the triangles of a part and without a solid.

    Raises
    ------
    StepNcError
        As :func:`read_part`; several solids are allowed.
    """
    content = read_bytes(path, most=MOST_BYTES)
    if _is_step(content):
        resolve_name(REQUIRE_SOLIDS)(_solids(content, path))
    else:
        stl_triangles(content, path)


def require_part_form(path: Path) -> None:
    """Refuse a file that is neither STL nor STEP, without reading its part.

    Raises
    ------
    StepNcError
        When its beginning and its size are those of neither.
    """
    with open_regular(path) as file:
        head = file.read(LOOKED_AT)
    count = int.from_bytes(head[HEADER - 4 : HEADER], "little")
    is_binary = len(head) >= HEADER and path.stat().st_size == HEADER + RECORD * count
    if not (is_binary or _is_step(head) or VERTEX.search(head)):
        raise StepNcError(f"{path}: expected an STL or STEP file")


def _solids(content: bytes, path: Path, solid: str = "") -> SolidPlace:
    try:
        file = Part21File.from_bytes(content, name=path.name)
    except Part21Error as error:
        raise StepNcError(f"{path}: {error}") from error
    return SolidPlace(file=file, name=str(path), solid=solid)


def _is_step(content: bytes) -> bool:
    if is_binary_stl(content):
        return False
    return content.startswith(PACKED) or PART21.search(content[:LOOKED_AT]) is not None
