"""Review of the knowledge base: learn from outcomes and propose new or changed corrections.

No proposal affects a plan before it is accepted: by a person, or automatically if requested and
within the bounds of :mod:`kbe.acceptance`.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from enum import StrEnum
from math import expm1

from kbe.acceptance import AcceptanceBounds, Objection, objections
from kbe.corrections import LearnedFactor, learned
from kbe.queries import Selection, Standing, StoredCorrection
from kbe.store import Store
from service.knowledge.verbs import readable
from service.requests.knowledge import ReviewRequest
from stepnc_model.outcome import Context, LearnedCorrection


@dataclass(frozen=True, slots=True, kw_only=True)
class Acceptance:
    """Settings for accepting corrections automatically."""

    by: str = ""
    """Person who requests automatic acceptance; empty: nobody."""
    bounds: AcceptanceBounds = field(default_factory=AcceptanceBounds)


PROPOSE = Acceptance()
"""Settings that accept nothing automatically."""


class ReviewResult(StrEnum):
    """Result of a review for one context."""

    NOTHING_TO_LEARN = "nothing to learn from"
    PROPOSED = "proposed"
    UNCHANGED = "unchanged"
    ACCEPTED = "accepted"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reviewed:
    """Review of one context."""

    learned: LearnedFactor
    change: ReviewResult
    entry: StoredCorrection | None
    """Stored correction with the learned factor; None: nothing to learn from."""
    accepted: LearnedCorrection | None
    """Correction in force before the review."""
    objections: tuple[Objection, ...]
    """Objections to automatic acceptance."""


SAME = 0.005
"""Change of the factor below which nothing is proposed, unless there are more outcomes."""

AUTOMATIC = "{by} (automatically)"
"""Name recorded as the decider of an automatic acceptance."""


def review(
    place: str, request: ReviewRequest, acceptance: Acceptance = PROPOSE
) -> tuple[Reviewed, ...]:
    """Learn from outcomes and propose new or changed corrections, for each context."""
    with readable(place) as store:
        if store is None:
            return ()
        latest = {entry.correction.context: entry for entry in store.corrections()}
        now = datetime.now(UTC)
        found = [
            _reviewed(store, each, latest.get(each.context), acceptance=acceptance)
            for each in _learned(store, request.selection, at=now)
        ]
        return tuple(found)


def _learned(store: Store, selection: Selection, *, at: datetime) -> Iterator[LearnedFactor]:
    """Learn from one context at a time, so that only its outcomes are in memory."""
    for context in store.contexts():
        narrowed = narrowed_to(context, selection)
        if narrowed is not None:
            yield from learned(store.outcomes(narrowed), at=at)


def narrowed_to(context: Context, selection: Selection) -> Selection | None:
    """Return the selection limited to a context; None if they have nothing in common."""
    names = ("machine", "material", "tool")
    asked = [getattr(selection, name) for name in names]
    given = [getattr(context, name) for name in names]
    if any(one not in {None, other} for one, other in zip(asked, given, strict=True)):
        return None
    return replace(
        selection, machine=context.machine, material=context.material, tool=context.tool
    )


def _reviewed(
    store: Store,
    factor: LearnedFactor,
    latest: StoredCorrection | None,
    *,
    acceptance: Acceptance,
) -> Reviewed:
    """Propose a learned factor; accept it if requested and there are no objections."""
    accepted = store.accepted(factor.context)
    proposed = factor.correction
    if proposed is None:
        return Reviewed(
            learned=factor,
            change=ReviewResult.NOTHING_TO_LEARN,
            entry=None,
            accepted=accepted,
            objections=(),
        )
    entry, change = latest, ReviewResult.UNCHANGED
    if entry is None or is_changed(proposed, entry.correction):
        entry, change = _proposed(store, proposed), ReviewResult.PROPOSED
    against = objections(proposed, accepted, bounds=acceptance.bounds)
    # Decisions of a person are never changed automatically.
    if acceptance.by and not against and entry.standing is Standing.PROPOSED:
        by, at = AUTOMATIC.format(by=acceptance.by), datetime.now(UTC)
        store.accept(entry.id, by=by, at=at)
        taken = replace(entry.correction, accepted_by=by, accepted_at=at)
        entry = replace(
            entry, correction=taken, standing=Standing.ACCEPTED, decided_by=by, decided_at=at
        )
        change = ReviewResult.ACCEPTED
    return Reviewed(
        learned=factor, change=change, entry=entry, accepted=accepted, objections=against
    )


def is_changed(proposed: LearnedCorrection, before: LearnedCorrection) -> bool:
    """True if a proposal differs from the last one."""
    change = abs(expm1(proposed.log_centre - before.log_centre))
    return proposed.outcomes > before.outcomes or change > SAME


def _proposed(store: Store, proposed: LearnedCorrection) -> StoredCorrection:
    """Store a proposal."""
    return StoredCorrection(
        id=store.propose(proposed),
        correction=proposed,
        standing=Standing.PROPOSED,
        decided_by="",
        decided_at=None,
    )
