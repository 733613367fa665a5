"""The evaluation table as a user asks for it: what was planned, what it was, what to do.

The full table reads every outcome that is meant. The summary is made by the database itself:
counts, means and spreads only, but of a million outcomes in about a second.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime

from kbe.corrections import learned
from kbe.evaluation import (
    EvaluationRow,
    evaluation,
    ordered,
    selected,
)
from kbe.groups import Group
from kbe.selection import Selection
from kbe.side import Knowledge
from kbe.store import Store
from service.knowledge.verbs import readable, shown
from service.reading import Tell, silent
from service.requests.knowledge import EvaluationRequest
from stepnc_model.outcome import Context

MANY = 100_000
"""outcomes from which it takes so long that something is said"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationTable:
    """The table and what it was made from."""

    request: EvaluationRequest
    place: str
    """as people may see it"""
    outcomes: int
    """that were read"""
    rows: tuple[EvaluationRow, ...]
    """those that the filter keeps"""
    left_out: int
    """rows that it does not keep"""
    made_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Counts and spreads by machine, material, tool and kind of feature."""

    place: str
    groups: tuple[Group, ...]
    made_at: datetime


def table(place: str, request: EvaluationRequest, *, tell: Tell = silent) -> EvaluationTable:
    """Read the outcomes that are meant, and evaluate them.

    Factors are learned from all outcomes of a context, also from those that the selection
    leaves out: they hold for the context.

    Raises
    ------
    KnowledgeError
        When the knowledge base cannot be opened or read.
    """
    rows: tuple[EvaluationRow, ...] = ()
    outcomes = 0
    now = datetime.now(UTC)
    with readable(place) as store:
        if store is not None:
            outcomes = store.count(request.selection)
            if outcomes > MANY:
                tell(f"reading {outcomes} outcomes; --summary answers at once")
            rows = _rows(store, request, at=now)
    kept = ordered(selected(rows, request.only), request.sort)
    return EvaluationTable(
        request=request,
        place=shown(place),
        outcomes=outcomes,
        rows=kept,
        left_out=len(rows) - len(kept),
        made_at=now,
    )


def summary(place: str, selection: Selection) -> Summary:
    """Counts and spreads, made by the database; errors as :func:`table`."""
    with readable(place) as store:
        groups = () if store is None else store.groups(selection)
    return Summary(place=shown(place), groups=groups, made_at=datetime.now(UTC))


def _rows(
    store: Store, request: EvaluationRequest, *, at: datetime
) -> tuple[EvaluationRow, ...]:
    """The whole table."""
    present = {group.context for group in store.groups(request.selection)}
    return evaluation(
        store.outcomes(request.selection),
        grouping=request.grouping,
        knowledge=_knowledge(store, present, at=at),
    )


def _knowledge(store: Store, contexts: Iterable[Context], *, at: datetime) -> Knowledge:
    """Learned factors and those in force; one context after the other in memory."""
    proposed, accepted = {}, {}
    for context in contexts:
        within = Selection(
            machine=context.machine, material=context.material, tool=context.tool
        )
        for each in learned(store.outcomes(within), at=at):
            if each.correction is not None:
                proposed[context] = each.correction
        in_force = store.accepted(context)
        if in_force is not None:
            accepted[context] = in_force
    return Knowledge(proposed=proposed, accepted=accepted)
