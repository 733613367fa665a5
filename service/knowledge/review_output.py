"""Results of a knowledge base review as text and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from kbe.factor import interval
from kbe.ledger import StoredCorrection
from service.knowledge.evaluation_columns import factor
from service.knowledge.export import correction_rows
from service.knowledge.output import NOTHING
from service.knowledge.review import Reviewed, ReviewResult
from service.rendering.columns import shown
from service.rendering.records import dump, plain
from service.rendering.text import GREEN, one_line, print_line
from stepnc_model.outcome import LearnedCorrection


def print_review(found: Sequence[Reviewed]) -> None:
    """Print a paragraph for each context."""
    for each in found:
        names = " / ".join(map(one_line, asdict(each.learned.context).values()))
        number = NOTHING if each.entry is None else each.entry.id
        print_line(
            f"{number}  {names}: {each.change.value}",
            GREEN if each.change is ReviewResult.ACCEPTED else "",
        )
        for text in _findings(each):
            print_line(f"    {text}")


def _findings(found: Reviewed) -> list[str]:
    """Learned factor, its data, the factor in force, and objections, one text each."""
    report, texts = found.learned.report, []
    if found.entry is not None:
        correction = found.entry.correction
        texts.append(
            f"k_c factor {factor(interval(correction))}, 90 % interval of the next run; "
            f"confidence {correction.confidence:.2f}; {_decided(found.entry)}"
        )
    texts.append(f"from {report.used} outcomes of {report.runs} runs")
    if report.left_out:
        why = ", ".join(f"{count} {reason.value}" for reason, count in report.left_out.items())
        texts.append(f"left out: {why}")
    before = "the catalogue's k_c"
    if found.accepted is not None:
        by = one_line(found.accepted.accepted_by)
        before = f"{factor(interval(found.accepted))}, accepted by {by}"
    texts.append(f"in force before: {before}")
    texts += [f"needs a person's decision: {each}" for each in found.objections]
    return texts


def _decided(entry: StoredCorrection) -> str:
    if entry.decided_at is None:
        return entry.standing.value
    by = one_line(entry.decided_by)
    return f"{entry.standing.value} by {by} on {shown(entry.decided_at)}"


def review_json(found: Sequence[Reviewed]) -> str:
    """Return the results of a review as JSON, one object per context."""
    return dump({"contexts": [_reviewed(each) for each in found]})


def _reviewed(found: Reviewed) -> dict[str, Any]:
    report = found.learned.report
    entries = [] if found.entry is None else [found.entry]
    return {
        **asdict(found.learned.context),
        "change": found.change.value,
        "correction": next(map(plain, correction_rows(entries)), None),
        "in_force": None if found.accepted is None else _factor(found.accepted),
        "runs": report.runs,
        "outcomes_used": report.used,
        "left_out": {reason.value: count for reason, count in report.left_out.items()},
        "effective_runs": report.effective_runs,
        "scatter": report.scatter,
        "objections": [asdict(each) for each in found.objections],
    }


def _factor(correction: LearnedCorrection) -> dict[str, Any]:
    found = interval(correction)
    return {
        "factor": found.centre,
        "factor_low": found.low,
        "factor_high": found.high,
        "outcomes": correction.outcomes,
        "accepted_by": correction.accepted_by,
        "accepted_at": plain(correction.accepted_at),
    }
