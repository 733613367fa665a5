"""Solid of a STEP file as triangles: chosen among several, closed, and of the right volume.

Exchange file of geometry alone, for Open CASCADE.

Open CASCADE numbers instances in the order of the file, knows no workingsteps, and reads
nothing of some files with many comments. What it gets has neither comments nor anything that
the solids do not need.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extras.brep.tessellation import ALL, Choice, Tessellation, tessellate
from service.inputs.program_bodies import SolidPlace, sag_within
from simulator.motion.segments import Floats
from simulator.removal.mesh_stock import edges_of
from stepnc_model.errors import Part21Error, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref, Typed, Value
from stepnc_model.plurals import counted

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


ROUNDING = 1e-6
"""Relative difference of volumes that rounding explains."""

SOLIDS = ("MANIFOLD_SOLID_BREP", "FACETED_BREP", "BREP_WITH_VOIDS")
"""Entities of solids."""

MOST_NAMED = 12
"""Most solids that a message lists."""


def solid_triangles(place: SolidPlace, *, tolerance: float) -> Floats:
    """Triangles of a solid.

    Parameters
    ----------
    tolerance : float, mm
        Size of the deviations that are to be seen: triangles lie within a fifth of it of the
        surface.

    Returns
    -------
    (T, 3, 3) array, mm
        Closed, and counter-clockwise as seen from outside.

    Raises
    ------
    StepNcError
        When there is no such solid, or several, or Open CASCADE is missing or cannot read it;
        when its triangles are not closed, or have another volume.
    """
    taken, names = _taken(place)
    sag = sag_within(tolerance)
    found = tessellate(
        taken.data,
        name=place.name,
        sag=sag,
        choice=_choice(place, taken, names),
    )
    if found.chosen < 0:
        raise _not_one(place, found, taken, names)
    _check_watertight(place.name, found, sag)
    return found.triangles


def require_solids(place: SolidPlace) -> None:
    """Refuse a file that has no solid.

    Raises
    ------
    StepNcError
        When there is none, or Open CASCADE is missing or cannot read the file.
    """
    taken, names = _taken(place)
    # No instance has the number 0: nothing is tessellated.
    choice = Choice(solids=tuple(names), wanted=(0,))
    found = tessellate(taken.data, name=place.name, sag=1.0, choice=choice)
    if not len(found.number):
        raise _not_one(place, found, taken, names)


def _taken(place: SolidPlace) -> tuple[Exchange, dict[int, str]]:
    """Exchange structure for Open CASCADE, and the names of the solids in it."""
    file = place.file
    try:
        taken = whole_exchange(file) if place.root is None else exchange_below(file, place.root)
        return taken, _names(file, taken)
    except Part21Error as error:
        raise StepNcError(f"{place.name}: {error}") from error


def _choice(place: SolidPlace, taken: Exchange, names: dict[int, str]) -> Choice:
    """Solid of a name, or of a place among all."""
    solid = place.solid
    root = ALL if place.root is None else taken.ids.index(place.root) + 1
    solids = tuple(names)
    wanted = tuple(number for number, name in names.items() if name == solid) if solid else ()
    if solid and not wanted and solid.isdecimal() and int(solid):
        return Choice(root=root, solids=solids, place=int(solid))
    # No instance has the number 0: a name that none has chooses none.
    return Choice(root=root, solids=solids, wanted=wanted or ((0,) if solid else ()))


def _not_one(
    place: SolidPlace, tessellation: Tessellation, taken: Exchange, names: dict[int, str]
) -> StepNcError:
    """Error of a file without a solid, with several, or without the one that was named."""
    if not len(tessellation.number):
        shells = (
            f"; {tessellation.shells} open shells or surfaces" if tessellation.shells else ""
        )
        return StepNcError(
            f"{place.name}: no closed solid (such as MANIFOLD_SOLID_BREP){shells}"
        )
    rows = []
    for row, number in enumerate(tessellation.number.tolist()[:MOST_NAMED]):
        size = " x ".join(
            f"{each:.4g}" for each in (tessellation.high[row] - tessellation.low[row]).tolist()
        )
        id = f" (#{taken.ids[number - 1]})" if number else ""
        rows.append(f"{row + 1} '{names.get(number, '')}'{id} of {size} mm")
    more = len(tessellation.number) - len(rows)
    listed = ", ".join(rows) + (f", and {more} more" if more > 0 else "")
    count = len(tessellation.number)
    what = f"no solid '{place.solid}', or several" if place.solid else f"{count} solids"
    return StepNcError(f"{place.name}: {what}: choose one by its place or name: {listed}")


def _check_watertight(name: str, tessellation: Tessellation, sag: float) -> None:
    """Refuse triangles that are not closed, or have another volume than the solid."""
    triangles = tessellation.triangles
    edges = edges_of(triangles)
    if edges.open or edges.unlike:
        raise StepNcError(
            f"{name}: the solid is not closed: {counted(edges.open, 'edge')} without two "
            f"triangles, and {counted(edges.unlike, 'triangle')} facing the other way than a "
            "neighbour"
        )
    normal = np.cross(triangles[:, 1], triangles[:, 2])
    volume = float(np.einsum("ij,ij->i", triangles[:, 0], normal).sum()) / 6.0
    exact = float(tessellation.volume[tessellation.chosen])
    bound = sag * float(tessellation.area[tessellation.chosen]) + ROUNDING * abs(exact)
    if not exact > 0.0 or abs(volume - exact) > bound:
        raise StepNcError(
            f"{name}: its triangles have {volume:.6g} mm³, the solid {exact:.6g} mm³; they may "
            f"differ by {bound:.3g} mm³ at {sag:g} mm of its surface: is it damaged?"
        )


def _names(file: Part21File, taken: Exchange) -> dict[int, str]:
    """Names of the solids of a file by their numbers: their own, or those of their products."""
    number = {id: row + 1 for row, id in enumerate(taken.ids)}
    ids = [id for keyword in SOLIDS for id in file.ids_of(keyword) if id in number]
    products = _product_names(file)
    return {number[id]: _text(file.parameters(id)) or products.get(id, "") for id in ids}


def _product_names(file: Part21File) -> dict[int, str]:
    """Names of products by the instances of their shape representations."""
    shown: dict[int, str] = {}
    for definition in file.ids_of("SHAPE_DEFINITION_REPRESENTATION"):
        shape, representation = file.parameters(definition)[:2]
        name = ""
        # From the shape to the product definition, its formation, and the product.
        for position in (2, 2, 2):
            shape = _reference(file, shape, position)
        if isinstance(shape, Ref) and shape in file:
            name = _text(file.parameters(shape)[1:])
        if isinstance(representation, Ref):
            shown[int(representation)] = name
    for relation in file.ids_of("SHAPE_REPRESENTATION_RELATIONSHIP"):
        one, other = file.parameters(relation)[2:4]
        for this, that in ((one, other), (other, one)):
            if isinstance(this, Ref) and isinstance(that, Ref) and int(this) in shown:
                shown.setdefault(int(that), shown[int(this)])
    names: dict[int, str] = {}
    for id, name in shown.items():
        items = file.parameters(id)[1] if id in file and file.keyword(id) else ()
        for item in items if isinstance(items, tuple) else ():
            if isinstance(item, Ref):
                names[int(item)] = name
    return names


def _reference(file: Part21File, ref: Value, position: int) -> Value:
    """Attribute of an instance; None where there is none."""
    if not isinstance(ref, Ref) or ref not in file or not file.keyword(ref):
        return None
    values = file.parameters(ref)
    return values[position] if len(values) > position else None


def _text(values: Sequence[Value]) -> str:
    """First of some values, if it is a text."""
    return values[0] if values and isinstance(values[0], str) else ""
