"""JSON documents of CAM systems, and values in them by their path."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from simulator.errors import LibraryError

LONGEST_SHOWN = 60
"""Greatest number of characters of a value in a message."""


def parsed_json(text: str, path: Path) -> dict[str, Any]:
    """Object of a JSON document.

    Raises
    ------
    LibraryError
        With the line of the first fault, or if the document is no object.
    """

    def refuse(word: str) -> NoReturn:
        raise LibraryError(f"{word} is not a number of JSON", path=str(path))

    try:
        content = json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        message = f"is not JSON: {error.msg}"
        raise LibraryError(message, path=str(path), line=error.lineno) from error
    except (RecursionError, ValueError) as error:
        raise LibraryError(f"is not JSON that can be read: {error}", path=str(path)) from error
    if not isinstance(content, dict):
        raise LibraryError("is not a JSON object", path=str(path))
    return content


def object_in(
    parent: Mapping[str, Any], key: str, path: Path, *, place: str
) -> Mapping[str, Any]:
    """Object below a key; empty if it is absent or null.

    Raises
    ------
    LibraryError
        Another value stands there.
    """
    value = parent.get(key)
    if value is None:
        return {}
    if not isinstance(value, dict):
        message = f"{shown(value)} is not an object"
        raise LibraryError(message, path=str(path), key=f"{place}.{key}".lstrip("."))
    return value


def list_in(parent: Mapping[str, Any], key: str, path: Path, *, place: str) -> list[Any]:
    """List below a key; empty if it is absent or null.

    Raises
    ------
    LibraryError
        Another value stands there.
    """
    value = parent.get(key)
    if value is None:
        return []
    if not isinstance(value, list):
        message = f"{shown(value)} is not a list"
        raise LibraryError(message, path=str(path), key=f"{place}.{key}".lstrip("."))
    return value


def shown(value: object) -> str:
    """Value for a message, not too long."""
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"
