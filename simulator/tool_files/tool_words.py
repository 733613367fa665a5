"""Words by which remarks and comments tell the kind of a tool, its teeth and its edges."""

import re

from simulator.spec import CuttingMaterial, ToolKind

KINDS = (
    (r"cent(?:er|re)\s?drill|spot", ToolKind.CENTER_DRILL),
    (r"countersink|chamfer", ToolKind.COUNTERSINK),
    (r"tap\s?drill|drill", ToolKind.DRILL),
    (r"ream", ToolKind.REAMER),
    (r"\btap\b", ToolKind.TAP),
    (r"boring|\bbore\b", ToolKind.BORING_BAR),
    (r"\bfac(?:e|ing)|shell", ToolKind.FACEMILL),
    (r"end\s?mill|mill|ball|\bbull|router", ToolKind.ENDMILL),
)
"""Words of remarks and the kinds that they name; the first that is found counts."""

TEETH = re.compile(r"(?<!\d)(\d{1,2})[\s-]?(?:flutes?|fl|teeth|tooth)\b|\bz\s?=?(\d{1,2})\b")

EDGES = (
    (r"\bhss|\bhigh[\s-]speed\b|\bcobalt\b", CuttingMaterial.HSS),
    (r"carbide|\bvhm\b|\bsolid hm\b", CuttingMaterial.CARBIDE),
    (r"ceramic", CuttingMaterial.CERAMIC),
)


def kind_in(text: str) -> ToolKind | None:
    """Kind that a text in small letters names; None if it names none."""
    return next((kind for words, kind in KINDS if re.search(words, text)), None)


def teeth_in(text: str) -> int | None:
    """Number of teeth that a text in small letters names; None if it names none."""
    found = TEETH.search(text)
    return int(found[1] or found[2]) if found else None


def edge_in(text: str) -> CuttingMaterial | None:
    """Cutting material that a text in small letters names; None if it names none."""
    return next((edge for words, edge in EDGES if re.search(words, text)), None)
