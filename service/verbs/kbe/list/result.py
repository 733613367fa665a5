"""Result of ``kbe list``: outcomes, newest first."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.knowledge.columns import OUTCOME_COLUMNS
from service.rendering.columns import Column
from service.rendering.view import Fact, Item, ResultView, Table, TextLine
from service.verbs.kbe.quantities import EVALUATED, quantity_text
from service.verbs.result import Result
from stepnc_model.outcome import ProcessOutcome
from stepnc_model.plurals import counted

LISTING: tuple[Column[ProcessOutcome], ...] = (
    Column(heading="recorded", value=lambda each: each.recorded_at, is_key=True),
    Column(heading="run", value=lambda each: each.run, is_key=True),
    Column(heading="machine", value=lambda each: each.context.machine),
    Column(heading="material", value=lambda each: each.context.material),
    Column(heading="tool", value=lambda each: each.context.tool),
    Column(heading="program", value=lambda each: each.program),
    Column(heading="workingstep", value=lambda each: each.workingstep),
    Column(heading="mode", value=lambda each: each.mode),
    *(Column(heading=name, value=quantity_text(of)) for name, of in EVALUATED.items()),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class OutcomesResult(Result):
    """Latest outcomes of a selection."""

    outcomes: Sequence[ProcessOutcome]
    total: int
    """Number of all outcomes of the selection."""

    def view(self) -> ResultView:
        """Return a line for each outcome; in canonical units for programs."""
        count = f"{len(self.outcomes)} of {counted(self.total, 'outcome')}"
        note = TextLine(text=f"{count}; planned -> measured, and deviation")
        shown: list[Item] = [Table(columns=LISTING, rows=self.outcomes), note]
        return ResultView([
            Fact(key="total", value=self.total),
            Table(key="outcomes", columns=OUTCOME_COLUMNS, rows=self.outcomes, is_shown=False),
            *(shown if self.total else []),
        ])
