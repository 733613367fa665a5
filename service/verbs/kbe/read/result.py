"""Result of ``kbe read``: outcomes and corrections of a program, in file order."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.rendering.columns import Column
from service.rendering.view import ResultView, Table, TextLine
from service.verbs.kbe.quantities import NOTHING
from service.verbs.result import Result
from stepnc_model.editing.outcome_record import RecordedCorrection, RecordedOutcome
from stepnc_model.plurals import counted
from stepnc_model.units import mm_min_from_speed, um_from_mm

OUTCOMES: tuple[Column[RecordedOutcome], ...] = (
    Column(key="operation", value=lambda each: int(each.operation)),
    Column(
        key="workingsteps", heading="workingstep", value=lambda each: list(each.workingsteps)
    ),
    Column(
        key="measured_at",
        heading="measured",
        value=lambda each: each.measured_at,
    ),
    Column(key="time_s", heading="time s", form=".4g", value=lambda each: each.time),
    Column(key="force_n", heading="force N", form=".4g", value=lambda each: each.force),
    Column(
        key="feed_mm_min",
        heading="feed mm/min",
        form=".4g",
        value=lambda each: None if each.feed is None else mm_min_from_speed(each.feed),
    ),
    Column(
        key="roughness_um",
        heading="Ra µm",
        form=".4g",
        value=lambda each: None if each.roughness is None else um_from_mm(each.roughness),
    ),
    Column(key="trace", heading="trace", value=lambda each: each.trace),
)

CORRECTIONS: tuple[Column[RecordedCorrection], ...] = (
    Column(key="machine", heading="machine", value=lambda each: each.context.machine),
    Column(key="material", heading="material", value=lambda each: each.context.material),
    Column(key="tool", heading="tool", value=lambda each: each.context.tool),
    Column(
        key="force_factor", heading="k_c factor", form=".4g", value=lambda each: each.factor
    ),
    Column(
        key="confidence", heading="confidence", form=".3g", value=lambda each: each.confidence
    ),
    Column(key="accepted_by", heading="accepted by", value=lambda each: each.accepted_by),
    Column(key="valid_from", heading="valid from", value=lambda each: each.valid_from),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedResult(Result):
    """Outcomes and corrections stored in a program."""

    outcomes: Sequence[RecordedOutcome]
    corrections: Sequence[RecordedCorrection]

    def view(self) -> ResultView:
        """Return two tables."""
        outcomes, corrections = self.outcomes, self.corrections
        count = counted(len(outcomes), "outcome")
        return ResultView([
            TextLine(text=f"{count}, {counted(len(corrections), 'correction')}"),
            Table(
                key="outcomes", columns=OUTCOMES, rows=outcomes, nothing=NOTHING,
                is_shown=bool(outcomes),
            ),
            Table(
                key="corrections", columns=CORRECTIONS, rows=corrections, nothing=NOTHING,
                is_shown=bool(corrections),
            ),
        ])  # fmt: skip
