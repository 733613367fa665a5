"""Outcomes and corrections written into a program as entities, and read from it.

Outcomes and corrections become the entities ``outcome`` and ``correction`` of
``schemas/optimisation.exp``, appended to the file; all other bytes stay unchanged. There is no
other form: profile ``standard`` promises a file of standard entities only, so with it
they are rejected.

An outcome is a measurement: later outcomes are appended, existing ones never change, and an
outcome that is already in the file is not written again. The entities hold less than the
Python objects: prediction, context and statistics of an outcome stay in the knowledge base.

Two corrections for the same machine, material and tool would be ambiguous, so a newer one
replaces the older in its instance; a proposal does not replace an accepted correction. Earlier
corrections and distributions are kept only in the knowledge base; the file has the factor at
the centre of the distribution.

Numbers and times are checked when written, and read tolerantly.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from math import exp, inf, isfinite

from stepnc_model.ap238.view import AimView
from stepnc_model.editing.cut_settings import rounded
from stepnc_model.editing.record_edit import has_parameters
from stepnc_model.editing.writeback import SCHEMA
from stepnc_model.entities import optimisation as entities
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.outcome import Context, LearnedCorrection, ProcessOutcome
from stepnc_model.part21.values import Ref
from stepnc_model.part21.writer import Edits
from stepnc_model.programs.binding import to_parameters
from stepnc_model.programs.program import Program
from stepnc_model.units import m_s_from_speed, mm_from_um, speed_from_m_s, um_from_mm


def written(time: datetime) -> str:
    """Format a time as ISO 8601 with its time zone."""
    if time.utcoffset() is None:
        raise ValueError(f"{time.isoformat()} has no time zone")
    return time.isoformat()


def measured_or_none(value: float | None, name: str, unit: str) -> float | None:
    """Check a measured number that may be 0; None if not measured."""
    return 0.0 if value == 0.0 else positive_or_none(value, name, unit)


def positive_or_none(value: float | None, name: str, unit: str) -> float | None:
    """Check that a measured number is positive; None if not measured."""
    return None if value is None else positive(value, name, unit)


def positive(value: float, name: str, unit: str) -> float:
    """Check that a number is positive and finite; return it rounded as written."""
    number = rounded(value)
    if not 0.0 < number < inf:
        raise ValueError(f"invalid {name}: {value:g} {unit}".rstrip())
    return number


def known(value: object) -> float | None:
    """Finite number from the file, or None for any other value."""
    return float(value) if isinstance(value, int | float) and isfinite(value) else None


def instant(text: object) -> datetime | None:
    """Time from the file, or None if it is invalid or has no time zone."""
    if not isinstance(text, str):
        return None
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        return None
    return None if time.utcoffset() is None else time


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedCorrection:
    """Correction factor on k_c as read from the file."""

    context: Context
    factor: float
    confidence: float
    """Confidence in the correction factor, 0 to 1."""
    accepted_by: str
    """Person who accepted the correction; empty for a proposal."""
    valid_from: datetime | None
    """Time from which the correction is valid, with time zone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Standing:
    """Correction that is in the file or is to be written."""

    ref: Ref[entities.Correction] | None
    entity: entities.Correction

    @property
    def since(self) -> datetime:
        """Start of validity; a correction without a time is older than all others."""
        return instant(self.entity.valid_from) or datetime.min.replace(tzinfo=UTC)


def correction_entity(correction: LearnedCorrection) -> entities.Correction:
    """Entity that holds a learned correction, dated by its acceptance or its proposal."""
    try:
        factor = exp(correction.log_centre)
    except OverflowError:
        factor = inf
    confidence = correction.confidence
    if not 0.0 <= confidence <= 1.0:
        raise ValueError(f"a confidence of {confidence:g}: it must lie between 0 and 1")
    context = correction.context
    if not (context.machine and context.material and context.tool):
        raise ValueError("a correction must name its machine, material and tool")
    return entities.Correction(
        machine=context.machine,
        material=context.material,
        tool=context.tool,
        specific_force_factor=positive(factor, "factor on k_c", ""),
        confidence=rounded(confidence),
        accepted_by=correction.accepted_by or None,
        valid_from=written(correction.accepted_at or correction.proposed_at),
    )


def supersede(program: Program, edits: Edits, learned: Sequence[entities.Correction]) -> None:
    """Keep only the newest correction of each machine, material and tool."""
    there: dict[Context, list[_Standing]] = {}
    for ref, entity in program.model.of_type(entities.Correction):
        there.setdefault(_context(entity), []).append(_Standing(ref=ref, entity=entity))
    for entity in learned:
        there.setdefault(_context(entity), []).append(_Standing(ref=None, entity=entity))
    for context in dict.fromkeys(map(_context, learned)):
        _settle(edits, there[context])


def recorded_correction(entity: entities.Correction) -> RecordedCorrection | None:
    """Read a correction of the file; None if it is incomplete."""
    factor, confidence = known(entity.specific_force_factor), known(entity.confidence)
    is_named = entity.machine and entity.material and entity.tool
    if factor is None or factor <= 0.0 or confidence is None or not is_named:
        return None
    return RecordedCorrection(
        context=_context(entity),
        factor=factor,
        confidence=confidence,
        accepted_by=entity.accepted_by or "",
        valid_from=instant(entity.valid_from),
    )


def _settle(edits: Edits, standing: Sequence[_Standing]) -> None:
    """Write the valid corrections of one context in place of outdated ones.

    Among equally new corrections the last one wins. A proposal is kept only while it is newer
    than the accepted correction.
    """
    accepted = [each for each in standing if each.entity.accepted_by]
    proposed = [each for each in standing if not each.entity.accepted_by]
    held: list[_Standing] = []
    for kind in (accepted, proposed):
        newest = _newest(kind)
        if newest is not None and not (held and held[0].since >= newest.since):
            held.append(newest)
    free = [each for each in standing if each.ref is not None and each not in held]
    for each in held:
        if each.ref is None:
            _put(edits, each.entity, free.pop() if free else None)
    for each in free:
        if each.ref is not None:
            edits.remove(int(each.ref))


def _newest(standing: Sequence[_Standing]) -> "_Standing | None":
    """Newest correction; the last of equally new ones, but an identical one stays."""
    newest: _Standing | None = None
    for each in standing:
        is_same = newest is not None and each.entity == newest.entity
        if newest is None or (each.since >= newest.since and not is_same):
            newest = each
    return newest


def _put(edits: Edits, entity: entities.Correction, old: _Standing | None) -> None:
    """Write a correction, reusing the instance of an older one if there is one."""
    values = to_parameters(entity)
    if old is None or old.ref is None:
        edits.add(entity.keyword, values)
        return
    before = edits.file.parameters(int(old.ref))
    if len(before) != len(values):
        edits.remove(int(old.ref))
        edits.add(entity.keyword, values)
        return
    for place, value in enumerate(values):
        if value != before[place]:
            edits.replace_parameter(int(old.ref), place, value)


def _context(entity: entities.Correction) -> Context:
    """Machine, material and tool of a correction entity."""
    return Context(machine=entity.machine, material=entity.material, tool=entity.tool)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedOutcome:
    """Measurement as read from the file; ``None`` for quantities not measured."""

    operation: Ref[MachiningOperation]
    workingsteps: tuple[str, ...]
    """Names of the workingsteps that run the operation; several may share it."""
    measured_at: datetime | None
    """Time of measurement, with time zone."""
    time: float | None
    """Machining time, s."""
    force: float | None
    """Cutting force, N."""
    feed: float | None
    """Measured feed, mm/s."""
    roughness: float | None
    """Roughness Ra, mm."""
    trace: str
    """Location of the recorded samples; empty if not kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedOutcomes:
    """All outcomes and corrections of a program, in file order."""

    outcomes: tuple[RecordedOutcome, ...]
    corrections: tuple[RecordedCorrection, ...]


def write_outcomes(
    program: Program,
    outcomes: Sequence[ProcessOutcome],
    corrections: Sequence[LearnedCorrection] = (),
) -> bytes:
    """Write outcomes and corrections into a program; return the bytes of the new file.

    Parameters
    ----------
    program : Program
        Program as it was read.
    outcomes : sequence of ProcessOutcome
        Outcomes of workingsteps of this program, given by name or by instance, ``#16``.

    Returns
    -------
    bytes
        Unchanged bytes of the file if it already holds all of them.

    Raises
    ------
    SchemaError
        If there is no such workingstep, its name belongs to several operations, or the
        program's records are in profile ``standard``.
    ValueError
        If the schema does not allow a number, or a time has no time zone.
    """
    measured = [_outcome_entity(program, each) for each in outcomes]
    learned = [correction_entity(each) for each in corrections]
    edits = Edits(program.file)
    if not measured and not learned:
        return program.source.data
    if isinstance(program.file, AimView):
        raise SchemaError(
            "an AP238 file cannot hold outcomes and corrections: convert it to ISO 14649 first"
        )
    if has_parameters(program):
        raise program.error(
            "the optimisation record is in profile 'standard', which cannot hold outcomes and "
            "corrections: convert the program to profile 'optimisation' first",
            program.workingsteps[0].operation_ref,
        )
    _append(program, edits, measured)
    supersede(program, edits, learned)
    edits.add_schema(SCHEMA)
    return edits.apply()


def read_outcomes(program: Program) -> RecordedOutcomes:
    """Read the complete outcomes and corrections of a program."""
    measured = program.model.of_type(entities.Outcome)
    learned = program.model.of_type(entities.Correction)
    outcomes = (_recorded_outcome(program, each) for _, each in measured)
    corrections = (recorded_correction(each) for _, each in learned)
    return RecordedOutcomes(
        outcomes=tuple(each for each in outcomes if each is not None),
        corrections=tuple(each for each in corrections if each is not None),
    )


def _outcome_entity(program: Program, outcome: ProcessOutcome) -> entities.Outcome:
    """Entity that holds a measured outcome."""
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
    """Operation of the workingstep with the given name or instance."""
    found = {
        int(step.operation_ref)
        for step in program.workingsteps
        if name in {step.id, str(step.ref)}
    }
    if len(found) == 1:
        return Ref(found.pop())
    why = (
        f"belongs to {len(found)} operations"
        if found
        else "is not a workingstep of this program"
    )
    raise SchemaError(f"'{name}' {why}", entity="OUTCOME", attribute="its_operation")


def _append(program: Program, edits: Edits, measured: Sequence[entities.Outcome]) -> None:
    """Add the outcomes that are not yet in the file.

    Operations of several holes may give equal measurements, so equal outcomes are counted.
    """
    there = Counter(each for _, each in program.model.of_type(entities.Outcome))
    for outcome in measured:
        if there[outcome] > 0:
            there[outcome] -= 1
        else:
            edits.add(outcome.keyword, to_parameters(outcome))


def _recorded_outcome(program: Program, entity: entities.Outcome) -> RecordedOutcome | None:
    """Read an outcome of the file in canonical units; None if it is incomplete."""
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
