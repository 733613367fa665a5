"""Result of ``kbe review``: a paragraph for each context."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from kbe.factor import interval
from kbe.queries import StoredCorrection
from service.knowledge.columns import CORRECTION_COLUMNS
from service.knowledge.evaluation_columns import factor
from service.knowledge.review import Reviewed, ReviewResult
from service.rendering.columns import plain, record, shown
from service.rendering.text import GREEN, one_line
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.kbe.quantities import NOTHING
from service.verbs.result import Result
from stepnc_model.outcome import LearnedCorrection
from stepnc_model.plurals import counted


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewReport(Result):
    """Learned and proposed corrections, by context."""

    contexts: Sequence[Reviewed]

    def view(self) -> ResultView:
        """Return a paragraph for each context."""
        return ResultView([
            Fact(key="contexts", value=[_reviewed(each) for each in self.contexts]),
            *(line for each in self.contexts for line in _paragraph(each)),
        ])


def _paragraph(reviewed: Reviewed) -> Iterator[TextLine]:
    names = " / ".join(map(one_line, asdict(reviewed.learned.context).values()))
    number = NOTHING if reviewed.entry is None else reviewed.entry.id
    is_accepted = reviewed.change is ReviewResult.ACCEPTED
    text = f"{number}  {names}: {reviewed.change.value}"
    yield TextLine(text=text, colour=GREEN if is_accepted else "")
    for line in _findings(reviewed):
        yield TextLine(text=f"    {line}")


def _findings(reviewed: Reviewed) -> list[str]:
    """Learned factor, its data, the factor in force, and objections, one text each."""
    report, texts = reviewed.learned.report, []
    if reviewed.entry is not None:
        correction = reviewed.entry.correction
        texts.append(
            f"k_c factor {factor(interval(correction))}, 90 % interval of the next run; "
            f"confidence {correction.confidence:.2f}; {_decided(reviewed.entry)}"
        )
    texts.append(f"from {counted(report.used, 'outcome')} of {counted(report.runs, 'run')}")
    if report.left_out:
        why = ", ".join(f"{count} {reason.value}" for reason, count in report.left_out.items())
        texts.append(f"left out: {why}")
    before = "the catalogue's k_c"
    if reviewed.accepted is not None:
        by = one_line(reviewed.accepted.accepted_by)
        before = f"{factor(interval(reviewed.accepted))}, accepted by {by}"
    texts.append(f"in force before: {before}")
    texts += [f"needs a person's decision: {each}" for each in reviewed.objections]
    return texts


def _decided(entry: StoredCorrection) -> str:
    if entry.decided_at is None:
        return entry.standing.value
    by = one_line(entry.decided_by)
    return f"{entry.standing.value} by {by} on {shown(entry.decided_at)}"


def _reviewed(reviewed: Reviewed) -> dict[str, Any]:
    report = reviewed.learned.report
    return {
        **asdict(reviewed.learned.context),
        "change": reviewed.change.value,
        "correction": reviewed.entry and record(CORRECTION_COLUMNS, reviewed.entry),
        "in_force": None if reviewed.accepted is None else _factor(reviewed.accepted),
        "runs": report.runs,
        "outcomes_used": report.used,
        "left_out": {reason.value: count for reason, count in report.left_out.items()},
        "effective_runs": report.effective_runs,
        "scatter": report.scatter,
        "objections": [asdict(each) for each in reviewed.objections],
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
