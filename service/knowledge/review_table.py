"""A review of the knowledge base on a terminal."""

from collections.abc import Sequence

from kbe.factor import interval
from kbe.ledger import Entry
from service.knowledge.evaluation_cells import factor
from service.knowledge.evaluation_table import plain
from service.knowledge.review import Change, Reviewed
from service.knowledge.table import GREEN, local
from service.tables import print_line
from stepnc_model.outcome import Correction


def print_review(found: Sequence[Reviewed]) -> None:
    """A paragraph for each context."""
    for each in found:
        context = each.learned.context
        print_line(
            f"{_id(each.entry)}{plain(context.machine)} / {plain(context.material)} / "
            f"{plain(context.tool)}: {each.change.value}",
            GREEN if each.change is Change.ACCEPTED else "",
        )
        for text in _findings(each):
            print_line(f"    {text}")


def _id(entry: Entry | None) -> str:
    return "–  " if entry is None else f"{entry.id}  "


def _findings(found: Reviewed) -> list[str]:
    """What was learned, from what, what is in force, and what speaks against it."""
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
    texts.append(f"in force before: {_in_force(found.accepted)}")
    texts += [f"not without a person: {each}" for each in found.objections]
    return texts


def _decided(entry: Entry) -> str:
    if entry.decided_at is None:
        return entry.standing.value
    return f"{entry.standing.value} by {plain(entry.decided_by)} on {local(entry.decided_at)}"


def _in_force(accepted: Correction | None) -> str:
    if accepted is None:
        return "the catalogue's k_c"
    return f"{factor(interval(accepted))}, accepted by {plain(accepted.accepted_by)}"
