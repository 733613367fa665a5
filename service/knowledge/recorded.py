"""Outcomes and corrections stored in a program file, for ``stepnc kbe read``."""

from pathlib import Path

from service.reading import read_program
from service.rendering.columns import Column
from service.rendering.records import dump, records
from service.rendering.text import print_line, print_table
from stepnc_model.outcome_record import (
    RecordedCorrection,
    RecordedOutcome,
    RecordedOutcomes,
    read_outcomes,
)
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


def recorded_in(file: Path) -> RecordedOutcomes:
    """Read the outcomes and corrections that ``stepnc kbe write`` stored in a program.

    Raises
    ------
    StepNcError
        When the file cannot be read as a program.
    """
    return read_outcomes(read_program(file, units="iso"))


def recorded_json(found: RecordedOutcomes) -> str:
    """Return stored outcomes and corrections as JSON; keys carry their units."""
    return dump({
        "outcomes": records(OUTCOMES, found.outcomes),
        "corrections": records(CORRECTIONS, found.corrections),
    })


def print_recorded(found: RecordedOutcomes) -> None:
    """Print stored outcomes and corrections as two tables, in file order."""
    print_line(f"{len(found.outcomes)} outcomes, {len(found.corrections)} corrections")
    if found.outcomes:
        print_table(OUTCOMES, found.outcomes, nothing="–")
    if found.corrections:
        print_table(CORRECTIONS, found.corrections, nothing="–")
