"""Check for implausible numbers, a sign that a program is written in other units.

Implausible numbers become findings. Where exactly one unit profile makes all numbers of a
program plausible, it is proposed with the numbers that it gives; nothing is converted unless
the user asks for it. Two profiles that fit are never decided between: a feed of 0.1 may be per
tooth or per revolution, and only somebody who knows the program can tell.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isclose, pi

from stepnc_model.entities.enums import Hand
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.remedy import error_of
from stepnc_model.programs.technology import Number, Programmed, ProgrammedQuantity, programmed
from stepnc_model.programs.tool import hand_of, tool_of
from stepnc_model.units import (
    ISO,
    PROFILES,
    UnitProfile,
    m_min_from_speed,
    m_s_from_speed,
    rpm_from_rev_s,
)

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

SAME_SPEED = 0.002
"""Relative difference up to which a cutting speed counts as that of the spindle speed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitProposal:
    """Unit profiles that make all numbers of some workingsteps plausible."""

    profiles: tuple[UnitProfile, ...]
    """Profiles that fit and differ in at least one number, in the order of ``PROFILES``."""
    evidence: tuple[Finding, ...]
    """Numbers of each technology as the first of them gives them."""

    @property
    def only(self) -> UnitProfile | None:
        """The profile, if only one fits."""
        return self.profiles[0] if len(self.profiles) == 1 else None

    @property
    def words(self) -> str:
        """Options that would choose a fitting profile."""
        return " or ".join(profile.name for profile in self.profiles)


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
                if program.file is not program.source:
                    # Units of an AP238 file are its own: only the number can be another one.
                    return error_of(finding)
                words = proposal(program, steps).words
                advice = (
                    f"plausible with --units {words}"
                    if words
                    else "no unit profile makes all numbers plausible"
                )
                return error_of(replace(finding, message=f"{finding.message}; {advice}"))
    return None


def proposal(program: Program, steps: Sequence[ResolvedWorkingstep]) -> UnitProposal:
    """Unit profiles that make all numbers of some workingsteps plausible, with evidence.

    Profiles that give the same numbers count once. Where a technology gives both a cutting
    speed and a spindle speed, profiles in which they agree come before those in which they do
    not. Workingsteps that cannot be read are passed over.

    Parameters
    ----------
    program : Program
        Program in any unit profile.

    Returns
    -------
    UnitProposal
    """
    found: dict[tuple[_UnitReading, ...], UnitProfile] = {}
    for units in PROFILES.values():
        readings = _readings(program, steps, units)
        if readings is not None:
            found.setdefault(readings, units)
    agreeing = {
        readings: units
        for readings, units in found.items()
        if any(each.agrees for each in readings)
        and not any(each.agrees is False for each in readings)
    }
    chosen = agreeing or found
    first = next(iter(chosen.items()), None)
    return UnitProposal(
        profiles=tuple(chosen.values()),
        evidence=() if first is None else tuple(_evidence(program, *first)),
    )


def units_by_numbers(
    program: Program, steps: Sequence[ResolvedWorkingstep]
) -> tuple[UnitProfile, tuple[Finding, ...]]:
    """The only unit profile that makes all numbers plausible, with the numbers that it gives.

    Raises
    ------
    SchemaError
        If several profiles fit, or none does.
    """
    found = proposal(program, steps)
    if found.only is not None:
        return found.only, found.evidence
    if not found.profiles:
        raise SchemaError("units auto: no unit profile makes all numbers plausible")
    raise SchemaError(
        f"units auto: the numbers are plausible with --units {found.words}; name one of them"
        + (" (iso is the standard)" if ISO in found.profiles else "")
    )


def unit_findings(program: Program) -> tuple[Finding, ...]:
    """Findings that propose units, for a program whose numbers cannot be in its units."""
    error = refusal(program, program.workingsteps)
    if error is None or program.file is not program.source:
        return ()
    found = proposal(program, program.workingsteps)
    name = program.units.name
    if found.only is not None:
        text = (
            f"the numbers cannot be in the units '{name}', and all are plausible with "
            f"--units {found.only.name}"
        )
        return _warned(text), *found.evidence
    if found.profiles:
        text = (
            f"the numbers cannot be in the units '{name}'; they are plausible with "
            f"--units {found.words}: name the one that the program was written in"
        )
        return (_warned(text),)
    text = f"the numbers cannot be in the units '{name}' nor in any other known ones"
    return (_warned(text),)


def _warned(text: str) -> Finding:
    return Finding(severity=Severity.WARNING, message=text, rule=RULE)


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
            message=error.rule,
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
            Severity.WARNING,
            "positive spindle speed means counter-clockwise (M4), but the tool is not "
            "left-handed",
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
            f"cutting speed {m_s_from_speed(speed.value):g} m/s exceeds "
            f"{m_s_from_speed(MAX_CUTTING_SPEED):g} m/s"
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
        yield speed, f"the cutting speed is only {m_min_from_speed(around):.3g} m/min"
    feed = conditions.feed_per_tooth(turning, tool.teeth)
    radius = 0.5 * tool.diameter
    if feed > radius:
        yield conditions.feed, f"feed per tooth {feed:g} mm exceeds the radius {radius:g} mm"
    elif feed < LEAST_FEED_PER_TOOTH:
        text = f"feed per tooth {feed:.3g} mm is below {LEAST_FEED_PER_TOOTH:g} mm"
        yield conditions.feed, text


@dataclass(frozen=True, slots=True, kw_only=True)
class _UnitReading:
    """Numbers of one workingstep in a unit profile, rounded to be compared."""

    technology: int
    spindle_speed: float
    """Spindle speed, rev/s; 0 for a constant cutting speed in turning."""
    cutting_speed: float
    """Cutting speed, mm/s; 0 for a constant spindle speed in turning."""
    feed_per_turn: float
    """Feed per revolution, mm; in turning at a constant cutting speed perhaps in mm/s."""
    teeth: int
    agrees: bool | None
    """Whether the cutting speed given beside a spindle speed is that of the tool."""


def _readings(
    program: Program, steps: Sequence[ResolvedWorkingstep], units: UnitProfile
) -> tuple[_UnitReading, ...] | None:
    """Numbers of the workingsteps in a unit profile; None if some are not plausible."""
    other = Program(program.file, units=units, name=program.name)
    found: list[_UnitReading] = []
    for step in steps:
        try:
            with other.using(step.operation_ref):
                conditions = programmed(other, step.technology_ref)
                if any(True for _ in _oddities(other, step, conditions)):
                    return None
                found.append(_reading(other, step, conditions, units))
        except SchemaError:
            if units.drilling_feed is not None and _is_shared(other, step):
                return None
    return tuple(found)


def _is_shared(program: Program, step: ResolvedWorkingstep) -> bool:
    """True if a technology is refused because two kinds of operation share it."""
    try:
        program.units_of(step.technology_ref)
    except SchemaError:
        return True
    return False


def _reading(
    program: Program, step: ResolvedWorkingstep, conditions: Programmed, units: UnitProfile
) -> _UnitReading:
    """Numbers of one workingstep."""
    tool = tool_of(program, step.tool_ref)
    speed, feed = conditions.speed, conditions.feed
    is_spindle = speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
    if tool.diameter <= 0.0:
        turning = speed.value if is_spindle else 0.0
        around = 0.0 if is_spindle else speed.value
        is_per_time = feed.quantity is ProgrammedQuantity.FEED and turning > 0.0
        per_turn = feed.value / turning if is_per_time else feed.value
    else:
        turning = conditions.spindle_speed(tool.diameter)
        around = pi * tool.diameter * turning
        per_turn = conditions.feed_per_tooth(turning, tool.teeth) * tool.teeth
    return _UnitReading(
        technology=int(step.technology_ref),
        spindle_speed=_short(turning),
        cutting_speed=_short(around),
        feed_per_turn=_short(per_turn),
        teeth=tool.teeth,
        agrees=_agrees(program, step, units, around) if conditions.has_both_speeds else None,
    )


def _agrees(
    program: Program, step: ResolvedWorkingstep, units: UnitProfile, around: float
) -> bool:
    """True if the cutting speed of a technology is that of its spindle speed."""
    written = getattr(program.get(step.technology_ref), "cutspeed", None)
    return written is not None and isclose(
        written * units.cutting_speed, around, rel_tol=SAME_SPEED
    )


def _short(value: float) -> float:
    """Value rounded to nine digits."""
    return float(f"{value:.9g}")


def _evidence(
    program: Program, readings: tuple[_UnitReading, ...], units: UnitProfile
) -> Iterator[Finding]:
    """Numbers of each technology in a unit profile, once."""
    seen: set[str] = set()
    for each in readings:
        ref = next(
            step.technology_ref
            for step in program.workingsteps
            if int(step.technology_ref) == each.technology
        )
        parts = []
        if each.spindle_speed > 0.0:
            parts.append(f"{rpm_from_rev_s(each.spindle_speed):.4g} rpm")
        if each.cutting_speed > 0.0:
            parts.append(f"{m_min_from_speed(each.cutting_speed):.3g} m/min")
        parts.append(f"{each.feed_per_turn / each.teeth:.3g} mm per tooth")
        text = f"in units '{units.name}': {', '.join(parts)}"
        finding = program.finding(Severity.NOTE, text, ref)
        if str(finding) not in seen:
            seen.add(str(finding))
            yield finding
