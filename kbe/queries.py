"""Queries of the knowledge base: corrections, selections of outcomes, and their statistics.

A decision never changes a correction: it is a row of its own, and the latest one counts.
Outcomes are selected by machine, material, tool, feature, program, run and time.

Statistics by machine, material, tool and kind of feature are the rows of an evaluation table,
[1]_ "Knowledge-based evaluation", computed by the database: for a million outcomes it scans one
index. A variance from sums of squares loses about as many digits as mean² over variance has;
deviations are near zero, so enough digits remain.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from math import log, sqrt
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select

from kbe.rows import CORRECTION, EVALUATED, utc
from kbe.schema import DECIDED, GROUP, correction, decision, outcome
from stepnc_model.outcome import Context, LearnedCorrection


class Standing(StrEnum):
    """State of a correction, set by the last decision about it."""

    PROPOSED = "proposed"
    ACCEPTED = "accepted"
    WITHDRAWN = "withdrawn"


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredCorrection:
    """Correction as stored, with its state."""

    id: int
    correction: LearnedCorrection
    """The correction itself, with who accepted it and when, while it is accepted."""
    standing: Standing
    decided_by: str
    """Person who accepted or withdrew it last; empty before any decision."""
    decided_at: datetime | None


GREATEST_LOG = log(20.0)
"""Greatest absolute ln of a factor on k_c; no material lies beyond."""

_LATEST = select(func.max(decision.c.id)).group_by(decision.c.correction_id)
_LAST = select(decision).where(decision.c.id.in_(_LATEST)).subquery("last_decision")
"""Subquery of the latest decision about each correction."""


def entries() -> "Select[Any]":
    """Query of all corrections in the order of their proposal."""
    stored = [correction.c[leaf.name] for leaf in CORRECTION.leaves if leaf.name not in DECIDED]
    return (
        select(correction.c.id, _LAST.c.kind, _LAST.c.decided_by, _LAST.c.decided_at, *stored)
        .select_from(correction.outerjoin(_LAST, _LAST.c.correction_id == correction.c.id))
        .order_by(correction.c.id)
    )


def in_force(context: Context) -> "Select[Any]":
    """Query of the correction that was accepted last for a context."""
    return (
        entries()
        .where(
            correction.c.machine == context.machine,
            correction.c.material == context.material,
            correction.c.tool == context.tool,
            _LAST.c.kind == Standing.ACCEPTED.value,
        )
        .order_by(None)
        .order_by(_LAST.c.id.desc())
        .limit(1)
    )


def entry(row: Sequence[Any]) -> StoredCorrection:
    """Convert a row of the query :func:`entries`."""
    id_, kind, by, at, *stored = row
    standing = Standing(kind or Standing.PROPOSED)
    is_accepted = standing is Standing.ACCEPTED
    columns = [*stored, by if is_accepted else "", at if is_accepted else None]
    learned = CORRECTION.noun(columns)
    _require_sound(id_, learned)
    return StoredCorrection(
        id=id_,
        correction=learned,
        standing=standing,
        decided_by=by or "",
        decided_at=at,
    )


def _require_sound(id_: int, learned: LearnedCorrection) -> None:
    """Check that the values of a stored correction could come from the learning.

    Raises
    ------
    ValueError
        When a value is out of range, so that another program must have written it.
    """
    is_sound = (
        abs(learned.log_centre) <= GREATEST_LOG
        and 0.0 < learned.log_scale <= GREATEST_LOG
        and learned.degrees > 0.0
        and 0.0 <= learned.confidence <= 1.0
    )
    if not is_sound:
        raise ValueError(f"correction {id_} has values out of range: {learned}")


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Statistics of the deviations (measured over predicted, less one) of one quantity."""

    count: int
    """Number of outcomes in which the quantity was both predicted and measured."""
    mean: float | None
    """Mean deviation; None without outcomes."""
    deviation: float | None
    """Standard deviation of one outcome, with n − 1; None for fewer than two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Statistics of the outcomes of one context and kind of feature."""

    context: Context
    feature_kind: str
    outcomes: int
    first: datetime
    last: datetime
    roughness: Spread
    time: Spread
    force: Spread
    feed: Spread


def grouped(selection: Selection) -> "Select[Any]":
    """Query of the grouped statistics, whose rows :func:`group` reads."""
    keys = [outcome.c[name] for name in GROUP]
    at = outcome.c.recorded_at
    sums = [each for name in EVALUATED for each in _sums(name)]
    return (
        select(*keys, func.count(), func.min(at), func.max(at), *sums)
        .where(*conditions(selection))
        .group_by(*keys)
    )


def _sums(name: str) -> tuple[ColumnElement[Any], ...]:
    """Count, sum and sum of squares of the deviations of a quantity."""
    deviation = outcome.c[f"{name}_deviation"]
    return func.count(deviation), func.sum(deviation), func.sum(deviation * deviation)


def group(row: Sequence[Any]) -> Group:
    """Convert a row of the query :func:`grouped` to a group."""
    machine, material, tool, kind, outcomes, first, last, *sums = row
    spreads = {
        name: spread(*sums[3 * index : 3 * index + 3]) for index, name in enumerate(EVALUATED)
    }
    context = Context(machine=machine, material=material, tool=tool)
    return Group(
        context=context,
        feature_kind=kind,
        outcomes=outcomes,
        first=first,
        last=last,
        **spreads,
    )


def spread(count: int, total: float | None, squares: float | None) -> Spread:
    """Mean and standard deviation from count, sum and sum of squares."""
    if not count or total is None or squares is None:
        return Spread(count=0, mean=None, deviation=None)
    mean = total / count
    if count == 1:
        return Spread(count=1, mean=mean, deviation=None)
    # Rounding may make it slightly negative.
    variance = max(squares - total * mean, 0.0) / (count - 1)
    return Spread(count=count, mean=mean, deviation=sqrt(variance))
