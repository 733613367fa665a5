"""Writing of optimisation advice into a program file, in one of two profiles.

``standard`` (default)
    The record as prefixed parameters to which no instance refers: standard entities only, in
    places where no interpreter looks. A system that saves the file again may drop them.
``optimisation`` (default where a program holds such entities)
    The record as entities, referred to by one surplus parameter at the end of the operation. A
    reader that takes the entities of the standard only stops at them.

An AP238 file takes profile ``standard`` only: the parameters become representation items of
action properties of the workplan (:mod:`stepnc_model.ap238.writing`).

In both profiles the operation's own technology holds the feed. A technology shared by several
operations is copied before it is edited. Existing records are removed first, so that writing
the same advice twice gives the same bytes. Only changed parameters and added or removed lines
differ from the original file. Outcomes and corrections
(:mod:`stepnc_model.editing.outcome_record`) stay; a file that holds some cannot be written in
profile ``standard``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from stepnc_model.ap238.view import AimView
from stepnc_model.ap238.writing import spliced_into
from stepnc_model.editing.cut_settings import edit_depth, edit_number, edit_speed
from stepnc_model.editing.draft import Draft
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record import AdviceRecord
from stepnc_model.editing.record_edit import (
    RECORD_KEYWORDS,
    find_record,
    put_entities,
    put_parameters,
    take_out,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import Programmed

SCHEMA = "OPTIMISATION_SCHEMA"

ANSWERS = ("OUTCOME", "CORRECTION")
"""Entities of the same schema that are not part of a record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingstepUpdate:
    """Values to be written for one workingstep."""

    workingstep: ResolvedWorkingstep
    programmed: Programmed
    record: AdviceRecord
    feed: float
    """Number for the file's feed attribute."""
    speed: float | None = None
    """Number for the file's speed attribute; ``None`` if unchanged."""
    depth: float | None = None
    """Depth of one pass, mm; ``None`` if unchanged."""


def write(
    program: Program, changes: Sequence[WorkingstepUpdate], profile: FileProfile | None
) -> bytes:
    """Write optimisation advice into a program; return the bytes of the new file.

    If several workingsteps run the same operation, which can hold only one feed, it gets the
    lowest feed and the lowest plunge feed.

    Parameters
    ----------
    program : Program
        Program as it was read.
    profile : FileProfile or None
        None: no records are written, and those of this project are removed.

    Returns
    -------
    bytes

    Raises
    ------
    SchemaError
        If the profile cannot represent what the program holds.
    """
    profile = profile_for(program, profile)
    _require_form(program, profile)
    chosen: dict[int, WorkingstepUpdate] = {}
    for change in changes:
        operation = int(change.workingstep.operation_ref)
        chosen[operation] = _slower(change, chosen.get(operation, change))
    draft = Draft(program)
    for change in chosen.values():
        # Without records of its own, a file keeps those of others, whose limits may bind.
        if profile is not None or find_record(program, change.workingstep) is not None:
            take_out(draft, change.workingstep)
    for change in chosen.values():
        _edit_conditions(draft, change)
    for change in chosen.values() if profile is not None else ():
        old = find_record(program, change.workingstep)
        record = _with_first_programmed(change.record, old)
        _put_in(draft, change.workingstep, record, profile)
    return _finished(draft)


def _slower(one: WorkingstepUpdate, other: WorkingstepUpdate) -> WorkingstepUpdate:
    """Update with the lower feed, and the lower plunge feed of both."""
    slower = one if one.feed < other.feed else other
    feeds = [each.record.plunge_feed_per_tooth for each in (one, other)]
    least = min((feed for feed in feeds if feed is not None), default=None)
    return replace(slower, record=replace(slower.record, plunge_feed_per_tooth=least))


def convert(program: Program, profile: FileProfile) -> bytes:
    """Convert all records of a program to one profile; return the bytes of the new file.

    Incomplete records, as printed in paper 002, stay unchanged.

    Raises
    ------
    SchemaError
        If the profile cannot represent what the program holds.
    """
    profile = profile_for(program, profile) or profile
    _require_form(program, profile)
    draft = Draft(program)
    found = {
        int(step.operation_ref): (step, record)
        for step in program.workingsteps
        if (record := find_record(program, step)) is not None
    }
    for step, _ in found.values():
        take_out(draft, step)
    for step, record in found.values():
        _put_in(draft, step, record, profile)
    return _finished(draft)


def records(program: Program) -> dict[int, AdviceRecord]:
    """Records of a program in either profile, by the id of their operation."""
    found = {
        int(step.operation_ref): find_record(program, step) for step in program.workingsteps
    }
    return {number: record for number, record in found.items() if record is not None}


def usual_profile(program: Program) -> FileProfile:
    """Profile of a program's records where none is chosen: that in which it is written."""
    ours = (*(name for name in RECORD_KEYWORDS if name.endswith("OPTIMISATION")), *ANSWERS)
    is_own = any(program.file.ids_of(keyword) for keyword in ours)
    return FileProfile.OPTIMISATION if is_own else FileProfile.STANDARD


def profile_for(program: Program, profile: FileProfile | None) -> FileProfile | None:
    """Profile in which records are written: for an AP238 file always ``standard``, or none."""
    if profile is not None and isinstance(program.file, AimView):
        return FileProfile.STANDARD
    return profile


def _require_form(program: Program, profile: FileProfile | None) -> None:
    """Raise an error if profile ``standard`` cannot represent part of the program."""
    if profile is not FileProfile.STANDARD:
        return
    for keyword in ANSWERS:
        for number in program.file.ids_of(keyword):
            raise program.error(f"cannot be written in profile '{profile.value}'", Ref(number))


def _put_in(
    draft: Draft, step: ResolvedWorkingstep, record: AdviceRecord, profile: FileProfile | None
) -> None:
    """Add a record in the given profile."""
    if profile is FileProfile.OPTIMISATION:
        put_entities(draft, step, record)
        draft.edits.add_schema(SCHEMA)
    else:
        put_parameters(draft, step, record)


def _finished(draft: Draft) -> bytes:
    """Edited bytes; the schema name is removed together with the last of its entities."""
    file = draft.program.file
    has_answers = any(file.ids_of(keyword) for keyword in ANSWERS)
    optima = [
        number
        for name in RECORD_KEYWORDS
        if name.endswith("OPTIMISATION")
        for number in file.ids_of(name)
    ]
    is_without = draft.removed.issuperset(optima) and not draft.has_surplus
    if optima and is_without and not has_answers:
        draft.edits.remove_schema(SCHEMA)
    changed = draft.edits.apply()
    if isinstance(file, AimView):
        return spliced_into(file, changed, draft.removed)
    return changed


def _edit_conditions(draft: Draft, change: WorkingstepUpdate) -> None:
    """Write the feed, speed and depth of a workingstep."""
    step = change.workingstep
    edit_number(draft, step, change.programmed.feed, change.feed)
    if change.speed is not None:
        edit_speed(draft, step, change.programmed.speed, change.speed)
    if change.depth is not None:
        edit_depth(draft, step, change.depth)


def _with_first_programmed(record: AdviceRecord, old: AdviceRecord | None) -> AdviceRecord:
    """Record that keeps the values programmed before the first optimisation."""
    if old is None:
        return record
    return replace(
        record,
        programmed_feedrate=old.programmed_feedrate,
        programmed_feedrate_per_tooth=old.programmed_feedrate_per_tooth,
        programmed_cutspeed=old.programmed_cutspeed,
        programmed_spindle=old.programmed_spindle,
        programmed_axial_depth=old.programmed_axial_depth,
    )
