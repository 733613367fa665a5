"""Numbers of teeth that tools of a kind and a diameter usually have, where nothing tells them.

The ranges are ours: what catalogues of solid cutters and of face mills with inserts offer,
without rare tools. A range serves to find the feed that holds for every number in it.
"""

from dataclasses import dataclass
from math import ceil, inf

from simulator.spec import ToolKind


@dataclass(frozen=True, slots=True, kw_only=True)
class UsualTeeth:
    """Numbers of teeth of a tool."""

    least: int
    usual: int
    most: int


END_MILLS = (
    (3.0, UsualTeeth(least=2, usual=2, most=4)),
    (6.0, UsualTeeth(least=2, usual=3, most=4)),
    (12.0, UsualTeeth(least=2, usual=3, most=6)),
    (20.0, UsualTeeth(least=2, usual=4, most=8)),
    (inf, UsualTeeth(least=2, usual=4, most=12)),
)
"""Teeth of end mills up to a diameter, mm."""

SINGLE = 8.0
"""Diameter up to which end mills with one tooth are usual for plastics and light metals, mm."""

PITCHES = (25.0, 12.0, 6.0)
"""Circumference over π of a face mill for each tooth, mm: wide, usual and close pitch."""

OTHERS = {
    ToolKind.DRILL: UsualTeeth(least=2, usual=2, most=3),
    ToolKind.CENTER_DRILL: UsualTeeth(least=2, usual=2, most=2),
    ToolKind.COUNTERSINK: UsualTeeth(least=1, usual=3, most=6),
    ToolKind.REAMER: UsualTeeth(least=4, usual=6, most=8),
}


def usual_teeth(kind: ToolKind, diameter: float, *, iso_group: str = "") -> UsualTeeth:
    """Numbers of teeth that a tool probably has.

    Parameters
    ----------
    diameter : float, mm
    iso_group : str
        Group of the material; small end mills for group N may have one tooth.

    Examples
    --------
    >>> usual_teeth(ToolKind.ENDMILL, 10.0)
    UsualTeeth(least=2, usual=3, most=6)
    """
    if kind is ToolKind.ENDMILL:
        found = next(teeth for most, teeth in END_MILLS if diameter <= most)
        if iso_group in {"N", ""} and diameter <= SINGLE:
            return UsualTeeth(least=1, usual=found.usual, most=found.most)
        return found
    if kind is ToolKind.FACEMILL:
        wide, usual, close = PITCHES
        least, most = max(2, int(diameter / wide)), max(4, ceil(diameter / close))
        return UsualTeeth(least=least, usual=max(2, round(diameter / usual)), most=most)
    return OTHERS.get(kind, UsualTeeth(least=1, usual=1, most=1))
