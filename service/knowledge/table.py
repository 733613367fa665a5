"""Outcomes and corrections on a terminal, in the user's units."""

from collections.abc import Sequence
from datetime import datetime
from math import exp

from kbe.backup import Content
from kbe.factor import interval
from kbe.ledger import Entry, Standing
from service.knowledge.evaluation_cells import NOTHING, factor, number
from service.knowledge.evaluation_table import plain
from service.knowledge.verbs import Listing
from service.tables import print_line, print_table
from stepnc_model.outcome import Context, ProcessOutcome, Quantity
from stepnc_model.units import m_min_from_speed, mm_min_from_speed, um_from_mm

GREEN = "32"


def print_listing(listing: Listing) -> None:
    """A line for each outcome, newest first."""
    header = (
        "recorded", "run", "machine", "material", "tool", "program", "workingstep", "mode",
        "Ra µm", "time s", "force N", "feed mm/min",
    )  # fmt: skip
    rows = [
        (
            local(each.recorded_at),
            *map(plain, (each.run, each.context.machine, each.context.material)),
            *map(plain, (each.context.tool, each.program, each.workingstep, each.mode)),
            *(told(quantity) for _, quantity in evaluated(each)),
        )
        for each in listing.outcomes
    ]
    print_table(header, rows)
    print_line(f"{len(rows)} of {listing.total} outcomes; planned -> measured, and deviation")


def print_run(outcomes: Sequence[ProcessOutcome]) -> None:
    """One run in full: every workingstep with all that was planned and measured."""
    first = outcomes[0]
    print_line(
        f"run {plain(first.run)}: {plain(first.program)}, {len(outcomes)} workingsteps, "
        f"recorded by {plain(first.recorded_by)}"
    )
    for each in outcomes:
        print_line("")
        print_line(f"{plain(each.workingstep)} ({local(each.recorded_at)})", GREEN)
        print_table(("quantity", "planned", "measured", "deviation %"), _quantities(each))
        for name, value in _facts(each):
            print_line(f"  {name}: {value}")


def print_corrections(entries: Sequence[Entry]) -> None:
    """A line for each correction."""
    header = (
        "id", "standing", "machine", "material", "tool", "k_c factor", "confidence",
        "outcomes", "proposed", "decided by", "decided",
    )  # fmt: skip
    holding = _in_force(entries)
    rows = [
        (
            str(entry.id),
            "in force" if entry.id in holding else entry.standing.value,
            *map(plain, (entry.correction.context.machine, entry.correction.context.material)),
            plain(entry.correction.context.tool),
            factor(interval(entry.correction)),
            f"{entry.correction.confidence:.2f}",
            str(entry.correction.outcomes),
            local(entry.correction.proposed_at),
            plain(entry.decided_by) if entry.decided_by else "",
            "" if entry.decided_at is None else local(entry.decided_at),
        )
        for entry in entries
    ]
    print_table(header, rows)


def _in_force(entries: Sequence[Entry]) -> frozenset[int]:
    """Of each context the correction that was accepted last."""
    decided = [
        (entry.decided_at, entry)
        for entry in entries
        if entry.standing is Standing.ACCEPTED and entry.decided_at is not None
    ]
    latest: dict[Context, int] = {}
    for _, entry in sorted(decided, key=lambda each: each[0]):
        latest[entry.correction.context] = entry.id
    return frozenset(latest.values())


def print_content(content: Content, *, place: str) -> None:
    """What a knowledge base holds."""
    print_line(
        f"{place}: {content.outcomes} outcomes, {content.corrections} corrections, "
        f"{content.decisions} decisions"
    )
    print_line(f"fingerprint {content.fingerprint}")


def local(time: datetime) -> str:
    """A time in the zone of this computer."""
    return f"{time.astimezone():%Y-%m-%d %H:%M}"


def told(quantity: Quantity) -> str:
    """Planned, measured and deviation in a cell."""
    planned, measured = number(quantity.predicted), number(quantity.measured)
    if quantity.predicted is None and quantity.measured is None:
        return ""
    share = quantity.deviation
    return f"{planned} -> {measured}" + ("" if share is None else f" ({100.0 * share:+.0f} %)")


def evaluated(outcome: ProcessOutcome) -> tuple[tuple[str, Quantity], ...]:
    """The four quantities that are evaluated, in the user's units."""
    return (
        ("surface Ra, µm", _scaled(outcome.roughness, um_from_mm(1.0))),
        ("time, s", outcome.time),
        ("force, N", outcome.force),
        ("feed, mm/min", _scaled(outcome.feed, mm_min_from_speed(1.0))),
    )


def _scaled(quantity: Quantity, by: float) -> Quantity:
    """In another unit."""
    predicted, measured = quantity.predicted, quantity.measured
    return Quantity(
        predicted=None if predicted is None else predicted * by,
        measured=None if measured is None else measured * by,
    )


def _quantities(outcome: ProcessOutcome) -> list[tuple[str, str, str, str]]:
    """All that has a plan and a measurement."""
    quantities = (
        *evaluated(outcome),
        ("feed per tooth, mm", outcome.feed_per_tooth),
        ("step depth, mm", outcome.step_depth),
    )
    return [
        (
            name,
            number(each.predicted, 4),
            number(each.measured, 4),
            NOTHING if each.deviation is None else f"{100.0 * each.deviation:+.1f}",
        )
        for name, each in quantities
    ]


def _facts(outcome: ProcessOutcome) -> list[tuple[str, str]]:
    """All else that is known."""
    context, feature, ratio = outcome.context, outcome.feature, outcome.force_ratio
    sizes = {"L": feature.length, "X": feature.width, "a_t": feature.total_depth}
    size = ", ".join(f"{name} {number(value)}" for name, value in sizes.items())
    speed = outcome.cutting_speed
    facts = [
        ("machine, material, tool", ", ".join(
            map(plain, (context.machine, context.material, context.tool))
        )),
        ("feature", f"{plain(feature.id)}, {plain(feature.kind)}: {size} mm"),
        ("operation", f"{'finishing' if outcome.is_finishing else 'roughing'}, mode "
         f"{plain(outcome.mode)}, strategy {plain(outcome.strategy)}, "
         f"immersion {outcome.immersion or NOTHING}"),
        ("k_c1.1 of the catalogue, N/mm²", number(outcome.specific_force, 4)),
        ("cutting speed, m/min", number(None if speed is None else m_min_from_speed(speed))),
        ("force bound, N", number(outcome.force_bound)),
        ("samples", plain(outcome.trace)),
    ]  # fmt: skip
    if ratio is not None:
        facts.append((
            "force, measured over expected",
            f"{exp(ratio.log_mean):.3f} ± {100.0 * ratio.log_deviation:.1f} % a reading, "
            f"{ratio.readings} readings",
        ))
    return facts
