"""Limits that machine, material and tool grade put on a cut.

A value that a source does not give sets no limit. All loads come from :mod:`optimiser.loads`;
this module does not depend on how a problem is solved.

Where the spindle speed is not free it stays as programmed, but never above what tool and
machine allow. A speed below the recommended window costs time and wears the edge in other
ways; a speed above it burns the edge. So a speed is lowered to its bound and never raised,
except to the least speed of the spindle.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, pi

from optimiser import loads
from optimiser.chip_load import (
    borrowed_datum,
    catalogue_feed,
    feed_origin,
    greatest_feed,
    is_borrowed_feed,
    least_chip,
    least_feed,
)
from optimiser.conditions import CuttingConditions, PermittedDeflection
from optimiser.cut import Cut, CutKind
from optimiser.problem import BoundSide, Limit, LimitName, Monomial
from optimiser.roughness import surface_limits
from optimiser.workingstep import told
from simulator.edge_material import correction_of, edge_material
from simulator.library import find_window, reaming_allowances
from simulator.physics.drilling import LIPS_ONLY
from simulator.physics.holding import usable_speed
from simulator.physics.spindle import CurveSegment, curve_segments
from simulator.physics.strength import end_mill
from simulator.spec import (
    CuttingMaterial,
    DrillPoint,
    Machine,
    ToolGrade,
    ToolKind,
    WorkMaterial,
)
from simulator.tool_windows import grade_for
from simulator.work_holding import Chuck
from stepnc_model.technology import Programmed
from stepnc_model.tool import Tool
from stepnc_model.units import m_min_from_speed, rpm_from_rev_s

PLUNGE_FEED_RATIO = 0.5
"""Greatest feed per tooth in a straight plunge over the feed along the pass (customary).

Near the axis the edges hardly move; Fanar, general catalogue 2021, p. 329, uses 25 to 50 % of
the table feed on the way into the material.
"""

DEEPER = 1.01
"""Depth of the deepest place over that of a pass above which it is named."""

LEAST_ALLOWANCE = 1e-6
"""Least allowance of a reamer that is distinguished from none, mm."""

VENDOR_FEED = "max_feed_mm of the tool in a tool table"
"""Datum that brings a greatest feed where no source gives one."""

STRAIGHT_DOWN = "straight down"
"""Words added to the limits of a plunge to distinguish them from those along the pass."""

KW, NM, MM_MIN, M_MIN, RPM = 1e-3, 1e-3, 60.0, 0.06, 60.0
"""Factors from canonical units to user units."""


def force_factor(at: CuttingConditions) -> float:
    """Force factor K = K_γ·K_v times the accepted correction; 1 for a constant k_s material."""
    correction = correction_of(at.material, at.grade, at.cutting_material)
    return at.force_factor * correction.factor


def force_load(cut: Cut, at: CuttingConditions) -> Monomial:
    """Tangential force of the cut, N."""
    return loads.cutting_force(cut, at.material.kienzle, force_factor(at), drill_point(at))


def drill_point(at: CuttingConditions) -> DrillPoint:
    """Geometry of the drill point, or of the end of a mill, that cuts."""
    return (at.grade.point if at.grade is not None else None) or LIPS_ONLY


def power_load(cut: Cut, at: CuttingConditions) -> Monomial:
    """Motor power of the cut, W."""
    return loads.motor_power(cut, force_load(cut, at), at.machine.spindle.efficiency)


def limits_of(cut: Cut, at: CuttingConditions) -> tuple[Limit, ...]:
    """All limits of a cut that hold at every spindle speed."""
    return (
        *_load_limits(cut, at),
        *_depth_limits(cut, at),
        *allowance_limits(cut, at),
        *_record_limits(cut, at),
        *surface_limits(cut, at),
        *(surface_limits(cut.floor, at) if cut.floor is not None else ()),
        *speed_limits(cut, at),
    )


def _load_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on the loads of the walls, the swept floor and the straight plunge."""
    yield from machine_limits(cut, at)
    yield from tool_limits(cut, at)
    if cut.floor is not None:
        floor = cut.floor
        # The floor sweep does not touch the walls, and tool bending does not change the depth.
        swept = replace(at, deflection=PermittedDeflection())
        for limit in (*machine_limits(floor, swept), *tool_limits(floor, swept)):
            yield limit.at_depth(floor.total_depth)
    if cut.plunge is not None:
        yield from map(straight_down, _plunge_limits(cut, cut.plunge, at))


def _plunge_limits(cut: Cut, plunge: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on feed per tooth and thrust where a mill plunges straight down.

    Without a catalogue feed, the programmed feed is the only one known to be safe. Half of the
    catalogue feed is a custom, not physics, so it must not fall below the rubbing limit.
    """
    highest = catalogue_feed(cut, at)
    borne = cut.programmed.feed
    if highest is not None:
        rubbing = least_chip(cut, at) / _chip_ratio(cut)
        borne = min(highest, max(PLUNGE_FEED_RATIO * highest, rubbing))
    yield Limit(
        name=LimitName.PROGRAMMED_FEED if highest is None else LimitName.FEED_PER_TOOTH,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=borne,
        unit="mm",
        step=0.01,
    )
    if at.machine.max_cutting_force is not None:
        yield Limit(
            name=LimitName.CUTTING_FORCE,
            load=loads.thrust(plunge, at.material.kienzle, force_factor(at), drill_point(at)),
            bound=at.machine.max_cutting_force,
            unit="N",
            step=100.0,
        )


def straight_down(limit: Limit) -> Limit:
    """Label a limit as one of a straight plunge."""
    return replace(limit, label=f"{limit.words} {STRAIGHT_DOWN}")


def spindle_limits(cut: Cut, at: CuttingConditions, segment: CurveSegment) -> tuple[Limit, ...]:
    """Limits on motor power and torque on one stretch of the spindle's curve."""
    limits = _spindle_limits(cut, at, segment)
    if cut.plunge is not None:
        limits += tuple(map(straight_down, _spindle_limits(cut.plunge, at, segment)))
    if cut.floor is None:
        return limits
    floor = cut.floor
    swept = _spindle_limits(floor, at, segment)
    return (*limits, *(limit.at_depth(floor.total_depth) for limit in swept))


def allowance_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on what a reamer takes off the diameter; none if the hole before is unknown."""
    known = cut.previous_diameter > 0.0 or cut.widest_drilled is not None
    if cut.tool_kind is not ToolKind.REAMER or not known or at.machine.only_stated_limits:
        return
    found = next(each for each in reaming_allowances() if cut.tool.diameter <= each.up_to)
    left = cut.drilled_diameter - cut.previous_diameter
    for bound, sense in (
        (found.greatest, BoundSide.AT_MOST),
        (found.least, BoundSide.AT_LEAST),
    ):
        yield Limit(
            name=LimitName.ALLOWANCE,
            load=Monomial(coefficient=max(left, LEAST_ALLOWANCE)),
            bound=bound,
            unit="mm",
            sense=sense,
            origin=f"on the diameter, {found.source}",
        )


def _spindle_limits(
    cut: Cut, at: CuttingConditions, segment: CurveSegment
) -> tuple[Limit, ...]:
    """Limits on motor power and torque for one cut."""
    force = force_load(cut, at)
    power = Limit(
        name=LimitName.MOTOR_POWER,
        load=power_load(cut, at),
        bound=segment.power_coefficient,
        bound_speed_exponent=segment.power_exponent,
        unit="kW",
        scale=KW,
        origin=_power_origin(at),
    )
    if segment.torque_coefficient is None:
        return (power,)
    torque = Limit(
        name=LimitName.SPINDLE_TORQUE,
        load=loads.torque(cut, force),
        bound=segment.torque_coefficient,
        bound_speed_exponent=segment.torque_exponent,
        unit="N·m",
        scale=NM,
    )
    return power, torque


def _power_origin(at: CuttingConditions) -> str:
    """Note that the power bound excludes idling; empty if it is the machine's whole power."""
    spindle = at.machine.spindle
    idles = spindle.idle_power or spindle.idle_power_per_speed
    if at.machine.only_stated_limits or not idles:
        return ""
    return "the drive power less the idling power of the spindle"


def segment_at(at: CuttingConditions, speed: float) -> CurveSegment:
    """Stretch of the spindle's curve that contains a speed, or the nearest beyond its ends."""
    segments = curve_segments(at.machine.spindle)
    return next((part for part in segments if speed <= part.max_speed), segments[-1])


def speed_range(cut: Cut, at: CuttingConditions) -> tuple[float, float]:
    """Least and greatest spindle speed allowed by machine and tool, rev/s."""
    low, high = 0.0, inf
    for limit in speed_limits(cut, at):
        bound = limit.bound / limit.load.coefficient
        if limit.sense is BoundSide.AT_MOST:
            high = min(high, bound)
        else:
            low = max(low, bound)
    return low, high


def machine_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on the cutting force and the feed rate of the machine."""
    machine = at.machine
    if machine.max_cutting_force is not None:
        is_drill = cut.kind is CutKind.DRILLING
        yield Limit(
            name=LimitName.CUTTING_FORCE,
            load=loads.thrust(cut, at.material.kienzle, force_factor(at), drill_point(at))
            if is_drill
            else force_load(cut, at),
            bound=machine.max_cutting_force,
            unit="N",
            step=100.0,
        )
    if machine.max_feed is not None:
        yield Limit(
            name=LimitName.FEED_MECHANISM,
            load=Monomial(coefficient=cut.tool.teeth, feed_exponent=1.0, speed_exponent=1.0),
            bound=machine.max_feed,
            unit="mm/min",
            scale=MM_MIN,
            step=100.0,
        )


def tool_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on feed per tooth, chip thickness, deflection and shank strength."""
    highest = greatest_feed(cut, at)
    feed = Monomial(coefficient=1.0, feed_exponent=1.0)
    words = "feed per revolution" if cut.tool.diameter <= 0.0 else ""
    if highest is not None:
        yield Limit(
            name=LimitName.FEED_PER_TOOTH,
            label=words,
            load=feed,
            bound=highest,
            unit="mm",
            step=0.01,
            origin=feed_origin(cut, at),
            datum=borrowed_datum(at) if is_borrowed_feed(cut, at) else "",
        )
    if at.grade is None:
        return
    if highest is None and not at.machine.only_stated_limits:
        yield Limit(
            name=LimitName.PROGRAMMED_FEED,
            load=feed,
            bound=cut.programmed.feed,
            unit="mm",
            step=0.01,
            origin=f"no source for more with {at.grade.name}",
            datum=VENDOR_FEED,
            stands_for=LimitName.FEED_PER_TOOTH,
        )
    lowest = least_feed(cut, at)
    if lowest is not None and not at.machine.only_stated_limits:
        yield Limit(
            name=LimitName.FEED_PER_TOOTH,
            label=f"{words or LimitName.FEED_PER_TOOTH.words} against rubbing",
            load=feed,
            bound=lowest,
            unit="mm",
            sense=BoundSide.AT_LEAST,
            step=0.01,
        )
    yield Limit(
        name=LimitName.CHIP_THICKNESS,
        load=Monomial(coefficient=_chip_ratio(cut), feed_exponent=1.0),
        bound=least_chip(cut, at),
        unit="mm",
        sense=BoundSide.AT_LEAST,
        step=0.001,
    )
    if is_bent(cut):
        yield from _bending_limits(cut, at, at.grade)


def _bending_limits(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> Iterator[Limit]:
    """Limits on deflection and bending stress of an end mill clamped at one end."""
    shank = end_mill(
        cut.tool.diameter,
        cutting_edge_length=cut.tool.cutting_edge_length,
        youngs_modulus=grade.youngs_modulus,
    )
    normal = loads.wall_force(cut, at.material.kienzle, force_factor(at))
    if normal is not None:
        yield Limit(
            name=LimitName.TOOL_DEFLECTION,
            load=loads.scaled(normal, shank.compliance),
            bound=at.deflection.value,
            origin=at.deflection.origin,
            unit="mm",
            step=0.01,
        )
    across = loads.shank_force(cut, at.material.kienzle, force_factor(at))
    yield Limit(
        name=LimitName.SHANK_STRENGTH,
        load=loads.scaled(across, shank.stress(1.0)),
        bound=grade.bending_strength,
        unit="N/mm²",
        step=100.0,
    )


def is_bent(cut: Cut) -> bool:
    """Whether the tool bends under load: end mills do, face mills do not."""
    return cut.kind is CutKind.MILLING and cut.tool_kind is ToolKind.ENDMILL


def _record_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on feed per tooth and motor power that the record in the file sets."""
    if at.bounds.feed_per_tooth is not None:
        yield Limit(
            name=LimitName.FEED_PER_TOOTH,
            load=Monomial(coefficient=1.0, feed_exponent=1.0),
            bound=at.bounds.feed_per_tooth,
            unit="mm",
            step=0.01,
            origin="the maximum of the record in the file",
        )
    if at.bounds.motor_power is not None:
        yield Limit(
            name=LimitName.MOTOR_POWER,
            load=power_load(cut, at),
            bound=at.bounds.motor_power,
            unit="kW",
            scale=KW,
            origin="the power of the record in the file",
        )


def _depth_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limit on the depth of one pass from machine, tool and grade."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING}:
        return
    of_tool = _grade_depth(cut, at)
    bounds = [at.machine.max_axial_depth, cut.depth_bound, at.bounds.axial_depth]
    known = [bound for bound in (*bounds, of_tool.bound) if bound is not None]
    if known:
        is_of_tool = min(known) == of_tool.bound
        yield Limit(
            name=LimitName.AXIAL_DEPTH,
            label="depth at the deepest place" if cut.deepest_share > DEEPER else "",
            load=Monomial(coefficient=cut.deepest_share, depth_exponent=1.0),
            bound=min(known),
            unit="mm",
            origin=of_tool.origin if is_of_tool else "",
            datum=of_tool.datum if is_of_tool else "",
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sourced:
    """Bound with its origin, and the datum that would bring a better one."""

    bound: float | None = None
    origin: str = ""
    datum: str = ""


def _grade_depth(cut: Cut, at: CuttingConditions) -> _Sourced:
    """Greatest depth of a pass by the windows of the tool, mm."""
    grade, given = at.grade, cut.programmed.depth
    if grade is None:
        return _Sourced()
    bounds = [grade.max_depth, depth_by_diameter(cut, at, grade)]
    known = [bound for bound in bounds if bound is not None]
    if not known:
        if grade.has_feeds or at.machine.only_stated_limits:
            return _Sourced()
        origin = f"no source for more with {grade.name}"
        return _Sourced(bound=given, origin=origin, datum="a catalogue of the tool")
    found = _borrowed(min(known), given, at)
    if found.origin or not _is_wide(cut, at, grade):
        return found
    return replace(found, origin=f"for a width of {_width_ratio(cut):.3g} of the diameter")


def depth_by_diameter(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> float | None:
    """Greatest depth of a pass as a ratio of the diameter, mm; None without one.

    Beyond the width of the window it falls linearly with a_e/D to that in a full slot.
    """
    ratio, window = grade.max_depth_ratio, grade.depth_window
    if ratio is None:
        return None
    if window is not None and _is_wide(cut, at, grade):
        beyond = (_width_ratio(cut) - window.width_ratio) / (1.0 - window.width_ratio)
        ratio -= min(1.0, beyond) * (ratio - min(ratio, window.slot_ratio))
    return ratio * grade.size(cut.diameter)


def _is_wide(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> bool:
    """Whether a milling cut is wider than the depths of the tool are meant for."""
    window = grade.depth_window
    if window is None or cut.kind is not CutKind.MILLING or at.machine.only_stated_limits:
        return False
    return _width_ratio(cut) > window.width_ratio + WRITTEN


def _width_ratio(cut: Cut) -> float:
    """Radial width over diameter where the force is greatest."""
    return min(cut.radial_width / cut.diameter, 1.0) if cut.diameter > 0.0 else 0.0


def _borrowed(bound: float, given: float, at: CuttingConditions) -> _Sourced:
    """Bound by a window of the tool: one of another group does not slow a program down."""
    if at.grade is None or not at.grade.borrowed:
        return _Sourced(bound=bound)
    above = "as programmed, above " if given > bound else ""
    origin = f"{above}{at.grade.borrowed}"
    return _Sourced(bound=max(bound, given), origin=origin, datum=borrowed_datum(at))


def speed_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits on cutting speed and spindle speed."""
    low, high = cutting_speed_window(at)[0], _greatest_cutting_speed(cut, at)
    spindle = at.machine.spindle
    velocity = Monomial(coefficient=pi * cut.diameter, speed_exponent=1.0)
    turning = Monomial(coefficient=1.0, speed_exponent=1.0)
    for name, load, bound, sense in (
        (LimitName.CUTTING_SPEED, velocity, high.bound, BoundSide.AT_MOST),
        (LimitName.CUTTING_SPEED, velocity, low, BoundSide.AT_LEAST),
        (LimitName.SPINDLE_SPEED, turning, spindle.max_speed, BoundSide.AT_MOST),
        (LimitName.SPINDLE_SPEED, turning, spindle.min_speed, BoundSide.AT_LEAST),
        (LimitName.SPINDLE_SPEED, turning, _chuck_speed(at), BoundSide.AT_MOST),
    ):
        if bound is None or bound <= 0.0:
            continue
        is_velocity = name is LimitName.CUTTING_SPEED
        yield Limit(
            name=name,
            load=load,
            bound=bound,
            sense=sense,
            unit="m/min" if is_velocity else "rpm",
            scale=M_MIN if is_velocity else RPM,
            step=10.0 if is_velocity else 100.0,
            origin=high.origin if is_velocity and sense is BoundSide.AT_MOST else "",
            datum=high.datum if is_velocity and sense is BoundSide.AT_MOST else "",
        )


def _greatest_cutting_speed(cut: Cut, at: CuttingConditions) -> _Sourced:
    """Greatest cutting speed, mm/s; the programmed one without a source."""
    high, grade = cutting_speed_window(at)[1], at.grade
    if grade is None or at.machine.only_stated_limits:
        return _Sourced(bound=high)
    given = pi * cut.diameter * cut.programmed.speed
    if high is None:
        datum = f"a [[window]] of {at.cutting_material} in the file of '{at.material.name}'"
        origin = f"no source for more with {grade.name}"
        return _Sourced(bound=given, origin=origin, datum=datum)
    if high != grade.max_cutting_speed:
        return _Sourced(bound=high)
    return _borrowed(high, given, at)


def _chuck_speed(at: CuttingConditions) -> float | None:
    """Speed above which a chuck holds too little to be used, rev/s; None for other holding."""
    if not isinstance(at.holding, Chuck):
        return None
    speed = usable_speed(at.holding)
    return None if speed == inf else speed


def cutting_speed_window(at: CuttingConditions) -> tuple[float | None, float | None]:
    """Recommended cutting speeds of the grade, or else of the material, mm/s."""
    grade = at.grade
    if grade is None:
        return None, None
    window = find_window(at.material, grade.tool_kind, at.cutting_material)
    low, high = grade.min_cutting_speed, grade.max_cutting_speed
    if grade.borrowed:
        # What the material's own file says goes before what another group says.
        if window is None or window.max_cutting_speed is None:
            return None, high
        return window.min_cutting_speed, window.max_cutting_speed
    if window is not None:
        low = low if low is not None else window.min_cutting_speed
        high = high if high is not None else window.max_cutting_speed
    return low, high


def _chip_ratio(cut: Cut) -> float:
    """Mean chip thickness over feed per tooth."""
    if cut.kind is CutKind.MILLING and cut.engagement is not None:
        return cut.mean_chip_ratio
    return 1.0


WRITTEN = 1e-6
"""Relative excess that is attributed to the rounding of numbers in a file."""


def held_speed(cut: Cut, at: CuttingConditions) -> float:
    """Spindle speed of a workingstep whose speed is not free, rev/s."""
    passed = {
        limit.sense: limit.bound / limit.load.coefficient
        for limit in sorted(_passed(cut, at), key=_greatest_speed, reverse=True)
    }
    low, high = (passed.get(sense) for sense in (BoundSide.AT_LEAST, BoundSide.AT_MOST))
    return high or low or cut.programmed.speed


def why_too_fast(cut: Cut, at: CuttingConditions) -> str:
    """Text naming the limit that the programmed speed exceeds; empty if it exceeds none."""
    speed = cut.programmed.speed
    passed = min(_passed(cut, at), key=_greatest_speed, default=None)
    return "" if passed is None else told(passed, passed.load.value(1.0, 1.0, speed), speed)


def why_no_speed(cut: Cut, at: CuttingConditions) -> str:
    """Text on a spindle that cannot turn as slowly as the tool demands; empty if it can."""
    low, high = speed_range(cut, at)
    least = at.machine.spindle.min_speed
    if least is None or not low > high * (1.0 + WRITTEN) or low > least * (1.0 + WRITTEN):
        return ""
    limits = [each for each in speed_limits(cut, at) if each.sense is BoundSide.AT_MOST]
    passed = min(limits, key=_greatest_speed)
    words = told(passed, passed.load.value(1.0, 1.0, least), least)
    return f"{words} at the least speed of the spindle, {rpm_from_rev_s(least):.4g} rpm"


def why_thread_too_fast(
    tool: Tool,
    conditions: Programmed,
    machine: Machine,
    material: WorkMaterial,
    *,
    diameter: float,
) -> str:
    """Text naming the limit that the speed of a thread exceeds; empty if it exceeds none.

    Parameters
    ----------
    tool : Tool
    conditions : Programmed
    machine : Machine
    material : WorkMaterial
    diameter : float
        Thread diameter, mm; 0: not known, so the speed is not checked.
    """
    if diameter <= 0.0:
        return ""
    spindle = conditions.spindle_speed(diameter)
    highest = machine.spindle.max_speed
    if highest is not None and spindle > highest * (1.0 + WRITTEN):
        return (
            f"spindle speed {rpm_from_rev_s(spindle):.4g} rpm exceeds "
            f"{rpm_from_rev_s(highest):.4g} rpm"
        )
    edge = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    kind = ToolKind.TAP if tool.keyword == "TAP" else ToolKind.THREADING
    at = CuttingConditions(
        machine=machine,
        material=material,
        cutting_material=edge,
        grade=grade_for(kind, edge, material),
        roughness=None,
    )
    high = cutting_speed_window(at)[1]
    velocity = pi * diameter * spindle
    if high is None or velocity <= high * (1.0 + WRITTEN):
        return ""
    return (
        f"cutting speed {m_min_from_speed(velocity):.4g} m/min exceeds "
        f"{m_min_from_speed(high):.4g} m/min"
    )


def _passed(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Speed limits that the programmed speed violates, except the tool's least speed."""
    speed = cut.programmed.speed
    for limit in speed_limits(cut, at):
        is_most = limit.sense is BoundSide.AT_MOST
        if not is_most and limit.name is LimitName.CUTTING_SPEED:
            continue
        ratio = limit.load.value(1.0, 1.0, speed) / limit.bound
        if ratio > 1.0 + WRITTEN if is_most else ratio < 1.0 - WRITTEN:
            yield limit


def _greatest_speed(limit: Limit) -> float:
    """Spindle speed at the bound of a speed limit, rev/s."""
    return limit.bound / limit.load.coefficient
