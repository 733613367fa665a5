"""Explanation of an empty answer of the knowledge base."""

from collections.abc import Sequence

from service.knowledge.verbs import contexts, shown

MOST_NAMES = 8
"""Most names of a kind that are listed."""


def why_empty(place: str) -> str:
    """Return why no outcomes were found: none are stored, or none are selected."""
    known = contexts(place)
    if not known:
        return f"{shown(place)}: no outcomes yet; `stepnc control FILE --kb …` records them"
    names = {
        "machines": sorted({each.machine for each in known}),
        "materials": sorted({each.material for each in known}),
        "tools": sorted({each.tool for each in known}),
    }
    told = "; ".join(f"{what} {_some(them)}" for what, them in names.items())
    return f"{shown(place)}: no outcome matches the selection; stored are {told}"


def _some(names: Sequence[str]) -> str:
    """Return the first names of a list, and the number of others."""
    listed = ", ".join(names[:MOST_NAMES])
    more = len(names) - MOST_NAMES
    return f"{listed} and {more} more" if more > 0 else listed
