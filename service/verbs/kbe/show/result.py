"""Result of ``kbe show``: a run, with all planned and measured values of a workingstep."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import exp

from kbe.statistics import Evaluated, quantity_of
from service.knowledge.columns import OUTCOME_COLUMNS
from service.rendering.columns import Column, shown, visible
from service.rendering.text import GREEN, one_line
from service.rendering.view import Fact, Item, ResultView, Table, TextLine
from service.verbs.kbe.quantities import EVALUATED, NOTHING, Quantity
from service.verbs.result import Result
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from stepnc_model.plurals import counted
from stepnc_model.units import m_min_from_speed

QUANTITIES: Mapping[str, Quantity] = {
    **EVALUATED,
    "feed per tooth mm": lambda each: each.feed_per_tooth,
    "step depth mm": lambda each: each.step_depth,
}
"""All quantities with a planned and a measured value, by their headings."""

RUN: tuple[Column[tuple[str, EvaluatedQuantity]], ...] = (
    Column(heading="quantity", value=lambda row: row[0]),
    Column(heading="planned", form=".4g", value=lambda row: row[1].predicted),
    Column(heading="measured", form=".4g", value=lambda row: row[1].measured),
    Column(
        heading="deviation %",
        form="+.1f",
        value=lambda row: None if row[1].deviation is None else 100.0 * row[1].deviation,
    ),
)


def _feature(outcome: ProcessOutcome) -> str:
    feature = outcome.feature
    sizes = {"L": feature.length, "X": feature.width, "a_t": feature.total_depth}
    size = ", ".join(
        f"{name} {shown(value, '.3g', nothing=NOTHING)}" for name, value in sizes.items()
    )
    return f"{one_line(feature.id)}, {one_line(feature.kind)}: {size} mm"


def _operation(outcome: ProcessOutcome) -> str:
    return (
        f"{'finishing' if outcome.is_finishing else 'roughing'}, mode "
        f"{one_line(outcome.mode)}, strategy {one_line(outcome.strategy)}, "
        f"immersion {outcome.immersion or NOTHING}"
    )


def _cutting_speed(outcome: ProcessOutcome) -> float | None:
    speed = outcome.cutting_speed
    return None if speed is None else m_min_from_speed(speed)


def _force_ratio(outcome: ProcessOutcome) -> str | None:
    ratio = outcome.force_ratio
    if ratio is None:
        return None
    return (
        f"{exp(ratio.log_mean):.3f} ± {100.0 * ratio.log_deviation:.1f} % a reading, "
        f"{counted(ratio.readings, 'reading')}"
    )


FACTS: tuple[Column[ProcessOutcome], ...] = (
    Column(
        heading="machine, material, tool",
        value=lambda each: list(asdict(each.context).values()),
    ),
    Column(heading="feature", value=_feature),
    Column(heading="operation", value=_operation),
    Column(
        heading="k_c1.1 of the catalogue, N/mm²",
        form=".4g",
        value=lambda each: each.specific_force,
    ),
    Column(heading="cutting speed, m/min", form=".3g", value=_cutting_speed),
    Column(heading="force bound, N", form=".3g", value=lambda each: each.force_bound),
    Column(heading="samples", value=lambda each: each.trace),
    Column(heading="force, measured over expected", value=_force_ratio, is_optional=True),
)
"""Further facts about an outcome, shown as lines of text."""


def _deviation(which: Evaluated) -> Column[ProcessOutcome]:
    return Column(
        key=f"deviations.{which.value}",
        value=lambda outcome: quantity_of(outcome, which).deviation,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult(Result):
    """Outcomes of a run, in order of time; at least one."""

    outcomes: Sequence[ProcessOutcome]

    def view(self) -> ResultView:
        """Return a table and facts of each workingstep."""
        first = self.outcomes[0]
        title = (
            f"run {one_line(first.run)}: {one_line(first.program)}, "
            f"{counted(len(self.outcomes), 'workingstep')}, "
            f"recorded by {one_line(first.recorded_by)}"
        )
        columns = (*OUTCOME_COLUMNS, *map(_deviation, Evaluated))
        return ResultView([
            Fact(key="run", value=first.run),
            TextLine(text=title),
            Table(key="outcomes", columns=columns, rows=self.outcomes, is_shown=False),
            *(item for each in self.outcomes for item in _workingstep(each)),
        ])


def _workingstep(outcome: ProcessOutcome) -> Iterator[Item]:
    name = one_line(outcome.workingstep)
    yield TextLine(text="")
    yield TextLine(text=f"{name} ({shown(outcome.recorded_at)})", colour=GREEN)
    rows = [(name, of(outcome)) for name, of in QUANTITIES.items()]
    yield Table(columns=RUN, rows=rows, nothing=NOTHING)
    for fact in visible(FACTS, [outcome]):
        yield TextLine(text=f"  {fact.heading}: {one_line(fact.text(outcome))}")
