"""Queries of corrections and of the decisions about them.

A decision never changes a correction: it is a row of its own, and the latest one counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from math import log
from typing import Any

from sqlalchemy import Select, func, select

from kbe.rows import CORRECTION
from kbe.schema import DECIDED, correction, decision
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
