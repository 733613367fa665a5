"""Outcomes, corrections and reviews as JSON. Keys carry their units; others parse them.

Canonical units, as in the database and in exports.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import TYPE_CHECKING, Any

from kbe.backup import Content
from kbe.factor import interval
from kbe.ledger import Entry
from kbe.rows import OUTCOME
from service.flat_file import Row
from service.knowledge.export import correction_rows
from service.knowledge.verbs import Listing
from service.wire import dump
from stepnc_model.outcome import Context, Correction, ProcessOutcome

if TYPE_CHECKING:
    from service.knowledge.review import Reviewed


def listing_json(listing: Listing) -> str:
    """Outcomes, newest first, and how many there are of which these are some."""
    return dump({
        "total": listing.total,
        "outcomes": [_plain(OUTCOME.row(each)) for each in listing.outcomes],
    })


def run_json(outcomes: Sequence[ProcessOutcome]) -> str:
    """One run in full, with the deviations."""
    return dump({
        "run": outcomes[0].run,
        "outcomes": [
            {**_plain(OUTCOME.row(each)), "deviations": _deviations(each)} for each in outcomes
        ],
    })


def corrections_json(entries: Sequence[Entry]) -> str:
    """Corrections with what was decided last about them."""
    return dump({"corrections": [_plain(row) for row in correction_rows(entries)]})


def review_json(found: "Sequence[Reviewed]") -> str:
    """What a review found, context by context."""
    return dump({"contexts": [_reviewed(each) for each in found]})


def content_json(content: Content, *, place: str) -> str:
    """What a knowledge base holds."""
    return dump({
        "place": place,
        "outcomes": content.outcomes,
        "corrections": content.corrections,
        "decisions": content.decisions,
        "fingerprint": content.fingerprint,
    })


def _reviewed(found: "Reviewed") -> dict[str, Any]:
    report = found.learned.report
    return {
        **_context(found.learned.context),
        "change": found.change.value,
        "correction": None if found.entry is None else _entry(found.entry),
        "in_force": None if found.accepted is None else _factor(found.accepted),
        "runs": report.runs,
        "outcomes_used": report.used,
        "left_out": {reason.value: count for reason, count in report.left_out.items()},
        "effective_runs": report.effective_runs,
        "scatter": report.scatter,
        "objections": [
            {"ground": each.ground.value, "message": each.message} for each in found.objections
        ],
    }


def _entry(entry: Entry) -> dict[str, Any]:
    return _plain(next(iter(correction_rows([entry]))))


def _factor(correction: Correction) -> dict[str, Any]:
    found = interval(correction)
    at = correction.accepted_at
    return {
        "factor": found.centre,
        "factor_low": found.low,
        "factor_high": found.high,
        "outcomes": correction.outcomes,
        "accepted_by": correction.accepted_by,
        "accepted_at": None if at is None else at.isoformat(),
    }


def _context(context: Context) -> dict[str, str]:
    return {"machine": context.machine, "material": context.material, "tool": context.tool}


def _deviations(outcome: ProcessOutcome) -> dict[str, float | None]:
    return {
        "roughness": outcome.roughness.deviation,
        "time": outcome.time.deviation,
        "force": outcome.force.deviation,
        "feed": outcome.feed.deviation,
    }


def _plain(row: Row) -> dict[str, Any]:
    """Times as JSON knows them."""
    return {
        name: value.isoformat() if isinstance(value, datetime) else value
        for name, value in row.items()
    }
