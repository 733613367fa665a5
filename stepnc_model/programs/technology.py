"""Technology of a workingstep in canonical units, and the position of its numbers in the file.

Milling: ISO 14649-11 ``milling_technology`` (rules WR1 and WR2: exactly one of cutspeed and
spindle, exactly one of feedrate and feedrate_per_tooth), also in the form that NIST proposed in
2009, with ``adaptive_allowed``. Turning: ISO 14649-12 ``turning_technology``. Units: mm, s,
rev/s.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import isfinite, pi

from stepnc_model.entities.adaptive import (
    AdaptiveMillingTechnology,
    Cutspeed,
    FeedratePerTooth,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.turning import (
    ConstCuttingSpeed,
    ConstSpindleSpeed,
    TurningTechnology,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.units import FeedUnit


class ProgrammedQuantity(StrEnum):
    """Kind of quantity that a programmed number gives."""

    FEED = "feed"
    FEED_PER_TOOTH = "feed per tooth"
    FEED_PER_REVOLUTION = "feed per revolution"
    CUTTING_SPEED = "cutting speed"
    SPINDLE_SPEED = "spindle speed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """Programmed number, with its instance and attribute in the file."""

    ref: Ref[Entity]
    """Instance that holds the number."""
    attribute: str
    quantity: ProgrammedQuantity
    value: float
    """Value in mm, mm/s or rev/s; never negative."""
    scale: float
    """Canonical value per number in the file; negative for a negative number."""

    def in_file(self, value: float) -> float:
        """Convert a canonical value to the number written in the file."""
        return value / self.scale


@dataclass(frozen=True, slots=True, kw_only=True)
class Programmed:
    """Programmed feed and spindle or cutting speed of a technology."""

    feed: Number
    speed: Number
    max_spindle_speed: float | None = None
    """Lathe's spindle speed limit at constant cutting speed, rev/s."""
    inhibition: str = ""
    """Reason why the feed must not be changed; empty if it may be."""
    is_synchronised: bool = False
    """Whether the feed is bound to the spindle by a pitch."""
    has_both_speeds: bool = False
    """Whether cutting speed and spindle speed are both given; the spindle speed is used."""

    def spindle_speed(self, diameter: float) -> float:
        """Spindle speed, rev/s, at a diameter in mm: as programmed, else v_c/(π·D)."""
        if self.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED:
            return self.speed.value
        speed = self.speed.value / (pi * diameter)
        return min(speed, self.max_spindle_speed) if self.max_spindle_speed else speed

    def feed_per_tooth(self, speed: float, teeth: int) -> float:
        """Feed per tooth, mm, at a spindle speed in rev/s."""
        value = self.feed.value
        if self.feed.quantity is ProgrammedQuantity.FEED_PER_TOOTH:
            return value
        if self.feed.quantity is ProgrammedQuantity.FEED_PER_REVOLUTION:
            return value / teeth
        return value / (speed * teeth)

    def feed_number(self, feed_per_tooth: float, *, speed: float, teeth: int) -> float:
        """Value of the file's feed attribute for a feed per tooth in mm."""
        factor = {
            ProgrammedQuantity.FEED_PER_TOOTH: 1.0,
            ProgrammedQuantity.FEED_PER_REVOLUTION: teeth,
        }.get(self.feed.quantity, teeth * speed)
        return self.feed.in_file(feed_per_tooth * factor)

    def speed_number(self, speed: float, diameter: float) -> float:
        """Value of the file's speed attribute for a spindle speed in rev/s."""
        is_spindle = self.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
        return self.speed.in_file(speed if is_spindle else speed * pi * diameter)


def programmed(program: Program, ref: Ref[Entity]) -> Programmed:
    """Read the programmed feed and speed of a technology.

    Raises
    ------
    SchemaError
        If feed or speed is missing, zero, negative or not finite.
    """
    technology = program.get(ref)
    if isinstance(technology, AdaptiveMillingTechnology):
        return _adaptive(program, ref, technology)
    if isinstance(technology, MillingTechnology):
        return _milling(program, ref, technology)
    if isinstance(technology, TurningTechnology):
        return _turning(program, ref, technology)
    raise program.error("is not a milling or turning technology", ref)


def _milling(program: Program, ref: Ref[Entity], technology: MillingTechnology) -> Programmed:
    """Read an ISO 14649-11 milling technology."""
    units = program.units_of(ref)
    quantity = _feed_quantity(units.feed)
    feed = _number(program, ref, "feedrate", quantity, scale=units.feed_scale) or _number(
        program, ref, "feedrate_per_tooth", ProgrammedQuantity.FEED_PER_TOOTH, scale=1.0
    )
    cutspeed = _number(
        program, ref, "cutspeed", ProgrammedQuantity.CUTTING_SPEED, scale=units.cutting_speed
    )
    spindle = _number(
        program, ref, "spindle", ProgrammedQuantity.SPINDLE_SPEED, scale=units.spindle
    )
    speed = spindle or cutspeed
    if feed is None:
        raise program.error(
            f"neither feedrate nor feedrate_per_tooth is given (ISO 14649-11 WR2); {_REMEDY}",
            ref,
            "feedrate",
        )
    if speed is None:
        raise program.error(
            "neither cutspeed nor spindle is given (ISO 14649-11 WR1)", ref, "spindle"
        )
    inhibited = "inhibit_feedrate_override" if technology.inhibit_feedrate_override else ""
    return Programmed(
        feed=feed,
        speed=speed,
        inhibition=inhibited,
        is_synchronised=bool(technology.synchronize_spindle_with_feed),
        has_both_speeds=spindle is not None and cutspeed is not None,
    )


def _adaptive(
    program: Program, ref: Ref[Entity], technology: AdaptiveMillingTechnology
) -> Programmed:
    """Read NIST's proposed form, in which feed and speed are entities that allow adaptation."""
    units = program.units_of(ref)
    speed_entity = program.get(technology.its_speed)
    feed_entity = program.get(technology.its_feed)
    is_cutting = isinstance(speed_entity, Cutspeed)
    is_per_tooth = isinstance(feed_entity, FeedratePerTooth)
    speed = _number(
        program,
        technology.its_speed,
        "value",
        ProgrammedQuantity.CUTTING_SPEED if is_cutting else ProgrammedQuantity.SPINDLE_SPEED,
        scale=units.cutting_speed if is_cutting else units.spindle,
    )
    feed = _number(
        program,
        technology.its_feed,
        "value",
        ProgrammedQuantity.FEED_PER_TOOTH if is_per_tooth else _feed_quantity(units.feed),
        scale=1.0 if is_per_tooth else units.feed_scale,
    )
    if feed is None or speed is None:
        owner = technology.its_feed if feed is None else technology.its_speed
        raise program.error("the technology has no feed or no speed", owner, "value")
    inhibition = "adaptive_allowed is false" if not feed_entity.adaptive_allowed else ""
    if technology.inhibit_feedrate_override:
        inhibition = "inhibit_feedrate_override"
    return Programmed(
        feed=feed,
        speed=speed,
        inhibition=inhibition,
        is_synchronised=bool(technology.synchronize_spindle_with_feed),
    )


def _turning(program: Program, ref: Ref[Entity], technology: TurningTechnology) -> Programmed:
    """Read an ISO 14649-12 turning technology."""
    units = program.units_of(ref)
    quantity = _feed_quantity(units.feed)
    feed = _number(program, ref, "feedrate", quantity, scale=units.feed_scale) or _number(
        program, ref, "feed_per_revolution", ProgrammedQuantity.FEED_PER_REVOLUTION, scale=1.0
    )
    if feed is None:
        raise program.error(
            "neither feedrate nor feed_per_revolution is given; --feed gives one, as --feed "
            "0.2mm/rev",
            ref,
            "feedrate",
        )
    if technology.spindle_speed is None:
        raise program.error("the technology has no spindle speed", ref, "spindle_speed")
    spindle = technology.spindle_speed
    entity: Entity = program.get(spindle)
    if not isinstance(entity, (ConstSpindleSpeed, ConstCuttingSpeed)):
        raise program.error("is not a spindle speed, where one is expected", spindle)
    is_constant = isinstance(entity, ConstSpindleSpeed)
    speed = _number(
        program,
        spindle,
        "rot_speed" if is_constant else "speed",
        ProgrammedQuantity.SPINDLE_SPEED if is_constant else ProgrammedQuantity.CUTTING_SPEED,
        scale=units.spindle if is_constant else units.cutting_speed,
    )
    if speed is None:
        attribute = "rot_speed" if is_constant else "speed"
        raise program.error("no speed value is given", spindle, attribute)
    top = entity.max_speed if isinstance(entity, ConstCuttingSpeed) else None
    return Programmed(
        feed=feed,
        speed=speed,
        max_spindle_speed=abs(top) * units.spindle if top else None,
        inhibition="inhibit_feedrate_override" if technology.inhibit_feedrate_override else "",
        is_synchronised=bool(technology.sync_spindle_and_z_feed),
    )


def _feed_quantity(unit: FeedUnit) -> ProgrammedQuantity:
    """Quantity of the attribute ``feedrate`` in a unit profile."""
    return {
        FeedUnit.MM_PER_TOOTH: ProgrammedQuantity.FEED_PER_TOOTH,
        FeedUnit.MM_PER_REVOLUTION: ProgrammedQuantity.FEED_PER_REVOLUTION,
    }.get(unit, ProgrammedQuantity.FEED)


def _number(
    program: Program,
    ref: Ref[Entity],
    attribute: str,
    quantity: ProgrammedQuantity,
    *,
    scale: float,
) -> Number | None:
    """Read one number of an instance; None if absent, an error if not positive."""
    written = getattr(program.get(ref), attribute)
    if written is None:
        return None
    size = abs(written) if quantity is ProgrammedQuantity.SPINDLE_SPEED else written
    if not isfinite(size) or size <= 0.0:
        message = f"{quantity.value} {written:g} is not valid: it must be positive"
        if written == 0.0 and attribute in _FEEDS:
            message += f"; {_REMEDY}"
        raise program.error(message, ref, attribute)
    return Number(
        ref=ref,
        attribute=attribute,
        quantity=quantity,
        value=size * scale,
        scale=scale if written > 0.0 else -scale,
    )


_FEEDS = ("feedrate", "feedrate_per_tooth", "feed_per_revolution")
"""Attributes that ``--feed`` gives where they are missing or 0."""

_REMEDY = "--feed gives one, as --feed 240 (mm/min) or --feed 0.1mm/tooth"
