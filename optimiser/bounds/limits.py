"""Limits that machine, material and tool grade put on a cut.

A value that a source does not give sets no limit. All loads come from
:mod:`optimiser.bounds.loads`; this module does not depend on how a problem is solved.

Limits on the depth of one pass, from machine, tool and the windows of its grade.
"""

from collections.abc import Iterator
from dataclasses import replace

from optimiser.bounds import loads
from optimiser.bounds.chip_load import (
    borrowed_datum,
    catalogue_feed,
    feed_origin,
    greatest_feed,
    is_borrowed_feed,
    least_chip,
    least_feed,
)
from optimiser.bounds.roughness import surface_limits
from optimiser.bounds.speed_limits import WRITTEN, SourcedBound, borrowed_bound, speed_limits
from optimiser.cuts.conditions import CuttingConditions, PermittedDeflection
from optimiser.cuts.cut import Cut, CutKind
from optimiser.solver.problem import BoundSide, Limit, LimitName, Monomial
from simulator.library import reaming_allowances
from simulator.physics.drilling import LIPS_ONLY
from simulator.physics.spindle import CurveSegment, curve_segments
from simulator.physics.strength import end_mill
from simulator.spec import ToolGrade, ToolKind
from simulator.tool_kind import correction_of
from simulator.tool_windows import DrillPoint
from stepnc_model.units import kw_from_watts, mm_min_from_speed, nm_from_nmm

DEEPER = 1.01
"""Depth of the deepest place over that of a pass above which it is named."""


def depth_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limit on the depth of one pass from machine, tool and grade."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING}:
        return
    of_tool = _grade_depth(cut, at)
    greatest = _least_known(cut, at, of_tool)
    if greatest is not None:
        is_of_tool = greatest == of_tool.bound
        deepest = cut.deepest_share if cut.is_depth_free else 1.0
        yield Limit(
            name=LimitName.AXIAL_DEPTH,
            label="depth at the deepest place" if deepest > DEEPER else "",
            load=Monomial(coefficient=deepest, depth_exponent=1.0),
            bound=greatest,
            unit="mm",
            origin=of_tool.origin if is_of_tool else "",
            datum=of_tool.datum if is_of_tool else "",
        )
        yield from _shoulder_limits(cut, greatest)


def depth_at_shoulder(cut: Cut, at: CuttingConditions) -> float | None:
    """Depth of a turning tool beyond which a place keeps its programmed feed, mm; None: any."""
    if cut.kind is not CutKind.TURNING or cut.is_depth_free or at.grade is None:
        return None
    return _least_known(cut, at, _grade_depth(cut, at))


def _least_known(cut: Cut, at: CuttingConditions, of_tool: SourcedBound) -> float | None:
    """Least of the greatest depths that anything permits, mm; None: any."""
    bounds = [at.machine.max_axial_depth, cut.depth_bound, at.bounds.axial_depth]
    known = [bound for bound in (*bounds, of_tool.bound) if bound is not None]
    return min(known, default=None)


def _shoulder_limits(cut: Cut, bound: float) -> Iterator[Limit]:
    """Keep the programmed feed where a finishing cut meets more than its insert may cut.

    An insert that turns along the axis up to a shoulder meets the allowance of its face with
    the whole edge, as high as the shoulder is: an edge at 93° stands 3° off the face, so that
    an allowance of 0.5 mm is met on 9.5 mm of it at once. What is left along the face's normal
    would count only for a move along the face. No feed makes a shoulder less deep: the program
    itself must change. One feed holds for a workingstep; along the path only the place itself
    keeps it (:mod:`optimiser.along_path.caps`).
    """
    depth = cut.programmed.depth
    deepest = cut.deepest_share * depth
    if cut.is_depth_free or deepest <= DEEPER * bound or depth > bound:
        return
    yield Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=cut.programmed.feed,
        unit="mm",
        step=0.01,
        origin=f"{deepest:.3g} mm deep at a shoulder, where the tool may cut {bound:.3g} mm",
        datum="a tool for that depth, roughing nearer to the shoulder, or facing it inwards",
        stands_for=LimitName.AXIAL_DEPTH,
    )


def _grade_depth(cut: Cut, at: CuttingConditions) -> SourcedBound:
    """Greatest depth of a pass by the windows of the tool, mm."""
    grade, given = at.grade, cut.programmed.depth
    if grade is None:
        return SourcedBound()
    bounds = [grade.max_depth, depth_by_diameter(cut, at, grade)]
    known = [bound for bound in bounds if bound is not None]
    if not known:
        if grade.has_feeds or at.machine.only_stated_limits:
            return SourcedBound()
        origin = f"no source for more with {grade.name}"
        return SourcedBound(bound=given, origin=origin, datum="a catalogue of the tool")
    found = borrowed_bound(min(known), given, at)
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
    """True if a milling cut is wider than the depths of the tool are meant for."""
    window = grade.depth_window
    if window is None or cut.kind is not CutKind.MILLING or at.machine.only_stated_limits:
        return False
    return _width_ratio(cut) > window.width_ratio + WRITTEN


def _width_ratio(cut: Cut) -> float:
    """Radial width over diameter where the force is greatest."""
    return min(cut.radial_width / cut.diameter, 1.0) if cut.diameter > 0.0 else 0.0


PLUNGE_FEED_RATIO = 0.5
"""Greatest feed per tooth in a straight plunge over the feed along the pass (customary).

Near the axis the edges hardly move; Fanar, general catalogue 2021, p. 329, uses 25 to 50 % of
the table feed on the way into the material.
"""


LEAST_ALLOWANCE = 1e-6
"""Least allowance of a reamer that is distinguished from none, mm."""

VENDOR_FEED = "max_feed_mm of the tool in a tool table"
"""Datum that brings a greatest feed where no source gives one."""

STRAIGHT_DOWN = "straight down"
"""Words added to the limits of a plunge to distinguish them from those along the pass."""

KW, NM, MM_MIN = kw_from_watts(1.0), nm_from_nmm(1.0), mm_min_from_speed(1.0)
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
        *depth_limits(cut, at),
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
        overhang=cut.tool.overhang,
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
    """True if the tool bends under load: end mills do, face mills do not."""
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


def _chip_ratio(cut: Cut) -> float:
    """Mean chip thickness over feed per tooth."""
    if cut.kind is CutKind.MILLING and cut.engagement is not None:
        return cut.mean_chip_ratio
    return 1.0
