"""Selection of outcomes by machine, material, tool, feature, program, run and time."""

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement

from kbe.rows import utc
from kbe.schema import outcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """Filter of outcomes; None accepts any value."""

    machine: str | None = None
    material: str | None = None
    tool: str | None = None
    feature_kind: str | None = None
    """EXPRESS name of the feature, as ``closed_pocket``."""
    program: str | None = None
    run: str | None = None
    since: datetime | None = None
    """Earliest time of recording, inclusive, with zone."""
    until: datetime | None = None
    """Latest time of recording, exclusive, with zone."""


EVERYTHING = Selection()

NAMES = ("machine", "material", "tool", "feature_kind", "program", "run")


def conditions(selection: Selection) -> list[ColumnElement[bool]]:
    """SQL conditions of a selection on a row of ``outcome``.

    Raises
    ------
    ValueError
        When a time has no zone.
    """
    wanted = [(outcome.c[name], getattr(selection, name)) for name in NAMES]
    found = [column == value for column, value in wanted if value is not None]
    at = outcome.c.recorded_at
    if selection.since is not None:
        found.append(at >= utc("since", selection.since))
    if selection.until is not None:
        found.append(at < utc("until", selection.until))
    return found
