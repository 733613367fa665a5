"""Limits of the work-holding, and the loads that a cut puts on it.

A chuck must not slip, nor let a bar tilt; a bar must not bend too far; a vice or clamps hold by
friction. Only values given by the user limit a cut (:class:`simulator.spec.Chuck`); otherwise
one note per setup states the loads to hold. Units: mm, N, N·mm, rev/s.

Forces along and across the feed have different exponents, so their resultant is not a power of
the feed. It is convex in logarithms: a power law through two feeds never lies below it between
them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import hypot, log, sin, tan

from optimiser.bounds import loads
from optimiser.bounds.limits import drill_point, force_factor, force_load
from optimiser.bounds.speed_stretch import powers_of_speed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.solver.problem import Limit, LimitName, Monomial, Setting
from simulator.physics.holding import (
    LEAST_LEFT,
    greatest_moment,
    greatest_torque,
    holding_force,
    slipping_torque,
    usable_speed,
)
from simulator.physics.slender_bar import compliance
from simulator.physics.turning import TurningForces, turning_forces
from simulator.work_holding import (
    Chuck,
    Clamp,
)
from stepnc_model.units import UM_PER_MM, nm_from_nmm, rpm_from_rev_s

FEEDS = (0.05, 1.0)
"""Range of turning feeds in which forces are fitted as powers of the feed, mm/rev."""

PLACES = 24
"""Number of places along a bar with a tailstock at which its bending is evaluated."""

NM, UM = nm_from_nmm(1.0), UM_PER_MM
"""Factors from canonical units to user units: N·mm to N·m, mm to µm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HoldingLoad:
    """Loads of a cut on the work-holding."""

    torque: float = 0.0
    """Torque of a bar about the spindle axis, N·mm, with the effect of the axial force."""
    moment: float = 0.0
    """Tilting moment about the jaws, across the axis, N·mm; 0 where the jaws are unknown."""
    force: float = 0.0
    """Greatest force across the axis of a mill, N."""
    lift: float = 0.0
    """Axial force that pulls the workpiece towards the spindle, N."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Forces:
    """Force of a turning or drilling tool on the bar, N, at one feed and 1 mm of depth."""

    cutting: float
    axial: float
    radial: float


def holding_limits(cut: Cut, at: CuttingConditions) -> tuple[Limit, ...]:
    """Limits of a vice, clamps or slender bar, none of which depend on the spindle speed."""
    if isinstance(at.holding, Clamp):
        return tuple(_clamp_limits(cut, at, at.holding))
    bending = _bar_compliance(cut, at)
    if not bending or at.bar_deflection is None:
        return ()
    return (
        Limit(
            name=LimitName.BAR_DEFLECTION,
            load=_load(cut, at, lambda forces: bending * forces.radial),
            bound=at.bar_deflection.value,
            origin=at.bar_deflection.origin,
            unit="µm",
            scale=UM,
            step=1.0,
        ),
    )


def chuck_limits(
    cut: Cut, at: CuttingConditions, slow: float, fast: float
) -> tuple[Limit, ...]:
    """Torque and tilting moment that a chuck holds between two spindle speeds.

    The greatest speed on the path decides.
    """
    chuck, grip = at.holding, at.grip
    if not isinstance(chuck, Chuck) or grip is None or cut.kind is CutKind.MILLING:
        return ()

    def at_speed(speed: float) -> float:
        return min(_fastest(cut, speed), usable_speed(chuck))

    size = grip.size
    origin = f"{size.length:.4g} mm of grip on Ø{size.diameter:.4g} mm"
    if slow == fast:
        origin += f" at {rpm_from_rev_s(_fastest(cut, slow)):.0f} rpm"
    if _fastest(cut, fast) > usable_speed(chuck):
        usable = rpm_from_rev_s(usable_speed(chuck))
        origin += f"; the chuck holds less than {LEAST_LEFT:.0%} above {usable:.0f} rpm"

    def limit(name: LimitName, load: Monomial, holds: Callable[[float], float]) -> Limit:
        bound, exponent = powers_of_speed(lambda speed: holds(at_speed(speed)), slow, fast)
        return Limit(
            name=name,
            load=load,
            bound=bound,
            bound_speed_exponent=exponent,
            unit="N·m",
            scale=NM,
            origin=origin,
        )

    found = [
        limit(
            LimitName.CHUCK_TORQUE,
            _torque(cut, at),
            lambda speed: greatest_torque(chuck, size, speed),
        )
    ]
    moment = _moment(cut, at)
    if moment is not None and not grip.has_tailstock:
        found.append(
            limit(
                LimitName.TILTING_MOMENT,
                moment,
                lambda speed: greatest_moment(chuck, size, speed),
            )
        )
    return tuple(found)


def holding_load(cut: Cut, at: CuttingConditions, setting: Setting) -> HoldingLoad | None:
    """Loads of a cut on the work-holding at one setting; None for a cut in air."""
    if cut.is_air or at.machine.only_stated_limits:
        return None
    point = (setting.feed, setting.depth, setting.speed)
    if cut.kind.is_turned or at.grip is not None:
        moment = _moment(cut, at)
        return HoldingLoad(
            torque=_torque(cut, at).value(*point),
            moment=0.0 if moment is None else moment.value(*point),
        )
    if cut.kind is not CutKind.MILLING or cut.engagement is None:
        return None
    across, lift = _across(cut, at), _lift(cut, at)
    return HoldingLoad(
        force=across.value(*point), lift=0.0 if lift is None else lift.value(*point)
    )


def _clamp_limits(cut: Cut, at: CuttingConditions, clamp: Clamp) -> Iterator[Limit]:
    """Limits of a vice or clamps on the cross force of a mill and on its lifting force."""
    if cut.kind is not CutKind.MILLING:
        return
    limit = Limit(
        name=LimitName.HOLDING_FORCE,
        load=_across(cut, at),
        bound=holding_force(clamp),
        unit="N",
        step=100.0,
    )
    yield limit
    lift = _lift(cut, at)
    if lift is not None:
        yield replace(limit, label="lifting force", load=lift)
    if cut.floor is not None:
        for swept in _clamp_limits(cut.floor, at, clamp):
            yield swept.at_depth(cut.floor.total_depth)


def _across(cut: Cut, at: CuttingConditions) -> Monomial:
    """Greatest force of a mill across its axis within a revolution, N."""
    return loads.shank_force(cut, at.material.kienzle, force_factor(at))


def _lift(cut: Cut, at: CuttingConditions) -> Monomial | None:
    """Force with which helical edges lift the workpiece, N; None for straight edges."""
    if cut.helix_angle <= 0.0:
        return None
    return loads.scaled(force_load(cut, at), tan(cut.helix_angle))


def _torque(cut: Cut, at: CuttingConditions) -> Monomial:
    """Torque of a cut on the bar, N·mm, with the axial force where the grip is known."""
    arm = 0.5 * cut.force_diameter
    grip = at.grip
    if grip is None:
        return _load(cut, at, lambda forces: arm * forces.cutting)
    return _load(
        cut, at, lambda forces: slipping_torque(arm * forces.cutting, forces.axial, grip.size)
    )


def _moment(cut: Cut, at: CuttingConditions) -> Monomial | None:
    """Moment of a cut about the jaws; None if the jaws are unknown or the tool is on the axis.

    In the plane of the tool the feed and back forces turn against each other: the greater
    counts.
    """
    if at.grip is None or not cut.kind.is_turned:
        return None
    front = at.grip.front if cut.turned is None else cut.turned.high
    out, arm = max(0.0, front - at.grip.face), 0.5 * cut.diameter
    return _load(
        cut,
        at,
        lambda forces: hypot(
            out * forces.cutting, max(out * forces.radial, arm * forces.axial)
        ),
    )


def _bar_compliance(cut: Cut, at: CuttingConditions) -> float:
    """Greatest deflection of a bar under 1 N at the tool, mm/N; 0 where it is not judged."""
    grip, turned, modulus = at.grip, cut.turned, at.material.youngs_modulus
    if grip is None or turned is None or modulus is None or grip.has_rest:
        return 0.0
    shift = turned.back - grip.face
    sections = [
        replace(part, start=part.start + shift, end=part.end + shift)
        for part in turned.sections
    ]
    low, high = max(0.0, turned.low - grip.face), turned.high - grip.face
    free = sections[-1].end
    places = [high]
    if grip.has_tailstock:
        places = [low + (high - low) * row / PLACES for row in range(PLACES + 1)]
    return max(
        compliance(
            sections,
            min(place, free),
            youngs_modulus=modulus,
            centre=free if grip.has_tailstock else None,
        )
        for place in places
    )


def _load(cut: Cut, at: CuttingConditions, of: Callable[[_Forces], float]) -> Monomial:
    """Load of the forces on a bar, fitted as a power of the feed through two feeds."""
    depth = 0.0 if cut.kind is not CutKind.TURNING else 1.0
    low, high = (of(_forces(cut, at, feed / cut.tool.teeth)) for feed in FEEDS)
    if low <= 0.0:
        return Monomial(coefficient=loads.LEAST, depth_exponent=depth)
    exponent = log(high / low) / log(FEEDS[1] / FEEDS[0])
    return Monomial(
        coefficient=low / (FEEDS[0] / cut.tool.teeth) ** exponent,
        feed_exponent=exponent,
        depth_exponent=depth,
    )


def _forces(cut: Cut, at: CuttingConditions, feed: float) -> _Forces:
    """Forces on a bar at a feed per edge and at 1 mm depth of cut."""
    cutting = force_load(cut, at).value(feed, 1.0, 1.0)
    if cut.kind is CutKind.DRILLING:
        thrust = loads.thrust(cut, at.material.kienzle, force_factor(at), drill_point(at))
        return _Forces(cutting=cutting, axial=thrust.value(feed, 1.0, 1.0), radial=0.0)
    sine = 1.0 if cut.kind is CutKind.GROOVING else sin(cut.tool.cutting_edge_angle)
    material = at.material
    found: TurningForces[float] = turning_forces(
        cutting,
        feed * sine,
        cutting=material.kienzle,
        feed=material.feed_force,
        back=material.back_force,
    )
    if cut.is_fed_inwards:
        return _Forces(cutting=cutting, axial=found.back, radial=found.feed)
    return _Forces(cutting=cutting, axial=found.feed, radial=found.back)


def _fastest(cut: Cut, speed: float) -> float:
    return speed if cut.turned is None else cut.turned.fastest(speed)
