"""Result of ``kbe corrections``, ``accept`` and ``withdraw``: corrections and decisions."""

from collections.abc import Sequence
from dataclasses import dataclass

from kbe.factor import interval
from kbe.queries import Standing, StoredCorrection
from service.knowledge.columns import CORRECTION_COLUMNS
from service.knowledge.evaluation_columns import factor
from service.rendering.columns import Column
from service.rendering.view import ResultView, Table
from service.verbs.result import Result


def _columns(in_force: frozenset[int]) -> tuple[Column[StoredCorrection], ...]:
    return (
        Column(heading="id", value=lambda entry: entry.id),
        Column(
            heading="standing",
            value=lambda entry: "in force" if entry.id in in_force else entry.standing.value,
        ),
        Column(heading="machine", value=lambda entry: entry.correction.context.machine),
        Column(heading="material", value=lambda entry: entry.correction.context.material),
        Column(heading="tool", value=lambda entry: entry.correction.context.tool),
        Column(heading="k_c factor", value=lambda entry: factor(interval(entry.correction))),
        Column(
            heading="confidence", form=".2f", value=lambda entry: entry.correction.confidence
        ),
        Column(heading="outcomes", value=lambda entry: entry.correction.outcomes),
        Column(heading="proposed", value=lambda entry: entry.correction.proposed_at),
        Column(heading="decided by", value=lambda entry: entry.decided_by),
        Column(heading="decided", value=lambda entry: entry.decided_at),
    )


def _in_force(entries: Sequence[StoredCorrection]) -> frozenset[int]:
    """Ids of the corrections in force: the one accepted last in each context."""
    accepted = [each for each in entries if each.standing is Standing.ACCEPTED]
    accepted.sort(key=lambda each: each.decided_at or each.correction.proposed_at)
    return frozenset({each.correction.context: each.id for each in accepted}.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionsResult(Result):
    """Corrections with their latest decisions."""

    entries: Sequence[StoredCorrection]

    def view(self) -> ResultView:
        """Return a line for each correction; in the columns of the database for programs."""
        columns = _columns(_in_force(self.entries))
        return ResultView([
            Table(
                key="corrections", columns=CORRECTION_COLUMNS, rows=self.entries,
                is_shown=False,
            ),
            *([Table(columns=columns, rows=self.entries)] if self.entries else []),
        ])  # fmt: skip
