"""What a machine answered, and what was learned from it, in the program itself.

Outcomes and corrections become the entities ``outcome`` and ``correction`` of
``schemas/optimisation.exp``, appended to the file; every other byte stays. They have no other
form: profile ``standard`` promises a file that every ISO 14649 reader takes, so there they are
refused.

An outcome is a measurement: later ones are appended, none is ever changed, and one that is in
the file already is not written again. The newest correction of a tool stands
(:mod:`stepnc_model.correction_record`).

The entities say less than the nouns: prediction, context and statistics of an outcome stay in
the knowledge base.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from stepnc_model.binding import to_parameters
from stepnc_model.correction_record import (
    RecordedCorrection,
    correction_entity,
    recorded_correction,
    supersede,
)
from stepnc_model.entities import optimisation as entities
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.outcome import Correction, ProcessOutcome
from stepnc_model.part21.values import Ref
from stepnc_model.part21.writer import Edits
from stepnc_model.program import Program
from stepnc_model.record_edit import has_parameters
from stepnc_model.recorded_value import (
    instant,
    known,
    measured_or_none,
    positive_or_none,
    written,
)
from stepnc_model.units import m_s_from_speed, mm_from_um, speed_from_m_s, um_from_mm
from stepnc_model.writeback import SCHEMA


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedOutcome:
    """One measurement as the file has it; ``None``: not measured."""

    operation: Ref[MachiningOperation]
    workingsteps: tuple[str, ...]
    """ids of those that run the operation; several may share it"""
    measured_at: datetime | None
    """with zone"""
    time: float | None
    """s"""
    force: float | None
    """N"""
    feed: float | None
    """mm/s"""
    roughness: float | None
    """Ra, mm"""
    trace: str
    """empty: nowhere"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorded:
    """Everything that a program holds of what was measured and learned, in the file's order."""

    outcomes: tuple[RecordedOutcome, ...]
    corrections: tuple[RecordedCorrection, ...]


def write_outcomes(
    program: Program,
    outcomes: Sequence[ProcessOutcome],
    corrections: Sequence[Correction] = (),
) -> bytes:
    """The file with outcomes and corrections in it.

    Parameters
    ----------
    program : Program
        As it was read.
    outcomes : sequence of ProcessOutcome
        Of workingsteps of this program, named by id or by instance, ``#16``.
    corrections : sequence of Correction

    Returns
    -------
    bytes
        The file's own bytes when it holds all of them already.

    Raises
    ------
    SchemaError
        When there is no such workingstep, when its id names several operations, or when the
        program's records are in profile ``standard``.
    ValueError
        When a number is none that the schema allows, or a time has no zone.
    """
    measured = [_outcome_entity(program, each) for each in outcomes]
    learned = [correction_entity(each) for each in corrections]
    edits = Edits(program.file)
    if not measured and not learned:
        return edits.apply()
    if has_parameters(program):
        raise program.error(
            "its record is in profile 'standard', which has no form for outcomes and "
            "corrections: convert the program to profile 'optimisation' first",
            program.workingsteps[0].operation_ref,
        )
    _append(program, edits, measured)
    supersede(program, edits, learned)
    edits.add_schema(SCHEMA)
    return edits.apply()


def read_outcomes(program: Program) -> Recorded:
    """Outcomes and corrections that a program holds, without those that are not complete."""
    measured = program.model.of_type(entities.Outcome)
    learned = program.model.of_type(entities.Correction)
    outcomes = (_recorded_outcome(program, each) for _, each in measured)
    corrections = (recorded_correction(each) for _, each in learned)
    return Recorded(
        outcomes=tuple(each for each in outcomes if each is not None),
        corrections=tuple(each for each in corrections if each is not None),
    )


def _outcome_entity(program: Program, outcome: ProcessOutcome) -> entities.Outcome:
    """What the file says of an outcome."""
    time, force = outcome.time.measured, outcome.force.measured
    feed, roughness = outcome.feed.measured, outcome.roughness.measured
    return entities.Outcome(
        its_operation=_operation(program, outcome.workingstep),
        measured_at=written(outcome.recorded_at),
        machining_time=measured_or_none(time, "machining time", "s"),
        cutting_force=measured_or_none(force, "cutting force", "N"),
        feedrate=positive_or_none(
            None if feed is None else m_s_from_speed(feed), "feed", "m/s"
        ),
        surface_roughness=positive_or_none(
            None if roughness is None else um_from_mm(roughness), "roughness", "µm"
        ),
        trace=outcome.trace or None,
    )


def _operation(program: Program, name: str) -> Ref[MachiningOperation]:
    """Operation of the workingstep with an id or instance."""
    found = {
        int(step.operation_ref)
        for step in program.workingsteps
        if name in {step.id, str(step.ref)}
    }
    if len(found) == 1:
        return Ref(found.pop())
    why = f"names {len(found)} operations" if found else "is no workingstep of this program"
    raise SchemaError(f"'{name}' {why}", entity="OUTCOME", attribute="its_operation")


def _append(program: Program, edits: Edits, measured: Sequence[entities.Outcome]) -> None:
    """Add the outcomes that the file lacks.

    Holes that share an operation may measure the same to the last digit, so equal ones count.
    """
    there = Counter(each for _, each in program.model.of_type(entities.Outcome))
    for outcome in measured:
        if there[outcome] > 0:
            there[outcome] -= 1
        else:
            edits.add(outcome.keyword, to_parameters(outcome))


def _recorded_outcome(program: Program, entity: entities.Outcome) -> RecordedOutcome | None:
    """An outcome of the file in the units inside; None for one that is not complete."""
    feed, roughness = known(entity.feedrate), known(entity.surface_roughness)
    operation: Ref[MachiningOperation] | None = entity.its_operation
    if operation is None or not _is_operation(program, operation):
        return None
    return RecordedOutcome(
        operation=operation,
        workingsteps=tuple(
            step.id for step in program.workingsteps if step.operation_ref == operation
        ),
        measured_at=instant(entity.measured_at),
        time=known(entity.machining_time),
        force=known(entity.cutting_force),
        feed=None if feed is None else speed_from_m_s(feed),
        roughness=None if roughness is None else mm_from_um(roughness),
        trace=entity.trace or "",
    )


def _is_operation(program: Program, ref: Ref[MachiningOperation]) -> bool:
    return isinstance(program.model.entity(int(ref)), MachiningOperation)
