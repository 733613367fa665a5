"""Exchange file of geometry alone, for Open CASCADE.

Open CASCADE numbers instances in the order of the file, knows no workingsteps, and reads
nothing of some files with many comments. What it gets has neither comments nor anything that
the solids do not need.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref, Typed, Value

HEAD = (
    b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    b"FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\n"
    b"ENDSEC;\nDATA;\n"
)
TAIL = b"ENDSEC;\nEND-ISO-10303-21;\n"

QUOTED = re.compile(rb"'[^']*'|/\*.*?\*/", re.S)
"""Part of a string, or a comment."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exchange:
    """Geometry of a file."""

    data: bytes
    ids: tuple[int, ...]
    """Instance numbers in the file that it was taken from, in the order of this one."""


def whole_exchange(file: Part21File) -> Exchange:
    """All instances of a file, without comments."""
    return _of(file, tuple(file.ids()))


def exchange_below(file: Part21File, root: int) -> Exchange:
    """An instance and all that it refers to.

    Raises
    ------
    Part21Error
        If one of them is malformed.
    """
    found, waiting = {root}, [root]
    while waiting:
        for _, values in file.parts(waiting.pop()):
            for id in _references(values):
                if id not in found and id in file:
                    found.add(id)
                    waiting.append(id)
    return _of(file, tuple(sorted(found)))


def _of(file: Part21File, ids: tuple[int, ...]) -> Exchange:
    lines = [HEAD]
    for id in ids:
        start, end = file.span(id)
        lines += (_without_comments(file.scanned[start:end]), b"\n")
    return Exchange(data=b"".join((*lines, TAIL)), ids=ids)


def _without_comments(text: bytes) -> bytes:
    if b"/*" not in text:
        return text
    return QUOTED.sub(lambda found: found[0] if found[0].startswith(b"'") else b"", text)


def _references(values: Sequence[Value]) -> list[int]:
    """Instance numbers within values, however deep they are nested."""
    found: list[int] = []
    waiting: list[Value] = list(values)
    while waiting:
        match waiting.pop():
            case Ref() as ref:
                found.append(int(ref))
            case tuple() as several:
                waiting += several
            case Typed(value=value):
                waiting.append(value)
    return found
