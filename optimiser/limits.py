"""From a cut, a machine, a material and a tool grade to the limits that hold.

A value that a source does not give does not limit. All loads come from
:mod:`optimiser.loads`; nothing here knows how a problem is solved.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, pi, sqrt

from optimiser import loads
from optimiser.cut import Cut, CutKind, Texture
from optimiser.limit import Limit, LimitName, Monomial, Sense
from simulator.edge_material import correction_of
from simulator.library import find_window
from simulator.physics.drilling import LIPS_ONLY
from simulator.physics.spindle import CurveSegment, curve_segments
from simulator.physics.strength import end_mill
from simulator.physics.surface import RA_FLOOR, RZ_PER_RA
from simulator.spec import CuttingMaterial, DrillPoint, Grade, Machine, Material, ToolKind

GREATEST_DEFLECTION = 0.1
"""mm at the tip of an end mill, whatever it leaves: beyond it teeth share the work unevenly;
customary"""

NOSE_FEED_RATIO = 0.8
"""greatest feed per revolution over the nose radius of an insert, customary"""

PLUNGE_FEED_RATIO = 0.5
"""greatest feed per tooth straight down over that along the pass, customary: near the axis the
edges hardly move; Fanar, general catalogue 2021, p. 329, takes 25 to 50 % of the table on the
way into the material"""

STRAIGHT_DOWN = "straight down"
"""how limits of a plunge are told from those along the pass"""

KW, NM, UM, MM_MIN, M_MIN, RPM = 1e-3, 1e-3, 1e3, 60.0, 0.06, 60.0
"""user's number per canonical unit"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PermittedDeflection:
    """How far an end mill may bend."""

    value: float = GREATEST_DEFLECTION
    """mm at its tip"""
    origin: str = ""
    """where the value comes from, as a sentence goes on; empty: custom"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """Everything besides the cut that sets its limits."""

    machine: Machine
    material: Material
    cutting_material: CuttingMaterial
    grade: Grade | None
    """``None``: the material carries no tool limits"""
    roughness: float | None
    """Ra in mm that this surface must keep"""
    deflection: PermittedDeflection = PermittedDeflection()
    """what tolerance or allowance of its wall leaves to an end mill"""
    force_factor: float = 1.0
    """accepted correction of k_c from measurements"""


def force_factor(at: Conditions) -> float:
    """K = K_γ·K_v times the accepted correction; 1 for a material of constant k_s."""
    correction = correction_of(at.material, at.grade, at.cutting_material)
    return at.force_factor * correction.factor


def force_load(cut: Cut, at: Conditions) -> Monomial:
    """Tangential force of this cut, N."""
    return loads.cutting_force(cut, at.material.kienzle, force_factor(at), drill_point(at))


def drill_point(at: Conditions) -> DrillPoint:
    """Point of the tool where it cuts on its end."""
    return (at.grade.point if at.grade is not None else None) or LIPS_ONLY


def power_load(cut: Cut, at: Conditions) -> Monomial:
    """Motor power of this cut, W."""
    return loads.motor_power(cut, force_load(cut, at), at.machine.spindle.efficiency)


def limits_of(cut: Cut, at: Conditions) -> tuple[Limit, ...]:
    """All limits that hold at every spindle speed."""
    return (
        *_load_limits(cut, at),
        *_depth_limits(cut, at),
        *_surface_limits(cut, at),
        *(_surface_limits(cut.floor, at) if cut.floor is not None else ()),
        *_speed_limits(cut, at),
    )


def _load_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Limits on what cuts, of the walls and of the floor that is swept at its own depth."""
    yield from _machine_limits(cut, at)
    yield from _tool_limits(cut, at)
    if cut.floor is not None:
        floor = cut.floor
        # Its sweep stays off the walls, and a tool that bends leaves the depth alone.
        swept = replace(at, deflection=PermittedDeflection())
        for limit in (*_machine_limits(floor, swept), *_tool_limits(floor, swept)):
            yield limit.at_depth(floor.total_depth)
    if cut.plunge is not None:
        yield from map(_straight_down, _plunge_limits(cut, cut.plunge, at))


def _plunge_limits(cut: Cut, plunge: Cut, at: Conditions) -> Iterator[Limit]:
    """Feed per tooth and thrust where a mill goes straight down.

    Where nothing says what feed the mill bears along the pass, the programmed one is all that
    is known to be borne. Half of it is custom and no physics: it does not make the edges rub.
    """
    highest = _greatest_feed(cut, at)
    borne = cut.programmed.feed
    if highest is not None:
        rubbing = at.grade.min_chip_thickness / _chip_ratio(cut) if at.grade else 0.0
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


def _straight_down(limit: Limit) -> Limit:
    """A limit of a plunge, told as one."""
    return replace(limit, label=f"{limit.words} {STRAIGHT_DOWN}")


def spindle_limits(cut: Cut, at: Conditions, segment: CurveSegment) -> tuple[Limit, ...]:
    """Motor power and torque on one stretch of the spindle's curve."""
    limits = _spindle_limits(cut, at, segment)
    if cut.plunge is not None:
        limits += tuple(map(_straight_down, _spindle_limits(cut.plunge, at, segment)))
    if cut.floor is None:
        return limits
    floor = cut.floor
    swept = _spindle_limits(floor, at, segment)
    return (*limits, *(limit.at_depth(floor.total_depth) for limit in swept))


def _spindle_limits(cut: Cut, at: Conditions, segment: CurveSegment) -> tuple[Limit, ...]:
    """Motor power and torque of one cut."""
    force = force_load(cut, at)
    power = Limit(
        name=LimitName.MOTOR_POWER,
        load=power_load(cut, at),
        bound=segment.power_coefficient,
        bound_speed_exponent=segment.power_exponent,
        unit="kW",
        scale=KW,
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


def segment_at(at: Conditions, speed: float) -> CurveSegment:
    """Stretch of the spindle's curve that holds at a speed, the nearest beyond its ends."""
    segments = curve_segments(at.machine.spindle)
    return next((part for part in segments if speed <= part.max_speed), segments[-1])


def speed_range(cut: Cut, at: Conditions) -> tuple[float, float]:
    """Least and greatest spindle speed that machine and tool allow, rev/s."""
    low, high = 0.0, inf
    for limit in _speed_limits(cut, at):
        bound = limit.bound / limit.load.coefficient
        if limit.sense is Sense.AT_MOST:
            high = min(high, bound)
        else:
            low = max(low, bound)
    return low, high


def _machine_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Cutting force and feed mechanism."""
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


def _tool_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Feed per tooth, chip thickness, deflection and strength of the shank."""
    highest = _greatest_feed(cut, at)
    if highest is not None:
        yield Limit(
            name=LimitName.FEED_PER_TOOTH,
            label="feed per revolution" if cut.tool.diameter <= 0.0 else "",
            load=Monomial(coefficient=1.0, feed_exponent=1.0),
            bound=highest,
            unit="mm",
            step=0.01,
        )
    if at.grade is None:
        return
    yield Limit(
        name=LimitName.CHIP_THICKNESS,
        load=Monomial(coefficient=_chip_ratio(cut), feed_exponent=1.0),
        bound=at.grade.min_chip_thickness,
        unit="mm",
        sense=Sense.AT_LEAST,
        step=0.001,
    )
    if is_bent(cut):
        yield from _bending_limits(cut, at, at.grade)


def _bending_limits(cut: Cut, at: Conditions, grade: Grade) -> Iterator[Limit]:
    """Deflection and bending stress of an end mill clamped at one end."""
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
    """Whether the tool is slender: face mills are not."""
    return cut.kind is CutKind.MILLING and cut.tool_kind is ToolKind.ENDMILL


def _depth_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Depth of one pass that machine, tool and grade allow."""
    grade = at.grade
    bounds = [at.machine.max_axial_depth, cut.depth_bound]
    if grade is not None:
        ratio = grade.max_depth_ratio
        bounds += [grade.max_depth, ratio * cut.diameter if ratio is not None else None]
    known = [bound for bound in bounds if bound is not None]
    if known and cut.kind in {CutKind.MILLING, CutKind.TURNING}:
        yield Limit(
            name=LimitName.AXIAL_DEPTH,
            load=Monomial(coefficient=1.0, depth_exponent=1.0),
            bound=min(known),
            unit="mm",
        )


def _surface_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Roughness, where the feed describes it."""
    if at.roughness is not None and roughness_load(cut) is not None:
        yield roughness_limit(cut, at.roughness)


def roughness_limit(cut: Cut, roughness: float) -> Limit:
    """Ra in mm at most so much; ValueError when the feed does not describe the surface."""
    load = roughness_load(cut)
    if load is None:
        raise ValueError("the feed does not describe this surface")
    return Limit(name=LimitName.ROUGHNESS, load=load, bound=roughness, unit="µm", scale=UM)


def _speed_limits(cut: Cut, at: Conditions) -> Iterator[Limit]:
    """Window of the cutting speed, and what the spindle turns."""
    low, high = cutting_speed_window(at)
    spindle = at.machine.spindle
    velocity = Monomial(coefficient=pi * cut.diameter, speed_exponent=1.0)
    turning = Monomial(coefficient=1.0, speed_exponent=1.0)
    for name, load, bound, sense in (
        (LimitName.CUTTING_SPEED, velocity, high, Sense.AT_MOST),
        (LimitName.CUTTING_SPEED, velocity, low, Sense.AT_LEAST),
        (LimitName.SPINDLE_SPEED, turning, spindle.max_speed, Sense.AT_MOST),
        (LimitName.SPINDLE_SPEED, turning, spindle.min_speed, Sense.AT_LEAST),
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
        )


def cutting_speed_window(at: Conditions) -> tuple[float | None, float | None]:
    """Cutting speeds that the grade, else the material, recommends, mm/s."""
    grade = at.grade
    if grade is None:
        return None, None
    window = find_window(at.material, grade.tool_kind, at.cutting_material)
    low, high = grade.min_cutting_speed, grade.max_cutting_speed
    if window is not None:
        low = low if low is not None else window.min_cutting_speed
        high = high if high is not None else window.max_cutting_speed
    return low, high


def roughness_load(cut: Cut) -> Monomial | None:
    """Ra in mm as a function of the feed, or None where the feed does not describe it.

    ``Ra = f²/(18√3·r) + floor`` with f per revolution for one high tooth and per tooth for
    equal ones; the wall left by an end mill ``Ra = f_z²/(4·D)/4 + floor``; see
    :mod:`simulator.physics.surface`.
    """
    corner = 18.0 * sqrt(3.0) * cut.corner_radius
    factors = {
        Texture.CORNER_PER_REVOLUTION: (cut.tool.teeth**2, corner),
        Texture.CORNER_PER_TOOTH: (1.0, corner),
        Texture.WALL: (1.0, 4.0 * cut.diameter * RZ_PER_RA),
        Texture.NONE: (1.0, 0.0),
    }
    numerator, denominator = factors[cut.texture]
    if denominator <= 0.0:
        return None
    return Monomial(coefficient=numerator / denominator, offset=RA_FLOOR, feed_exponent=2.0)


def _greatest_feed(cut: Cut, at: Conditions) -> float | None:
    """Greatest feed per tooth that material and grade allow, mm."""
    bounds = [at.material.max_feed_per_tooth]
    grade = at.grade
    if grade is not None:
        if cut.kind is CutKind.TURNING and cut.corner_radius > 0.0:
            bounds.append(NOSE_FEED_RATIO * cut.corner_radius)
        teeth = 1 if cut.kind is CutKind.MILLING else cut.tool.teeth
        if grade.max_feed is not None:
            bounds.append(grade.max_feed / teeth)
        if grade.max_feed_ratio is not None and cut.tool.diameter > 0.0:
            bounds.append(grade.max_feed_ratio * cut.tool.diameter / teeth)
        ratio = at.material.max_feed_per_tooth_ratio
        is_carbide = at.cutting_material is CuttingMaterial.CARBIDE
        if ratio is not None and is_carbide and cut.tool_kind is ToolKind.ENDMILL:
            bounds.append(ratio * cut.tool.diameter)
    known = [bound for bound in bounds if bound is not None]
    return min(known) if known else None


def _chip_ratio(cut: Cut) -> float:
    """Mean chip thickness over feed per tooth."""
    if cut.kind is CutKind.MILLING and cut.engagement is not None:
        return cut.mean_chip_ratio
    return 1.0
