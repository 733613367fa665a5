"""Cutting settings set into a program: one feed, spindle speed and depth for its workingsteps.

The settings are written into the technology and the operation as an optimised feed is, and the
program is read again, so that tool paths and layers follow from them. Units mm, mm/s, rev/s.

Edits of the cutting conditions of a workingstep: feed, speed and depth of one pass.

A technology, a speed or a strategy that several operations share is copied before it is edited.
Tool paths that name the technology of their operation follow the copy: they would keep the old
feed otherwise.

Diameter of the milling tool of a program, replaced. Unit mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite
from typing import Any

from stepnc_model.editing.draft import Draft
from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.entities.operations import Toolpath
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real, Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import Number, Programmed, ProgrammedQuantity, programmed
from stepnc_model.programs.tool import body_of, tool_of

DIGITS = 12
"""Significant digits of numbers written into the file."""


def rounded(value: float) -> float:
    """Round a number to the digits that are written."""
    return float(f"{value:.{DIGITS}g}")


def edit_number(draft: Draft, step: ResolvedWorkingstep, number: Number, value: float) -> None:
    """Write one programmed number, in instances that only this operation uses.

    Where its tool paths have technologies of their own, all with the number are edited.

    Parameters
    ----------
    value : float
        Number for the file, with its sign.
    """
    if rounded(value) == rounded(number.in_file(number.value)):
        return
    written = Real(rounded(value))
    for technology in step.technologies:
        owner, *parts = _users(draft, step, technology)
        holder = draft.own(owner, "its_technology", parts=parts)
        if number.ref == step.technology_ref:
            draft.put(technology, number.attribute, written, at=holder)
            continue
        attribute = _attribute(draft.program.get(step.technology_ref), number.ref)
        holder = draft.own(technology, attribute, at=holder)
        speed = getattr(draft.program.get(technology), attribute)
        draft.put(speed, number.attribute, written, at=holder)


def edit_speed(draft: Draft, step: ResolvedWorkingstep, number: Number, value: float) -> None:
    """Write the programmed speed, also where rapids and ways in of the operation repeat it.

    Parameters are those of :func:`edit_number`. Technologies of other tool paths that turn the
    spindle at the old speed follow; the spindle would change its speed between the paths
    otherwise.
    """
    edit_number(draft, step, number, value)
    program = draft.program
    listed = step.operation.its_toolpath
    paths = () if listed is None else program.get(listed).its_list
    found = (getattr(program.get(path), "its_technology", None) for path in paths)
    others = dict.fromkeys((step.operation.its_technology, *found))
    before = number.in_file(number.value)
    for technology in others:
        if technology is None or technology in step.technologies:
            continue
        holder = technology
        if number.ref != step.technology_ref:
            name = _attribute(program.get(step.technology_ref), number.ref)
            holder = getattr(program.get(technology), name, None)
        entity = None if holder is None else program.get(holder)
        written = getattr(entity, number.attribute, None)
        if written is not None and rounded(written) == rounded(before):
            alone = replace(step, technologies=(technology,))
            edit_number(draft, alone, replace(number, ref=holder), value)


def _attribute(technology: Entity, ref: Ref[Entity]) -> str:
    """Attribute of a technology that refers to an instance."""
    return next(name for name in attributes(technology) if getattr(technology, name) == ref)


def _users(draft: Draft, step: ResolvedWorkingstep, technology: Ref[Entity]) -> list[Ref[Any]]:
    """Operation and tool paths of a workingstep that name a technology."""
    paths: list[Ref[Any]] = list(_paths_with_technology(draft, step, technology))
    is_own = step.operation.its_technology == technology
    return [step.operation_ref, *paths] if is_own else paths


def _paths_with_technology(
    draft: Draft, step: ResolvedWorkingstep, technology: Ref[Entity]
) -> list[Ref[Toolpath]]:
    """Tool paths of an operation that name a technology.

    Raises
    ------
    SchemaError
        If another operation uses such a path too, which can have one technology only.
    """
    program, listed = draft.program, step.operation.its_toolpath
    if listed is None:
        return []
    paths = [
        path
        for path in program.get(listed).its_list
        if program.get(path).its_technology == technology
    ]
    for path in paths:
        if draft.uses(listed) > 1 or draft.uses(path) > 1:
            raise program.error(
                f"names the technology {technology} for several operations: "
                f'--set "{path}.its_technology=$" lets it follow each of them',
                path,
                "its_technology",
            )
    return paths


def edit_depth(draft: Draft, step: ResolvedWorkingstep, depth: float) -> bool:
    """Write the depth of one pass, mm: in the operation, or in a turning strategy.

    Returns
    -------
    bool
        Whether the operation has a depth that can be written.
    """
    value, operation = Real(rounded(depth)), step.operation
    if isinstance(operation, TurningMachiningOperation):
        reference = operation.its_machining_strategy
        if reference is None or not hasattr(draft.program.get(reference), "cutting_depth"):
            return False
        strategy = draft.own(step.operation_ref, "its_machining_strategy")
        draft.put(reference, "cutting_depth", (value,), at=strategy)
        return True
    if not hasattr(operation, "axial_cutting_depth"):
        return False
    draft.put(step.operation_ref, "axial_cutting_depth", value)
    return True


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
    """Settings that all workingsteps of a program share; None where they differ."""
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
        edit_speed(draft, step, told.speed, _speed_number(program, step, told, speed))
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
    program: Program, step: ResolvedWorkingstep, state: Programmed, speed: float
) -> float:
    """Number of the file's speed attribute for a signed spindle speed in rev/s."""
    if state.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED:
        return speed / abs(state.speed.scale)
    diameter = tool_of(program, step.tool_ref).diameter
    if diameter <= 0.0:
        message = "the cutting speed is constant: the spindle follows the radius"
        raise program.error(message, step.technology_ref)
    if speed > 0.0:
        message = "a cutting speed has no direction: the spindle cannot be reversed"
        raise program.error(message, step.technology_ref)
    return state.speed_number(-speed, diameter)


def with_tool_diameter(program: Program, diameter: float) -> Program:
    """Program whose milling tool has another diameter; its other dimensions stay.

    Tools that share the dimensions with it keep theirs.

    Parameters
    ----------
    diameter : float, mm

    Returns
    -------
    Program
        Read again from the changed text, with the same name, units and stock.

    Raises
    ------
    SchemaError
        If the program mills with several tools or none, or the diameter is not possible.
    """
    steps = [
        each
        for each in program.workingsteps
        if isinstance(each.operation, MillingTypeOperation)
    ]
    tools = list(dict.fromkeys(each.tool_ref for each in steps))
    if len(tools) != 1:
        used = ", ".join(f"'{tool_of(program, each).id}'" for each in tools) or "none"
        message = f"a tool diameter needs a program that mills with one tool, not {used}"
        raise program.error(message, program.workingsteps[0].ref)
    tool_of(program, tools[0])
    draft = Draft(program)
    body = draft.own(tools[0], "its_tool_body")
    shape = body_of(program, tools[0])
    if shape is None or shape.dimension is None:
        raise program.error("the tool has no dimension", tools[0])
    body_ref = program.get(tools[0]).its_tool_body  # type: ignore[attr-defined]
    dimension = draft.own(body_ref, "dimension", at=body)
    draft.put(shape.dimension, "diameter", Real(rounded(diameter)), at=dimension)
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    changed = program.changed(file)
    tool_of(changed, tools[0])
    return changed
