"""Feed, spindle and coolant of a move as a control needs them, resolved from its technology.

ISO 14649-10 §4.2.1: a spindle speed is negative when the tool of a mill turns clockwise, as
right-hand tools need; this is M3. On a lathe the workpiece turns, positive counter-clockwise
about z, as right-hand tools in front of the axis need; this is M3 as well.
"""

from dataclasses import dataclass
from math import pi

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import CoolantSelect, Hand
from stepnc_model.entities.technology import MillingMachineFunctions, MillingTechnology
from stepnc_model.entities.turning import TurningMachineFunctions
from stepnc_model.errors import PostError, SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import (
    Coolant,
    CoolantKind,
    MachineType,
    Rate,
    RateMode,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
)
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import Number, Programmed, ProgrammedQuantity, programmed
from stepnc_model.programs.tool import Tool, hand_of, is_described, tool_of
from stepnc_model.toolpath.path import Feed

COOLANTS = {
    CoolantSelect.MIST: CoolantKind.MIST,
    CoolantSelect.THROUGH_TOOL: CoolantKind.THROUGH,
}

Spindle = SpindleOn | SurfaceSpeed | SpindleOff


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalState:
    """Spindle, feed and lead of a move."""

    spindle: Spindle | None
    """Spindle state; None if the file does not give one, so that the current state stays."""
    rate: Rate | None
    lead: float | None = None
    """Lead of a synchronised move, mm per revolution."""
    note: str = ""
    """Remark for readers of the NC code."""


def conditions(
    program: Program, feed: Feed, tool: Ref[Entity] | None, machine: MachineType
) -> ModalState:
    """Resolve the feed and spindle of one move.

    Parameters
    ----------
    tool : Ref, optional
        Tool in the spindle; without a tool, feed per tooth and cutting speed cannot be
        converted to numbers for a control.

    Raises
    ------
    SchemaError
        If the tool cannot be used.
    PostError
        If a synchronised move has no lead.
    """
    try:
        found = programmed(program, feed.technology)
    except SchemaError as error:
        return _incomplete(program, feed, str(error))
    cutter = None
    needs_tool = (
        found.feed.quantity is ProgrammedQuantity.FEED_PER_TOOTH
        or found.speed.quantity is ProgrammedQuantity.CUTTING_SPEED
    )
    if tool is not None and (needs_tool or is_described(program, tool)):
        cutter = tool_of(program, tool)
    if machine is MachineType.LATHE:
        spindle, speed = _lathe_spindle(found, feed)
        is_unlimited = isinstance(spindle, SurfaceSpeed) and spindle.limit is None
        clash = "no limit of the spindle speed is given" if is_unlimited else ""
    else:
        spindle, clash = _mill_spindle(program, found, feed, tool=tool, cutter=cutter)
        speed = spindle.speed
    rate = _rate(found, feed, teeth=cutter.teeth if cutter else 1, speed=speed)
    is_lathe = machine is MachineType.LATHE
    if rate.mode is RateMode.PER_REVOLUTION and not is_lathe and speed:
        rate = Rate(value=rate.value * speed)
    return ModalState(
        spindle=spindle,
        rate=rate,
        lead=_lead(program, found, feed, speed) if feed.is_synchronised else None,
        note=clash,
    )


def _lathe_spindle(state: Programmed, feed: Feed) -> tuple[SpindleOn | SurfaceSpeed, float]:
    """Spindle of a lathe, and its speed if constant, else 0."""
    sense = (
        SpindleDirection.CLOCKWISE
        if state.speed.scale > 0.0
        else SpindleDirection.COUNTERCLOCKWISE
    )
    value = state.speed.value * feed.speed_ratio
    if state.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED:
        return SpindleOn(speed=value, sense=sense), value
    return SurfaceSpeed(speed=value, limit=state.max_spindle_speed, sense=sense), 0.0


def _mill_spindle(
    program: Program,
    state: Programmed,
    feed: Feed,
    *,
    tool: Ref[Entity] | None,
    cutter: Tool | None,
) -> tuple[SpindleOn, str]:
    """Spindle of a mill, and a remark on an unusual direction."""
    hand = None if tool is None else hand_of(program, tool)
    is_left = hand is Hand.LEFT
    if state.speed.quantity is ProgrammedQuantity.CUTTING_SPEED:
        if cutter is None or cutter.diameter <= 0.0:
            message = "a cutting speed needs a tool with a diameter"
            raise PostError(f"{program.label(feed.technology)}: {message}")
        sense = SpindleDirection.COUNTERCLOCKWISE if is_left else SpindleDirection.CLOCKWISE
        speed = state.spindle_speed(cutter.diameter) * feed.speed_ratio
        return SpindleOn(speed=speed, sense=sense), ""
    sense = (
        SpindleDirection.CLOCKWISE
        if state.speed.scale < 0.0
        else SpindleDirection.COUNTERCLOCKWISE
    )
    is_odd = hand is not None and is_left is not (sense is SpindleDirection.COUNTERCLOCKWISE)
    note = f"the file turns the spindle {sense} with a {hand} hand tool".lower()
    speed = state.speed.value * feed.speed_ratio
    return SpindleOn(speed=speed, sense=sense), note if is_odd else ""


def _rate(state: Programmed, feed: Feed, *, teeth: int, speed: float) -> Rate:
    """Feed of a move, per revolution or per minute as in the file."""
    if feed.velocity is not None:
        return Rate(value=feed.velocity)
    if feed.per_revolution is not None:
        return Rate(value=feed.per_revolution, mode=RateMode.PER_REVOLUTION)
    value = state.feed.value * feed.ratio
    if state.feed.quantity is ProgrammedQuantity.FEED_PER_TOOTH:
        value *= teeth
    if state.feed.quantity is ProgrammedQuantity.FEED:
        return Rate(value=value)
    return Rate(value=value, mode=RateMode.PER_REVOLUTION)


def _lead(program: Program, state: Programmed, feed: Feed, speed: float) -> float:
    """Lead of a synchronised move, mm per revolution."""
    number: Number = state.feed
    if feed.per_revolution is not None:
        return feed.per_revolution
    if number.quantity is not ProgrammedQuantity.FEED:
        return number.value * feed.ratio
    if speed <= 0.0:
        message = "a synchronised move needs a feed per revolution or a spindle speed"
        raise PostError(f"{program.label(feed.technology)}: {message}")
    return number.value * feed.ratio / speed


def _incomplete(program: Program, feed: Feed, why: str) -> ModalState:
    """Modal state for a technology with missing or zero values, with a remark."""
    technology = program.get(feed.technology)
    label = program.label(feed.technology)
    spindle: Spindle | None = None
    note = why
    speed = getattr(technology, "spindle", None)
    if isinstance(technology, MillingTechnology) and speed is not None:
        if speed == 0.0:
            spindle, note = SpindleOff(), f"{label}: spindle speed 0: the spindle is stopped"
        else:
            sense = (
                SpindleDirection.CLOCKWISE if speed < 0.0 else SpindleDirection.COUNTERCLOCKWISE
            )
            value = abs(speed) * program.units.spindle * feed.speed_ratio
            spindle = SpindleOn(speed=value, sense=sense)
    rate = None
    written = getattr(technology, "feedrate", None)
    if feed.velocity is not None:
        rate = Rate(value=feed.velocity)
    elif written and written > 0.0:
        rate = Rate(value=written * program.units.feed_scale * feed.ratio)
    return ModalState(spindle=spindle, rate=rate, note=note)


def constant_speed(spindle: SurfaceSpeed, radius: float) -> SpindleOn:
    """Constant spindle speed that corresponds to a surface speed at a radius in mm.

    Threads need it: their feed is synchronised with the spindle angle.
    """
    speed = spindle.speed / (2.0 * pi * radius) if radius > 0.0 else spindle.limit
    if speed is None:
        raise PostError("constant surface speed on the axis needs a spindle speed limit")
    limited = min(speed, spindle.limit) if spindle.limit is not None else speed
    return SpindleOn(speed=limited, sense=spindle.sense)


def coolant_of(program: Program, ref: Ref[Entity]) -> Coolant:
    """Coolant that machine functions ask for."""
    functions = program.get(ref)
    kinds: set[CoolantKind] = set()
    if isinstance(functions, MillingMachineFunctions):
        asked = {
            CoolantKind.FLOOD: functions.coolant,
            CoolantKind.MIST: functions.mist,
            CoolantKind.THROUGH: functions.through_spindle_coolant,
        }
        kinds = {kind for kind, is_on in asked.items() if is_on}
    elif isinstance(functions, TurningMachineFunctions) and functions.coolant:
        kind = functions.coolant_type
        kinds = {COOLANTS.get(kind, CoolantKind.FLOOD) if kind else CoolantKind.FLOOD}
    return Coolant(kinds=frozenset(kinds))
