"""Outcomes of real runs, added from JSON as written by ``stepnc kbe export outcomes``.

For a real machine, measured values are recorded in such a file: a list of objects whose keys
are the columns of the knowledge base, including their units. Keys of optional values may be
omitted, and ``sequence``: then the outcomes of a workingstep of a run are numbered by their
order. A file that is added again adds nothing.
"""

import json
from collections import defaultdict
from collections.abc import Iterator
from datetime import datetime
from math import isfinite
from pathlib import Path
from typing import Any

from kbe.rows import IDENTITY, OUTCOME, AttributeColumn, outcome_row
from service.files import read_bytes
from service.knowledge.verbs import RecordCount, record
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import ProcessOutcome

MOST_BYTES = 1 << 28
"""Largest file of outcomes, bytes."""

LARGEST = 2**63 - 1
"""Largest whole number that a column of the knowledge base can hold."""

LONGEST_SHOWN = 80
"""Most characters of a value that a message shows."""

WORDS = {
    str: "text",
    int: f"a whole number of at most {LARGEST}",
    float: "a finite number of at most 1.8e308",
    bool: "true or false",
}


def add_outcomes(place: str, file: Path) -> RecordCount:
    """Add the outcomes of a file to the knowledge base, all or none; say how many are new.

    Raises
    ------
    StepNcError
        With row, key and value of the first error.
    """
    try:
        rows = json.loads(read_bytes(file, most=MOST_BYTES))
    except (ValueError, RecursionError) as error:
        raise StepNcError(f"{file}: is not valid JSON: {error}") from error
    if not isinstance(rows, list) or not rows:
        raise StepNcError(f"{file}: must hold a list with at least one outcome")
    outcomes = [
        _outcome(row, f"{file}, outcome {number}")
        for number, row in enumerate(_numbered(rows), 1)
    ]
    return record(place, outcomes)


def _numbered(rows: list[Any]) -> Iterator[Any]:
    """Number those rows of a workingstep of a run that have no sequence, by their order.

    Rows that say the same are one outcome, which stands in the file twice.
    """
    found: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        if not isinstance(row, dict) or "sequence" in row:
            yield row
            continue
        # Values of any type, as the rows are not checked yet.
        known = found[repr([row.get(name) for name in IDENTITY])]
        said = repr(sorted(row.items()))
        if said not in known:
            known.append(said)
        yield {**row, "sequence": known.index(said)}


def _outcome(row: object, where: str) -> ProcessOutcome:
    """Build an outcome from a row; keys that the knowledge base generates are ignored."""
    if not isinstance(row, dict):
        raise StepNcError(f"{where}: must be an object with keys and values")
    known = {leaf.name for leaf in OUTCOME.leaves}
    unknown = sorted(set(row) - known)
    if unknown:
        raise StepNcError(f"{where}: unknown key '{unknown[0]}'; known: {', '.join(known)}")
    values = [_value(leaf, row.get(leaf.name), where) for leaf in OUTCOME.leaves]
    try:
        outcome = OUTCOME.noun(values)
        OUTCOME.row(outcome)
        outcome_row(outcome)
    except (ValueError, TypeError) as error:
        raise StepNcError(f"{where}: {error}") from error
    return outcome


def _value(leaf: AttributeColumn, value: Any, where: str) -> Any:
    """Convert the value of a key to its type."""
    if value is None:
        if leaf.is_optional:
            return None
        raise StepNcError(f"{where}: '{leaf.name}' is missing")
    if leaf.kind is datetime:
        return _moment(leaf, value, where)
    if leaf.kind is float:
        number = _number(value)
        if number is not None:
            return number
    elif type(value) is leaf.kind and not _is_too_large(value):
        return value
    shown = repr(value)
    shown = shown if len(shown) <= LONGEST_SHOWN else f"{shown[: LONGEST_SHOWN - 1]}…"
    raise StepNcError(f"{where}: '{leaf.name}' is {shown}, but must be {WORDS[leaf.kind]}")


def _is_too_large(value: object) -> bool:
    """True if a value is an integer that is too large for a column."""
    return isinstance(value, int) and abs(value) > LARGEST


def _number(value: Any) -> float | None:
    """Return a finite number, or None; an integer may exceed the range of a float."""
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if isfinite(number) else None


def _moment(leaf: AttributeColumn, value: Any, where: str) -> datetime:
    try:
        moment = datetime.fromisoformat(value)
    except (ValueError, TypeError):
        moment = None
    if moment is None or moment.tzinfo is None:
        text = f"is {value!r}, but must be a time with its zone, as 2026-03-02T08:00:00+01:00"
        raise StepNcError(f"{where}: '{leaf.name}' {text}")
    return moment
