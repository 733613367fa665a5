"""Check for implausible numbers, a sign that a program is written in other units.

The unit of a file's numbers cannot be inferred, so nothing is guessed: implausible numbers
become findings, which name the unit profiles that would make them plausible.
"""

from collections.abc import Iterator, Sequence
from math import pi

from stepnc_model.entities.enums import Hand
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.technology import Number, Programmed, ProgrammedQuantity, programmed
from stepnc_model.tool import hand_of, tool_of
from stepnc_model.units import PROFILES, UnitProfile

MAX_SPINDLE_SPEED = 300.0
"""Greatest plausible spindle speed, rev/s; only dental and circuit-board machines exceed it."""

MAX_CUTTING_SPEED = 25_000.0
"""Greatest plausible cutting speed, mm/s; aluminium is milled at up to 1500 m/min."""

LEAST_CUTTING_SPEED = 8.0
"""Least plausible cutting speed for milling and drilling, mm/s, about 0.5 m/min."""

LEAST_FEED_PER_TOOTH = 5e-4
"""Least plausible feed per tooth, mm; no edge is sharp enough to cut less."""

MAX_TURNING_FEED = 5.0
"""Greatest plausible turning feed, mm per revolution."""


def implausible(program: Program) -> tuple[Finding, ...]:
    """Findings about implausible numbers in all workingsteps of a program."""
    found: dict[str, Finding] = {}
    for step in program.workingsteps:
        for finding in _findings(program, step):
            found[str(finding)] = finding
    return tuple(found.values())


def refusal(program: Program, steps: Sequence[ResolvedWorkingstep]) -> SchemaError | None:
    """Error that names the first implausible number and the unit profiles that would fit."""
    for step in steps:
        for finding in _findings(program, step):
            if finding.severity is Severity.WARNING and finding.rule == RULE:
                fitting = [
                    name for name, units in PROFILES.items() if _all_fit(program, steps, units)
                ]
                advice = (
                    f"plausible with --units {' or '.join(fitting)}"
                    if fitting
                    else "no unit profile makes all numbers plausible"
                )
                return SchemaError(
                    f"{finding.message}; {advice}",
                    entity=finding.entity,
                    attribute=finding.attribute,
                    line=finding.line,
                )
    return None


RULE = "ISO 14649-10 4.2.1"


def _findings(program: Program, step: ResolvedWorkingstep) -> Iterator[Finding]:
    """Findings about implausible numbers in one workingstep."""
    try:
        with program.using(step.operation_ref):
            conditions = programmed(program, step.technology_ref)
            oddities = list(_oddities(program, step, conditions))
            is_left = hand_of(program, step.tool_ref) is Hand.LEFT
    except SchemaError as error:
        yield Finding(
            severity=Severity.ERROR,
            message=str(error),
            entity=error.entity,
            attribute=error.attribute,
            line=error.line,
        )
        return
    for number, message in oddities:
        yield Finding(
            severity=Severity.WARNING,
            message=message,
            entity=program.label(number.ref),
            attribute=number.attribute,
            line=program.line(number.ref),
            rule=RULE,
        )
    speed = conditions.speed
    is_milling = speed.attribute == "spindle"
    if is_milling and speed.scale > 0.0 and not is_left:
        yield program.finding(
            Severity.NOTE,
            "positive spindle speed means counter-clockwise, but the tool is not left-handed",
            speed.ref,
            "spindle",
        )


def _oddities(
    program: Program, step: ResolvedWorkingstep, conditions: Programmed
) -> Iterator[tuple[Number, str]]:
    """Implausible numbers of a workingstep, each with the reason."""
    speed = conditions.speed
    is_spindle = speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
    if is_spindle and speed.value > MAX_SPINDLE_SPEED:
        yield speed, f"spindle {speed.value:g} rev/s exceeds {MAX_SPINDLE_SPEED:g} rev/s"
    if not is_spindle and speed.value > MAX_CUTTING_SPEED:
        text = (
            f"cutting speed {speed.value / 1e3:g} m/s exceeds {MAX_CUTTING_SPEED / 1e3:g} m/s"
        )
        yield speed, text
    if conditions.is_synchronised:
        return
    tool = tool_of(program, step.tool_ref)
    if tool.diameter <= 0.0:
        is_per_turn = conditions.feed.quantity is ProgrammedQuantity.FEED_PER_REVOLUTION
        if is_per_turn and conditions.feed.value > MAX_TURNING_FEED:
            yield conditions.feed, f"feed {conditions.feed.value:g} mm per revolution"
        return
    turning = conditions.spindle_speed(tool.diameter)
    around = pi * tool.diameter * turning
    if around < LEAST_CUTTING_SPEED:
        yield speed, f"the cutting speed is only {around * 60.0 / 1e3:.3g} m/min"
    feed = conditions.feed_per_tooth(turning, tool.teeth)
    radius = 0.5 * tool.diameter
    if feed > radius:
        yield conditions.feed, f"feed per tooth {feed:g} mm exceeds the radius {radius:g} mm"
    elif feed < LEAST_FEED_PER_TOOTH:
        text = f"feed per tooth {feed:.3g} mm is below {LEAST_FEED_PER_TOOTH:g} mm"
        yield conditions.feed, text


def _all_fit(
    program: Program, steps: Sequence[ResolvedWorkingstep], units: UnitProfile
) -> bool:
    """Whether a unit profile makes the numbers of all workingsteps plausible."""
    other = Program(program.file, units=units, name=program.name)
    for step in steps:
        try:
            with other.using(step.operation_ref):
                conditions = programmed(other, step.technology_ref)
                oddities = list(_oddities(other, step, conditions))
        except SchemaError:
            continue
        if oddities:
            return False
    return True
