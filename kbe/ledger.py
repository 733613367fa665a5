"""Corrections and what was decided about them: the queries.

A decision never changes what it is about: it is a row of its own, and the latest one counts.
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
    """State of a correction: the last decision about it."""

    PROPOSED = "proposed"
    ACCEPTED = "accepted"
    WITHDRAWN = "withdrawn"


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredCorrection:
    """A correction as the knowledge base has it."""

    id: int
    correction: LearnedCorrection
    """with who accepted it and when, while it is accepted"""
    standing: Standing
    decided_by: str
    """person who accepted or withdrew it last; empty: none yet"""
    decided_at: datetime | None


GREATEST_LOG = log(20.0)
"""of a factor on k_c, either way: beyond is no material"""

_LATEST = select(func.max(decision.c.id)).group_by(decision.c.correction_id)
_LAST = select(decision).where(decision.c.id.in_(_LATEST)).subquery("last_decision")
"""the latest decision about each correction"""


def entries() -> "Select[Any]":
    """Query of all corrections in the order of their proposal."""
    stored = [correction.c[leaf.name] for leaf in CORRECTION.leaves if leaf.name not in DECIDED]
    return (
        select(correction.c.id, _LAST.c.kind, _LAST.c.decided_by, _LAST.c.decided_at, *stored)
        .select_from(correction.outerjoin(_LAST, _LAST.c.correction_id == correction.c.id))
        .order_by(correction.c.id)
    )


def in_force(context: Context) -> "Select[Any]":
    """Query of the one correction that was accepted last for a context."""
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
    """The entry of a row of :func:`entries`."""
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
    """Refuse what no learning proposes: somebody else has written it.

    Raises
    ------
    ValueError
        With what is wrong.
    """
    is_sound = (
        abs(learned.log_centre) <= GREATEST_LOG
        and 0.0 < learned.log_scale <= GREATEST_LOG
        and learned.degrees > 0.0
        and 0.0 <= learned.confidence <= 1.0
    )
    if not is_sound:
        raise ValueError(f"correction {id_} was not proposed by a review: {learned}")
