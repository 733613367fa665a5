"""Corrections of the cutting force in the program, as entities ``correction``.

Two corrections for one machine, material and tool would leave a reader to guess which of them
holds, so a newer one takes the place of the older, in its instance; a proposal leaves what was
accepted. What was believed before is history, and the knowledge base keeps it, as it keeps the
distribution of a correction: the file has the factor at its centre.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from math import exp, inf

from stepnc_model.binding import to_parameters
from stepnc_model.entities import optimisation as entities
from stepnc_model.outcome import Context, Correction
from stepnc_model.part21.values import Ref
from stepnc_model.part21.writer import Edits
from stepnc_model.program import Program
from stepnc_model.recorded_value import instant, known, positive, written
from stepnc_model.writeback import rounded


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedCorrection:
    """One factor on k_c as the file has it."""

    context: Context
    factor: float
    confidence: float
    """0…1"""
    accepted_by: str
    """empty: a proposal only"""
    valid_from: datetime | None
    """with zone"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Standing:
    """A correction of the file, or one to come."""

    ref: Ref[entities.Correction] | None
    entity: entities.Correction

    @property
    def since(self) -> datetime:
        """From when it holds; what says no time is older than all that do."""
        return instant(self.entity.valid_from) or datetime.min.replace(tzinfo=UTC)


def correction_entity(correction: Correction) -> entities.Correction:
    """What the file says of a correction: it holds since it was accepted, or proposed."""
    try:
        factor = exp(correction.log_centre)
    except OverflowError:
        factor = inf
    confidence = correction.confidence
    if not 0.0 <= confidence <= 1.0:
        raise ValueError(f"a confidence of {confidence:g}: it lies within 0 and 1")
    context = correction.context
    if not (context.machine and context.material and context.tool):
        raise ValueError("a correction holds for a machine, a material and a tool, all named")
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
    """Let the newest correction of each machine, material and tool stand, and no other."""
    there: dict[Context, list[_Standing]] = {}
    for ref, entity in program.model.of_type(entities.Correction):
        there.setdefault(_context(entity), []).append(_Standing(ref=ref, entity=entity))
    for entity in learned:
        there.setdefault(_context(entity), []).append(_Standing(ref=None, entity=entity))
    for context in dict.fromkeys(map(_context, learned)):
        _settle(edits, there[context])


def recorded_correction(entity: entities.Correction) -> RecordedCorrection | None:
    """A correction of the file; None for one that is not complete."""
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
    """Write what holds of one context over what does not.

    What comes last wins among equally new ones. A proposal stays only while it is newer than
    what was accepted.
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
    """The newest correction, the last of those that are equally new; what is there stays."""
    newest: _Standing | None = None
    for each in standing:
        is_same = newest is not None and each.entity == newest.entity
        if newest is None or (each.since >= newest.since and not is_same):
            newest = each
    return newest


def _put(edits: Edits, entity: entities.Correction, old: _Standing | None) -> None:
    """Write a correction, in the instance of an older one where there is one."""
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
    """What a correction of the file holds for."""
    return Context(machine=entity.machine, material=entity.material, tool=entity.tool)
