"""Evaluation table of recorded outcomes: planned and measured values, and recommended actions.

The full table reads every selected outcome. The summary is computed by the database itself:
only counts, means and spreads, but of a million outcomes in about a second.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime

from kbe.corrections import learned
from kbe.evaluation import EvaluationRow, Knowledge, evaluation, ordered, selected
from kbe.queries import Group, Selection
from kbe.store import Store
from service.knowledge.verbs import readable, shown
from service.progress import Tell, silent
from service.requests.knowledge import EvaluationRequest
from stepnc_model.outcome import Context
from stepnc_model.plurals import counted

MANY = 100_000
"""Number of outcomes above which a progress message is shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationTable:
    """Evaluation table, with the request and data that it was made from."""

    request: EvaluationRequest
    place: str
    """Location of the knowledge base for display."""
    outcomes: int
    """Number of outcomes read."""
    rows: tuple[EvaluationRow, ...]
    """Rows that pass the filter."""
    left_out: int
    """Number of rows that the filter removed."""
    made_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Counts and spreads by machine, material, tool and kind of feature."""

    place: str
    groups: tuple[Group, ...]
    made_at: datetime


def table(place: str, request: EvaluationRequest, *, tell: Tell = silent) -> EvaluationTable:
    """Read the selected outcomes and evaluate them.

    Factors are learned from all outcomes of a context, including those outside the selection,
    because they hold for the whole context.

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
                tell(
                    f"reading {counted(outcomes, 'outcome')}; use --summary for a fast overview"
                )
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
    """Counts and spreads computed by the database; raises the same errors as :func:`table`."""
    with readable(place) as store:
        groups = () if store is None else store.groups(selection)
    return Summary(place=shown(place), groups=groups, made_at=datetime.now(UTC))


def _rows(
    store: Store, request: EvaluationRequest, *, at: datetime
) -> tuple[EvaluationRow, ...]:
    """Return all rows of the table, before filtering."""
    present = {group.context for group in store.groups(request.selection)}
    return evaluation(
        store.outcomes(request.selection),
        grouping=request.grouping,
        knowledge=_knowledge(store, present, at=at),
    )


def _knowledge(store: Store, contexts: Iterable[Context], *, at: datetime) -> Knowledge:
    """Return learned and accepted factors; only one context at a time is in memory."""
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
