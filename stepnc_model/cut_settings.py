"""Cutting settings set into a program: one feed, spindle speed and depth for its workingsteps.

The settings are written into the technology and the operation as an optimised feed is, and the
program is read again, so that tool paths and layers follow from them. Units mm, mm/s, rev/s.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import isfinite

from stepnc_model.draft import Draft
from stepnc_model.edit_conditions import edit_depth, edit_number
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.technology import Programmed, ProgrammedQuantity, programmed
from stepnc_model.tool import tool_of


@dataclass(frozen=True, slots=True, kw_only=True)
class CutSettings:
    """Cutting settings of one part; None where the program's own value stays.

    Raises
    ------
    ValueError
        If feed or depth is not positive, or the spindle speed is zero.
    """

    feed: float | None = None
    """Feed, mm/s."""
    spindle_speed: float | None = None
    """Spindle speed, rev/s, with the sign of the file: negative is clockwise, as right-hand
    tools need."""
    depth: float | None = None
    """Greatest depth of one pass, mm; layers are as many and as equal as it allows."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            size = abs(value) if field.name == "spindle_speed" and value else value
            if size is not None and not (isfinite(size) and size > 0.0):
                name = field.name.replace("_", " ")
                bound = "must not be zero" if name == "spindle speed" else "must be positive"
                raise ValueError(f"{name} {value:g} {bound}")


def with_settings(
    program: Program, settings: CutSettings, workingsteps: Sequence[str] = ()
) -> Program:
    """Program with the settings in its milling and turning workingsteps.

    Without names, drilling, threading and explicit depths are left as they are: settings apply
    to every workingstep that can take them, and at least one must. An operation that several
    workingsteps share changes for all of them.

    Parameters
    ----------
    program : Program
    settings : CutSettings
    workingsteps : sequence of str
        Ids of the workingsteps that are changed; none: all that can be.

    Returns
    -------
    Program
        Read again from the changed text, with the same name, units and stock.

    Raises
    ------
    SchemaError
        If a name is unknown, or a workingstep cannot take a setting.
    """
    draft = Draft(program)
    done: set[int] = set()
    for step in _chosen(program, workingsteps):
        if int(step.operation_ref) in done:
            continue
        done.add(int(step.operation_ref))
        _edit(draft, step, settings, is_named=bool(workingsteps))
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    return program.changed(file)


def common_settings(program: Program) -> CutSettings:
    """Settings that all milling and turning workingsteps of a program share; None: they differ.

    Parameters
    ----------
    program : Program
    """
    found = [
        _settings(program, step)
        for step in program.workingsteps
        if isinstance(step.operation, (MillingTypeOperation, TurningMachiningOperation))
    ]
    return CutSettings(**{
        field.name: _same([getattr(each, field.name) for each in found])
        for field in fields(CutSettings)
    })


def _settings(program: Program, step: ResolvedWorkingstep) -> CutSettings:
    """Settings of one workingstep as programmed; None where the file has another quantity."""
    told = programmed(program, step.technology_ref)
    tool = tool_of(program, step.tool_ref)
    depth = getattr(step.operation, "axial_cutting_depth", None)
    is_speed = told.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
    if not is_speed and tool.diameter <= 0.0:
        return CutSettings(depth=depth or None)
    speed = told.spindle_speed(tool.diameter)
    feed = told.feed_per_tooth(speed, tool.teeth) * tool.teeth * speed
    sense = 1.0 if is_speed and told.speed.scale > 0.0 else -1.0
    return CutSettings(feed=feed, spindle_speed=sense * speed, depth=depth or None)


def _same(values: Sequence[float | None]) -> float | None:
    """Value that all share; None if they differ."""
    return values[0] if len(set(values)) == 1 else None


def _chosen(program: Program, names: Sequence[str]) -> list[ResolvedWorkingstep]:
    steps = program.workingsteps
    for name in names:
        if all(step.id != name for step in steps):
            known = ", ".join(step.id for step in steps)
            raise program.error(f"no workingstep '{name}'; known: {known}", steps[0].ref)
    if names:
        return [step for step in steps if step.id in names]
    kinds = (MillingTypeOperation, TurningMachiningOperation)
    cuts = [
        step
        for step in steps
        if isinstance(step.operation, kinds)
        and not programmed(program, step.technology_ref).is_synchronised
    ]
    if not cuts:
        message = "the program mills and turns nothing whose settings could be changed"
        raise program.error(message, steps[0].ref)
    return cuts


def _edit(
    draft: Draft, step: ResolvedWorkingstep, settings: CutSettings, *, is_named: bool
) -> None:
    """Write the settings of one workingstep."""
    program = draft.program
    told = programmed(program, step.technology_ref)
    tool = tool_of(program, step.tool_ref)
    speed = settings.spindle_speed
    if speed is not None:
        edit_number(draft, step, told.speed, _speed_number(program, step, told, speed))
    if settings.feed is not None:
        if told.is_synchronised:
            raise program.error("the feed is bound to the spindle by a pitch", step.ref)
        per_tooth = told.feed.quantity is not ProgrammedQuantity.FEED
        is_surface = told.speed.quantity is ProgrammedQuantity.CUTTING_SPEED
        if per_tooth and is_surface and tool.diameter <= 0.0:
            message = "a feed per revolution at constant cutting speed has no feed in mm/s"
            raise program.error(message, step.technology_ref)
        turning = abs(speed) if speed is not None else told.spindle_speed(tool.diameter or 1.0)
        feed = settings.feed / (turning * tool.teeth)
        number = told.feed_number(feed, speed=turning, teeth=tool.teeth)
        edit_number(draft, step, told.feed, number)
    if settings.depth is not None:
        is_fixed = bool(step.operation.its_toolpath)
        is_set = not is_fixed and edit_depth(draft, step, settings.depth)
        if is_named and not is_set:
            raise program.error("the file lets no depth of passes be chosen", step.ref)


def _speed_number(
    program: Program, step: ResolvedWorkingstep, told: Programmed, speed: float
) -> float:
    """Number of the file's speed attribute for a signed spindle speed in rev/s."""
    if told.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED:
        return speed / abs(told.speed.scale)
    diameter = tool_of(program, step.tool_ref).diameter
    if diameter <= 0.0:
        message = "the cutting speed is constant: the spindle follows the radius"
        raise program.error(message, step.technology_ref)
    if speed > 0.0:
        message = "a cutting speed has no direction: the spindle cannot be reversed"
        raise program.error(message, step.technology_ref)
    return told.speed_number(-speed, diameter)
