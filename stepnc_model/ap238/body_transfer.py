"""B-rep bodies carried from one file into another, byte for byte but for their numbers.

The geometry of a solid is the same entities in ISO 14649 and in AP238: those that ISO 10303-514
uses. So it is copied rather than built along reference paths.

References
----------
.. [1] ISO 10303-514, Application interpreted construct: Advanced boundary representation.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files

from stepnc_model.ap238.instances import references
from stepnc_model.errors import Finding, Part21Error, Severity
from stepnc_model.part21.reader import Part21File, masked
from stepnc_model.part21.values import Ref, Value
from stepnc_model.part21.writer import format_value, line_start, spliced

BODY = "ADVANCED_BREP_SHAPE_REPRESENTATION"

ITEMS, CONTEXT = "items", "context_of_items"

_CONTENT = (BODY, "REPRESENTATION")
"""Entities whose parameters are name, items and context of a representation."""

_REFERENCE = re.compile(rb"'[^']*'|/\*.*?\*/|#(\d+)", re.S)
"""Part of a string, a comment, or a reference."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlace:
    """Representation of a body in the file that it comes from, and in the one that gets it."""

    root: int
    into: int
    items: tuple[Value, ...]
    context: Value


@dataclass(frozen=True, slots=True, kw_only=True)
class Carried:
    """Bodies that can be carried."""

    file: Part21File
    """File that they come from."""
    places: tuple[BodyPlace, ...]
    ids: tuple[int, ...]
    """Their instances, each once, without the representations."""
    findings: tuple[Finding, ...] = field(default=())
    """Reasons why other bodies are left out."""


def carried(file: Part21File, roots: Iterable[tuple[int, int]]) -> Carried:
    """Collect the geometry of bodies.

    Parameters
    ----------
    file : Part21File
    roots : iterable of tuple of int
        Representations in the file, and the instances that stand for them in the other one.

    Returns
    -------
    Carried
        Without the bodies that are damaged, or that the other standard cannot express.
    """
    places: list[BodyPlace] = []
    found: dict[int, None] = {}
    findings: list[Finding] = []
    for root, into in roots:
        content = _content(file, root)
        if content is None:
            continue
        items, context = content
        try:
            below = _below(file, [*references(items), *references(context)])
        except Part21Error as error:
            findings.append(_left_out(file, root, str(error)))
            continue
        places.append(BodyPlace(root=root, into=into, items=items, context=context))
        found |= dict.fromkeys(below)
    return Carried(
        file=file, places=tuple(places), ids=tuple(sorted(found)), findings=tuple(findings)
    )


def with_bodies(data: bytes, bodies: Carried) -> bytes:
    """File with the bodies in it, numbered above its own instances.

    Parameters
    ----------
    data : bytes
        File whose representations have neither items nor context.
    bodies : Carried
    """
    if not bodies.places:
        return data
    target = Part21File.from_bytes(data)
    first = max(target.ids()) + 1
    numbers = {id: first + row for row, id in enumerate(bodies.ids)}
    splices = []
    for place in bodies.places:
        spans = target.parameter_spans(place.into)
        for span, value in zip(spans[1:3], (place.items, place.context), strict=True):
            splices.append((*span, _renumbered(format_value(value), numbers)))
    source = bodies.file
    lines = []
    for id in bodies.ids:
        start, end = source.span(id)
        lines.append(_renumbered(source.data[start:end], numbers))
    at = line_start(data, target.structure.data_end)
    splices.append((at, at, b"\n".join((*lines, b""))))
    return spliced(data, sorted(splices), start=0, end=len(data))


def _content(file: Part21File, root: int) -> tuple[tuple[Value, ...], Value] | None:
    """Items and context of a representation; None if it has no items."""
    for keyword, values in file.parts(root):
        match values:
            case (_, tuple() as items, context) if keyword in _CONTENT and items:
                return items, context
    return None


def _below(file: Part21File, refs: list[Ref[object]]) -> list[int]:
    """Instances that some refer to, with all that these refer to.

    Raises
    ------
    Part21Error
        When one does not exist, is malformed, or is of an entity that no solid has.
    """
    found: dict[int, None] = {}
    waiting = [int(ref) for ref in refs]
    while waiting:
        id = waiting.pop()
        if id in found:
            continue
        if id not in file:
            raise Part21Error(f"#{id} does not exist", line=0, column=0)
        found[id] = None
        for keyword, values in file.parts(id):
            if keyword not in body_entities():
                text = f"{file.label(id)}: ISO 10303-514 has no {keyword}"
                raise Part21Error(text, line=file.line(id), column=1)
            waiting += (int(ref) for value in values for ref in references(value))
    return list(found)


def _renumbered(text: bytes, numbers: dict[int, int]) -> bytes:
    """Text of an instance or a value with other numbers."""
    pieces: list[bytes] = []
    at = 0
    for match in _REFERENCE.finditer(masked(text)):
        if match[1] is not None:
            pieces += (text[at : match.start()], b"#%d" % numbers[int(match[1])])
            at = match.end()
    return b"".join((*pieces, text[at:]))


def _left_out(file: Part21File, root: int, reason: str) -> Finding:
    return Finding(
        severity=Severity.WARNING,
        message=f"the faces of the body are left out: {reason}",
        entity=file.label(root),
        attribute=ITEMS,
        line=file.line(root),
        rule="ISO 10303-514",
    )


@cache
def body_entities() -> frozenset[str]:
    """Entities of the geometry of a solid, in capitals."""
    text = (files("stepnc_model.ap238") / "body_entities.txt").read_text(encoding="utf-8")
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return frozenset(word.upper() for line in lines for word in line.split())
