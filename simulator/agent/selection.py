"""Choice of data items by an XPath expression of a client, within bounds."""

import re
from functools import lru_cache

from lxml import etree

from simulator.agent.model import DeviceModel

LONGEST = 1024
"""characters of an expression"""

MOST_STEPS = 8
"""descendant steps, whose cost multiplies"""

FUNCTIONS = frozenset(["contains", "starts-with", "not", "name", "local-name", "text", "node"])
"""functions that an expression may call: none that goes through the document"""

_CALL = re.compile(r"([\w-]+)\s*\(")
_TEXT = re.compile(r"'[^']*'|\"[^\"]*\"")


class PathFault(ValueError):
    """An expression that is not valid, too costly, or finds nothing."""


@lru_cache(maxsize=256)
def selected(model: DeviceModel, path: str) -> frozenset[int]:
    """Numbers of the data items that an expression finds, with those of components below.

    Raises
    ------
    PathFault
        For an expression that is not valid, costs too much, or finds nothing.
    """
    bare = _TEXT.sub("''", path)
    if len(path) > LONGEST:
        raise PathFault(f"longer than {LONGEST} characters")
    if bare.count("//") + bare.count("descendant") + bare.count("*") > MOST_STEPS:
        raise PathFault(f"more than {MOST_STEPS} descendant steps or wildcards")
    inside = re.findall(r"\[([^\]]*)", bare)
    if any("//" in each or "descendant" in each or "::" in each for each in inside):
        raise PathFault("descendant steps or axes in a condition")
    for name in _CALL.findall(bare):
        if name not in FUNCTIONS and name not in {"or", "and"}:
            raise PathFault(f"function {name}() is not supported")
    try:
        found = model.root.xpath(path)
    except (etree.XPathError, ValueError) as error:
        raise PathFault(f"is not valid: {error}") from error
    if not isinstance(found, list):
        raise PathFault("finds no elements")
    ids: set[str] = set()
    for element in found:
        if not isinstance(getattr(element, "tag", None), str):
            raise PathFault("finds no elements")
        ids.update(each.get("id", "") for each in element.iter("DataItem"))
    numbers = frozenset(at for at, item in enumerate(model.items) if item.id in ids)
    if not numbers:
        raise PathFault("finds no data items")
    return numbers
