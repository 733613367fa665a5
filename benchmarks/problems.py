"""Random workingsteps with the limits and the proportions of real ones."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi
from random import Random

from optimiser.bounds.loads import DepthCurve, ForceKind
from optimiser.cuts.cut import CriticalPlace
from optimiser.solver.problem import (
    BoundSide,
    Cost,
    Limit,
    LimitName,
    Monomial,
    Problem,
    Setting,
)
from simulator.physics.engagement import unidirectional
from simulator.physics.flutes import CuttingEdges, ForceLaw


@dataclass(frozen=True, slots=True, kw_only=True)
class _Cut:
    """A tool in its cut; mm, rev/s."""

    diameter: float
    teeth: int
    chip: float
    """chip thickness by feed per tooth"""
    speed: float
    m_c: float
    per_removal: float
    """W·s by mm of feed and of depth"""
    ploughing: float
    """the same at no feed"""

    def load(self, speed_exponent: float, factor: float = 1.0) -> Monomial:
        """Of force, torque or power."""
        return Monomial(
            coefficient=self.per_removal * factor,
            offset=self.ploughing * factor,
            feed_exponent=1.0 - self.m_c,
            depth_exponent=1.0,
            speed_exponent=speed_exponent,
        )


def random_problem(
    random: Random, *, free_speed: bool = False, edge: bool = False, helix: bool = False
) -> Problem:
    """One milling workingstep drawn at random; most are feasible.

    Parameters
    ----------
    random : Random
        Seeded by the caller.
    free_speed : bool
        Whether the spindle speed may be chosen, over two stretches of the power curve.
    edge : bool
        Whether the force has an edge term (linear-edge model) instead of Kienzle's exponent.
    helix : bool
        Whether the tool bends and may break by forces along its helix, curves of the depth.
    """
    cut = _random_cut(random, edge=edge)
    power = random.uniform(300.0, 15000.0)
    total = random.uniform(1.0, 40.0)
    limits = _random_limits(random, cut)
    base_speed = cut.speed * random.uniform(0.7, 1.4)
    torque, constant = _spindle(cut, power, base_speed)
    passes = random.randint(1, 6)
    problem = Problem(
        limits=limits,
        cost=Cost(
            length=random.uniform(50.0, 3000.0),
            teeth=cut.teeth,
            motor_power=cut.load(1.0, 1.0 / 0.85),
            link_time=random.choice((0.0, random.uniform(0.2, 4.0))),
            standby_power=random.uniform(200.0, 2000.0),
            standby_power_per_speed=random.uniform(0.0, 5.0),
        ),
        total_depth=total,
        passes=(1, 60),
        speeds=(0.5 * base_speed, base_speed, 1.6 * base_speed) if free_speed else (cut.speed,),
        programmed=Setting(
            feed=0.004 * cut.diameter, depth=total / passes, passes=passes, speed=cut.speed
        ),
        stretches=((torque,), (constant,)) if free_speed else ((constant,),),
    )
    if not helix:
        return problem
    return replace(problem, limits=(*limits, *_bending(random, cut)))


def _random_cut(random: Random, *, edge: bool) -> _Cut:
    diameter = random.choice((6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 32.0, 50.0))
    teeth = random.randint(2, 6)
    width = diameter * random.uniform(0.05, 1.0)
    m_c = 0.0 if edge else random.uniform(0.0, 0.35)
    k_c11 = random.uniform(600.0, 3500.0)
    speed = random.uniform(1000.0, 6000.0) / (pi * diameter)
    chip = 2.0 * width / diameter / 2.0
    per_removal = k_c11 * chip ** (-m_c) * width * teeth / 1000.0
    return _Cut(
        diameter=diameter,
        teeth=teeth,
        chip=chip,
        speed=speed,
        m_c=m_c,
        per_removal=per_removal,
        ploughing=random.uniform(0.005, 0.03) * per_removal if edge else 0.0,
    )


def _random_limits(random: Random, cut: _Cut) -> tuple[Limit, ...]:
    """All but those of the spindle."""
    diameter = cut.diameter
    return (
        Limit(
            name=LimitName.CUTTING_FORCE,
            load=cut.load(0.0, 1000.0 / (pi * diameter)),
            bound=random.uniform(100.0, 3000.0),
            unit="N",
        ),
        Limit(
            name=LimitName.FEED_PER_TOOTH,
            load=Monomial(coefficient=1.0, feed_exponent=1.0),
            bound=diameter * random.uniform(0.004, 0.02),
            unit="mm",
        ),
        Limit(
            name=LimitName.CHIP_THICKNESS,
            load=Monomial(coefficient=cut.chip, feed_exponent=1.0),
            bound=random.uniform(0.0005, 0.004),
            unit="mm",
            sense=BoundSide.AT_LEAST,
        ),
        Limit(
            name=LimitName.ROUGHNESS,
            load=Monomial(
                coefficient=1.0 / (31.2 * random.uniform(0.2, 1.2)),
                offset=random.choice((0.0, 0.0003)),
                feed_exponent=2.0,
            ),
            bound=random.uniform(0.0008, 0.0063),
            unit="µm",
            scale=1000.0,
        ),
        Limit(
            name=LimitName.FEED_MECHANISM,
            load=Monomial(coefficient=cut.teeth, feed_exponent=1.0, speed_exponent=1.0),
            bound=random.uniform(20.0, 300.0),
            unit="mm/min",
            scale=60.0,
        ),
        Limit(
            name=LimitName.AXIAL_DEPTH,
            load=Monomial(coefficient=1.0, depth_exponent=1.0),
            bound=random.uniform(0.3, 1.5) * diameter,
            unit="mm",
        ),
    )


def _bending(random: Random, cut: _Cut) -> Iterator[Limit]:
    """Deflection at the wall and strength of a shank of carbide, 0.8 D thick and 3 D long."""
    edges = CuttingEdges(
        teeth=cut.teeth,
        diameter=cut.diameter,
        helix_angle=random.uniform(0.2, 0.9),
        corner_radius=random.choice((0.0, 0.0, 0.1, 0.5)) * cut.diameter,
    )
    arc = unidirectional(cut.chip * cut.diameter, cut.diameter)
    place = CriticalPlace(engagement=arc, depth_share=random.choice((1.0, 1.2)))
    law = ForceLaw(exponent=1.0 - cut.m_c)
    k_c11 = random.uniform(600.0, 3500.0)
    core = 0.8 * cut.diameter
    deflection = 576.0 * cut.diameter**3 / (pi * 600_000.0 * core**4)
    stress = 96.0 * cut.diameter / (pi * core**3)
    for name, force, by_force, bound, unit in (
        (LimitName.TOOL_DEFLECTION, ForceKind.AT_WALL, deflection, 0.02, "mm"),
        (LimitName.SHANK_STRENGTH, ForceKind.ACROSS, stress, 300.0, "N/mm²"),
    ):
        yield Limit(
            name=name,
            load=Monomial(
                coefficient=k_c11 * by_force,
                feed_exponent=law.exponent,
                curve=DepthCurve(edges=edges, place=place, law=law, force=force),
            ),
            bound=random.uniform(0.3, 3.0) * bound,
            unit=unit,
        )


def _spindle(cut: _Cut, power: float, base_speed: float) -> tuple[Limit, Limit]:
    """Constant torque below the base speed, constant power above it."""
    constant_torque = Limit(
        name=LimitName.MOTOR_POWER,
        load=cut.load(1.0),
        bound=power / base_speed,
        bound_speed_exponent=1.0,
        unit="kW",
        scale=1e-3,
    )
    constant_power = Limit(
        name=LimitName.MOTOR_POWER, load=cut.load(1.0), bound=power, unit="kW", scale=1e-3
    )
    return constant_torque, constant_power
