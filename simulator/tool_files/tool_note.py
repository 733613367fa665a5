"""Tool data in one comment of NC code, in the manners of the usual postprocessors.

The patterns are those of Autodesk's posts (Fusion, HSMWorks), Mastercam, SolidCAM, CamBam,
FreeCAD, Vectric (VCarve, Aspire), Estlcam, Carbide Create, and of programs for Heidenhain and
Sinumerik controls. Lengths without a unit are in the unit of the program; fractions are inches.
"""

import re
from dataclasses import dataclass

from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.tool_words import edge_in, kind_in, teeth_in
from stepnc_model.units import mm_from_inches

_NUMBER = r"\+?(?:\d+\.?\d*|\.\d+)"
_LENGTH = (
    rf"(?:(?:(?P<whole>\d{{1,3}})[-\s])?(?P<top>\d{{1,3}})/(?P<bottom>\d{{1,3}})(?![\d/])"
    rf"|(?P<size>{_NUMBER}))\s*(?P<unit>mm\b|inch(?:es)?\b|in\b\.?|\"|'')?"
)
_WORDS = (
    r"(?:flat|square|ball|bull|end|face|facing|shell|spot|cent(?:er|re)|drill|twist|ream|tap)"
)

NUMBERED = (
    re.compile(
        r"^(?:[*-]\s*)*(?:#|T)\s?(\d{1,8})(?![\d.])"
        r"(?=\s*(?:[|:=;,-]|[A-Za-z(\[]|$)|\s+[\d.])",
        re.I,
    ),
    re.compile(
        r"\btool\s*(?:no\.?|number|nr\.?)?\s*[-#:]?\s*(\d{1,8})(?![\d./]|\s*(?:mm|in)\b)", re.I
    ),
    re.compile(r"\[T(\d{1,8})\]", re.I),
    re.compile(r"^No\.\s*(\d{1,8})\s*:", re.I),
    re.compile(r"^(\d{1,8})\s*=\s*(?=[A-Za-z])"),
)
"""Manners in which a comment names the number of its tool; the first that is found counts."""

NAMED = re.compile(r"^(?:TC|tool)\s*:", re.I)
"""Beginning of a comment that describes a tool without its number."""

OFFSETS = re.compile(
    r"\b(?:dia|len)\.?\s*off\.?\s*-?\s*\d+|\blen\.?\s*-\s*\d+|(?<=\|)\s*[HD]\d+\s*(?=\||$)"
    r"|\bn[or]\.?\s*\d+(?=\s+cent)",
    re.I,
)
"""Numbers of offsets (Mastercam) and of centre drills, which are no sizes."""

DIAMETERS = (
    re.compile(rf"\bD\s*=\s*{_LENGTH}", re.I),
    re.compile(rf"\b(?:dia(?:m(?:eter)?)?\b\.?|[Øø])\s*[-:=]?\s*{_LENGTH}", re.I),
    re.compile(
        rf"(?<![\w./-]){_LENGTH}[\s-]*(?:dia\b\.?\s*)?(?:\d{{1,2}}[\s-]?(?:flutes?|fl)\b\s*)?"
        rf"(?={_WORDS})",
        re.I,
    ),
    re.compile(rf"\bD\s?{_LENGTH}", re.I),
    re.compile(rf"(?<![\w./=+-]){_LENGTH}(?<=[a-z\"'.])", re.I),
    re.compile(rf"^T\d+\s*:\s*{_LENGTH}\s*$", re.I),
)
"""Manners in which a comment gives a diameter, the clearest first."""

_ANYWHERE = 4
"""Index of the manner in which a size stands anywhere: it counts only with a unit."""

OPERATION = re.compile(
    r"pocket|slot|contour|profile|groove|thread|deep|depth|wide|high\b|long\b|leave|left|allow|"
    r"stock|step",
    re.I,
)
"""Words of comments on an operation, whose sizes may be those of the part."""

CORNER = re.compile(
    rf"\b(?:CR\s*=|corner\s*rad(?:ius)?\.?\s*[-:=]?|R(?=\d*\.))\s*{_LENGTH}", re.I
)
RADIUS = re.compile(rf"\bR\s*=?\s*{_LENGTH}", re.I)
ANGLE = re.compile(
    rf"\b(?:taper|angle|tip angle)\s*[-:=]?\s*(?P<angle>{_NUMBER})\s*(?:deg|°)?", re.I
)

STATED_MILL = re.compile(
    rf"^TOOL/MILL\s*,\s*(?P<diameter>{_NUMBER})\s*,\s*(?P<corner>{_NUMBER})\s*,"
    rf"\s*{_NUMBER}\s*,\s*(?P<taper>{_NUMBER})\s*$",
    re.I,
)
"""Diameter, corner radius, height and taper in degrees, as CutViewer reads a mill."""

SHAPED = re.compile(
    r"thread\s*mill|t-?slot|slot\s?cutter|dovetail|lollipop|undercut|v-?bit|v-?carv|engrav|saw\b|"
    r"probe|form\s?mill|barrel|drag\s?knife|laser|spindle",
    re.I,
)
"""Words of tools whose shape no comment tells, or that do not cut."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolNote:
    """Tool data of a comment; None where it states nothing."""

    line: int
    text: str
    number: int | None = None
    diameter: float | None = None
    """Diameter, mm."""
    corner_radius: float | None = None
    """Corner radius, mm; half the diameter of a ball end mill."""
    angle_deg: float | None = None
    """Angle that the comment gives: of the point of a drill, of the flank of a mill,
    degrees."""
    teeth: int | None = None
    kind: ToolKind | None = None
    edge: CuttingMaterial | None = None
    is_chamfer: bool = False
    is_bull: bool = False
    """Whether it has corners with a radius, whether or not the comment gives it."""
    is_shaped: bool = False
    """Whether it has a shape that no comment tells."""
    is_named: bool = False
    """Whether the comment begins as those about tools do."""

    @property
    def is_of_tool(self) -> bool:
        """True if the comment describes a tool beyond doubt: by its manner, or its words."""
        if self.diameter is None:
            return False
        is_marked = self.number is not None or self.is_named
        return is_marked or self.kind is not None or self.teeth is not None


def note_of(text: str, *, line: int, unit: float) -> ToolNote:
    """Read one comment.

    Parameters
    ----------
    line : int
    unit : float, mm
        Length of one unit of the program.

    Examples
    --------
    >>> note = note_of("T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL", line=1, unit=1.0)
    >>> note.number, note.diameter, note.kind.value
    (1, 10.0, 'endmill')
    >>> note_of("T1 | 1/2 FLAT ENDMILL | H1 | DIA 0.5", line=1, unit=25.4).diameter
    12.7
    """
    stated = STATED_MILL.match(text.strip())
    if stated:
        return _stated_mill(stated, text, line=line, unit=unit)
    plain = text.replace("{", "(").replace("}", ")")
    number = _number(plain)
    bare = OFFSETS.sub(" ", plain)
    diameter, manner = _diameter(bare, unit)
    is_named = NAMED.search(plain) is not None
    if number is None and not is_named and manner == _ANYWHERE and OPERATION.search(plain):
        diameter = None
    lower = plain.lower()
    is_ball = re.search(r"\bball", lower) is not None
    corner = CORNER.search(bare)
    radius = _length(corner, unit) if corner else None
    if is_ball and diameter is not None:
        radius = 0.5 * diameter
    angle = ANGLE.search(plain)
    is_chamfer = "chamfer" in lower
    kind = ToolKind.ENDMILL if is_chamfer else kind_in(lower)
    return ToolNote(
        line=line,
        text=text,
        number=number,
        diameter=diameter,
        corner_radius=radius,
        angle_deg=float(angle["angle"]) if angle else None,
        teeth=teeth_in(re.sub(r"\bz\s?\d", " ", lower)),
        kind=kind,
        edge=edge_in(lower),
        is_chamfer=is_chamfer,
        is_bull=re.search(r"\bbull", lower) is not None,
        is_shaped=SHAPED.search(plain) is not None,
        is_named=is_named,
    )


def _stated_mill(found: re.Match[str], text: str, *, line: int, unit: float) -> ToolNote:
    """Mill of a ``TOOL/MILL`` comment; one that tapers has a shape that is not taken."""
    diameter, corner = unit * float(found["diameter"]), unit * float(found["corner"])
    return ToolNote(
        line=line,
        text=text,
        diameter=diameter or None,
        corner_radius=corner,
        kind=ToolKind.ENDMILL,
        is_shaped=float(found["taper"]) != 0.0,
        is_named=True,
    )


def defined_note(text: str, *, line: int, unit: float) -> ToolNote | None:
    """Tool of a Klartext block ``TOOL DEF 12 L+0 R+5``; None if the block is none."""
    found = re.match(r"\s*(?:\d+\s+)?TOOL\s+DEF\s+(\d{1,8})\b([^;]*)", text, re.I)
    radius = RADIUS.search(found[2]) if found else None
    if found is None or radius is None:
        return None
    size = 2.0 * _length(radius, unit)
    return ToolNote(line=line, text=text.strip(), number=int(found[1]), diameter=size or None)


def _number(text: str) -> int | None:
    found = next((each for manner in NUMBERED if (each := manner.search(text))), None)
    return int(found[1]) if found else None


def _diameter(text: str, unit: float) -> tuple[float | None, int]:
    """Diameter in the clearest manner in which a text gives one, mm, and the manner."""
    for place, manner in enumerate(DIAMETERS):
        for found in manner.finditer(text):
            if place == _ANYWHERE and not (found["unit"] or found["top"]):
                continue
            size = _length(found, unit)
            if size > 0.0:
                return size, place
    return None, len(DIAMETERS)


def _length(match: re.Match[str], unit: float) -> float:
    """Length of a match, mm; 0 for a fraction without a denominator."""
    if match["top"]:
        bottom = int(match["bottom"])
        return (
            mm_from_inches(int(match["whole"] or 0) + int(match["top"]) / bottom)
            if bottom
            else 0.0
        )
    size, named = float(match["size"]), (match["unit"] or "").lower()
    if not named:
        return unit * size
    return size if named == "mm" else mm_from_inches(size)
