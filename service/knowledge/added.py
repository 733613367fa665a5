"""Outcomes of real runs, from a file: JSON as ``stepnc kbe export outcomes`` writes it.

A machine that no virtual one stands for records what it measured in such a file: a list of
objects whose keys are the columns of the knowledge base, with their units. Keys that may be
missing in an outcome may be left out.
"""

import json
from datetime import datetime
from math import isfinite
from pathlib import Path
from typing import Any

from kbe.rows import OUTCOME, AttributeColumn
from service.files import read_bytes
from service.knowledge.verbs import record
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import ProcessOutcome

LARGEST = 2**63 - 1
"""of a whole number: what a column of the knowledge base holds"""

LONGEST_SHOWN = 80
"""letters of a value in a message"""

WORDS = {
    str: "a text",
    int: f"a whole number of at most {LARGEST}",
    float: "a finite number of at most 1.8e308",
    bool: "true or false",
}


def add_outcomes(place: str, file: Path) -> int:
    """Keep the outcomes of a file, all of them or none; how many.

    Raises
    ------
    StepNcError
        With row, key and value of what is wrong.
    """
    try:
        rows = json.loads(read_bytes(file))
    except (ValueError, RecursionError) as error:
        raise StepNcError(f"{file}: is no JSON: {error}") from error
    if not isinstance(rows, list) or not rows:
        raise StepNcError(f"{file}: must hold a list of outcomes, at least one")
    outcomes = [
        _outcome(row, f"{file}, outcome {number}") for number, row in enumerate(rows, 1)
    ]
    record(place, outcomes)
    return len(outcomes)


def _outcome(row: object, where: str) -> ProcessOutcome:
    """One outcome; keys that the knowledge base makes itself are passed over."""
    if not isinstance(row, dict):
        raise StepNcError(f"{where}: is no object with keys and values")
    known = {leaf.name for leaf in OUTCOME.leaves}
    unknown = sorted(set(row) - known)
    if unknown:
        raise StepNcError(f"{where}: unknown key '{unknown[0]}'; known: {', '.join(known)}")
    values = [_value(leaf, row.get(leaf.name), where) for leaf in OUTCOME.leaves]
    try:
        outcome = OUTCOME.noun(values)
        OUTCOME.row(outcome)
    except (ValueError, TypeError) as error:
        raise StepNcError(f"{where}: {error}") from error
    return outcome


def _value(leaf: AttributeColumn, value: Any, where: str) -> Any:
    """The value of a key as the noun has it."""
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
    raise StepNcError(f"{where}: '{leaf.name}' is {shown} and must be {WORDS[leaf.kind]}")


def _is_too_large(value: object) -> bool:
    """Whether it is an integer that is too large for a column."""
    return isinstance(value, int) and abs(value) > LARGEST


def _number(value: Any) -> float | None:
    """A finite number, or None: an integer may be beyond the range of a float."""
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
        text = f"is {value!r} and must be a time with its zone, 2026-03-02T08:00:00+01:00"
        raise StepNcError(f"{where}: '{leaf.name}' {text}")
    return moment
