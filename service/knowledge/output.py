"""Outcomes and corrections as text, in the user's units, and as JSON.

JSON keys carry their units, which are canonical as in the database and in exports; they never
change, because other programs read them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import exp

from kbe.backup import Content
from kbe.factor import interval
from kbe.ledger import Standing, StoredCorrection
from kbe.rows import OUTCOME
from kbe.statistics import Evaluated, quantity_of
from service.knowledge.evaluation_columns import factor
from service.knowledge.export import correction_rows
from service.knowledge.verbs import Listing
from service.rendering.columns import Column, shown, visible
from service.rendering.records import dump, plain
from service.rendering.text import GREEN, one_line, print_line, print_table
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from stepnc_model.units import m_min_from_speed, mm_min_from_speed, um_from_mm

NOTHING = "–"
"""Text for unknown values."""

Quantity = Callable[[ProcessOutcome], EvaluatedQuantity]
"""Function that returns a quantity of an outcome, in the user's unit."""

EVALUATED: Mapping[str, Quantity] = {
    "Ra µm": lambda each: _scaled(each.roughness, um_from_mm(1.0)),
    "time s": lambda each: each.time,
    "force N": lambda each: each.force,
    "feed mm/min": lambda each: _scaled(each.feed, mm_min_from_speed(1.0)),
}
"""The four evaluated quantities, by their headings."""

QUANTITIES: Mapping[str, Quantity] = {
    **EVALUATED,
    "feed per tooth mm": lambda each: each.feed_per_tooth,
    "step depth mm": lambda each: each.step_depth,
}
"""All quantities with a planned and a measured value, by their headings."""


def _scaled(quantity: EvaluatedQuantity, by: float) -> EvaluatedQuantity:
    """Convert planned and measured value to another unit."""
    predicted, measured = quantity.predicted, quantity.measured
    return EvaluatedQuantity(
        predicted=None if predicted is None else predicted * by,
        measured=None if measured is None else measured * by,
    )


def told(quantity: EvaluatedQuantity) -> str:
    """Return the text of a cell: planned, measured and deviation."""
    values = (quantity.predicted, quantity.measured)
    if values == (None, None):
        return ""
    share = quantity.deviation
    pair = " -> ".join(shown(each, ".3g", nothing=NOTHING) for each in values)
    return pair if share is None else f"{pair} ({100.0 * share:+.0f} %)"


def _told(of: Quantity) -> Callable[[ProcessOutcome], str]:
    return lambda outcome: told(of(outcome))


LISTING: tuple[Column[ProcessOutcome], ...] = (
    Column(heading="recorded", value=lambda each: each.recorded_at, is_key=True),
    Column(heading="run", value=lambda each: each.run, is_key=True),
    Column(heading="machine", value=lambda each: each.context.machine),
    Column(heading="material", value=lambda each: each.context.material),
    Column(heading="tool", value=lambda each: each.context.tool),
    Column(heading="program", value=lambda each: each.program),
    Column(heading="workingstep", value=lambda each: each.workingstep),
    Column(heading="mode", value=lambda each: each.mode),
    *(Column(heading=heading, value=_told(of)) for heading, of in EVALUATED.items()),
)

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
        f"{ratio.readings} readings"
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


def print_listing(listing: Listing) -> None:
    """Print a line for each outcome, newest first."""
    print_table(LISTING, listing.outcomes)
    print_line(
        f"{len(listing.outcomes)} of {listing.total} outcomes; planned -> measured, and "
        "deviation"
    )


def listing_json(listing: Listing) -> str:
    """Return the listed outcomes, newest first, and the total number, as JSON."""
    return dump({
        "total": listing.total,
        "outcomes": [plain(OUTCOME.row(each)) for each in listing.outcomes],
    })


def print_run(outcomes: Sequence[ProcessOutcome]) -> None:
    """Print a run in full: each workingstep with all planned and measured values."""
    first = outcomes[0]
    print_line(
        f"run {one_line(first.run)}: {one_line(first.program)}, {len(outcomes)} workingsteps, "
        f"recorded by {one_line(first.recorded_by)}"
    )
    for each in outcomes:
        print_line("")
        print_line(f"{one_line(each.workingstep)} ({shown(each.recorded_at)})", GREEN)
        print_table(RUN, [(name, of(each)) for name, of in QUANTITIES.items()], nothing=NOTHING)
        for fact in visible(FACTS, [each]):
            print_line(f"  {fact.heading}: {one_line(fact.text(each))}")


def run_json(outcomes: Sequence[ProcessOutcome]) -> str:
    """Return a run in full as JSON, including the deviations."""
    return dump({
        "run": outcomes[0].run,
        "outcomes": [
            {
                **plain(OUTCOME.row(each)),
                "deviations": {
                    which.value: quantity_of(each, which).deviation for which in Evaluated
                },
            }
            for each in outcomes
        ],
    })


def print_corrections(entries: Sequence[StoredCorrection]) -> None:
    """Print a line for each correction."""
    print_table(_correction_columns(_in_force(entries)), entries)


def _correction_columns(in_force: frozenset[int]) -> tuple[Column[StoredCorrection], ...]:
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


def corrections_json(entries: Sequence[StoredCorrection]) -> str:
    """Return corrections with their latest decisions as JSON."""
    return dump({"corrections": [plain(row) for row in correction_rows(entries)]})


def print_content(content: Content, *, place: str) -> None:
    """Print the numbers of entries in a knowledge base, and its fingerprint."""
    print_line(
        f"{place}: {content.outcomes} outcomes, {content.corrections} corrections, "
        f"{content.decisions} decisions"
    )
    print_line(f"fingerprint {content.fingerprint}")


def content_json(content: Content, *, place: str) -> str:
    """Return the numbers of entries in a knowledge base, and its fingerprint, as JSON."""
    return dump({"place": place, **asdict(content)})
