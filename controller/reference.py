"""Force bound and override band of a workingstep, derived from the plan.

Every limit that rises with the force is converted to the cutting force at which it is reached;
every limit on the feed to the override at which it is reached. Units: N, mm, rad.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from optimiser.advice import Advice, EvaluatedSetting, LimitLoad
from optimiser.bounds import loads
from optimiser.bounds.limits import STRAIGHT_DOWN
from optimiser.cuts.cut import Cut
from optimiser.solver.problem import BoundSide, LimitName
from simulator.reading import Floats
from simulator.spec import Kienzle

FORCE_LIMITS = frozenset({
    LimitName.MOTOR_POWER,
    LimitName.SPINDLE_TORQUE,
    LimitName.CUTTING_FORCE,
    LimitName.TOOL_DEFLECTION,
    LimitName.SHANK_STRENGTH,
})
FEED_LIMITS = frozenset({
    LimitName.FEED_PER_TOOTH,
    LimitName.FEED_MECHANISM,
    LimitName.ROUGHNESS,
})

RUPTURE_RATIO = 2.0
"""Breaking stress of a shank over its permitted bending stress.

Transverse rupture strengths of cemented carbides begin at about 2000 N/mm² (tests after ISO
3327).
"""

BREAKAGE_RATIO = 3.0
"""Breakage force over the set point where the strength of the tool is unknown (customary)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceBound:
    """Limit expressed as the cutting force that reaches it."""

    name: LimitName
    words: str
    force: float
    """Revolution mean force at the plan's hardest place, N."""
    peak: float = 0.0
    """Greatest force across the axis, for tool breakage, N; 0: mean or wall force counts."""
    wall: float = 0.0
    """Force normal to the wall, for tool deflection, N; 0: mean or peak force counts."""

    @property
    def is_mean(self) -> bool:
        """True if the bound is on the mean force."""
        return self.peak == 0.0 and self.wall == 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Force bounds and override band of one workingstep for the loop.

    Raises
    ------
    ValueError
        When the ceiling or the breakage force is not positive, or the floor is negative.
    """

    workingstep: str
    bounds: tuple[ForceBound, ...] = ()
    """Force bounds, the least first; empty if nothing limits the force."""
    floor: float = 0.0
    """Override of the least feed per tooth: that of the catalogue, or of the least chip."""
    least: float = 0.0
    """Override of the least chip, below which the edge rubs."""
    ceiling: float = inf
    """Override that chip load, feed mechanism and roughness allow."""
    breakage: float = inf
    """Force that the tool withstands, N."""
    inhibition: str = ""
    """Reason why the feed is locked; empty if the loop may change it."""

    def __post_init__(self) -> None:
        floors = min(self.floor, self.least)
        if not (self.ceiling > 0.0 and self.breakage > 0.0 and floors >= 0.0):
            raise ValueError(
                f"workingstep '{self.workingstep}': ceiling {self.ceiling:g} and breakage "
                f"force {self.breakage:g} N must be positive, floor {floors:g} not negative"
            )

    def bound(self, *, power_factor: float = 1.0) -> ForceBound | None:
        """Least force bound when the motor may use a share of its power."""
        return min(self._scaled(power_factor), key=lambda each: each.force, default=None)

    def weights(
        self, peak: Floats, *, wall: Floats | None = None, power_factor: float = 1.0
    ) -> Floats:
        """Factors that convert mean forces at other places to the plan's hardest place.

        ``w = F_bound · max(1/F_mean, ρ/F_peak, σ/F_wall)``, the F the least bounds on the mean,
        the greatest force and the wall force, ρ and σ the latter two over the mean at that
        place: forces that use the same share of their bounds count alike.

        Parameters
        ----------
        peak : (N,) array
            ρ, greatest force across the axis over the mean force.
        wall : (N,) array, optional
            σ, wall force over the mean force; omitted: no wall is cut.
        power_factor : float
        """
        least = self.bound(power_factor=power_factor)
        if least is None:
            return np.ones(len(peak))
        bounds = list(self._scaled(power_factor))
        mean = min((each.force for each in bounds if each.is_mean), default=inf)
        greatest = min((each.peak for each in bounds if each.peak > 0.0), default=inf)
        share = np.maximum(1.0 / mean, peak / greatest)
        if wall is not None:
            normal = min((each.wall for each in bounds if each.wall > 0.0), default=inf)
            share = np.maximum(share, wall / normal)
        weights: Floats = least.force * share
        return weights

    def scaled(self, factor: float) -> "Reference":
        """Copy with all forces multiplied by a factor."""
        bounds = tuple(
            replace(
                each,
                force=factor * each.force,
                peak=factor * each.peak,
                wall=factor * each.wall,
            )
            for each in self.bounds
        )
        return replace(self, bounds=bounds, breakage=factor * self.breakage)

    def _scaled(self, power_factor: float) -> Iterable[ForceBound]:
        # Asked in each revolution, mostly with the whole power.
        return self.bounds if power_factor == 1.0 else self._reduced(power_factor)

    def _reduced(self, power_factor: float) -> Iterator[ForceBound]:
        for each in self.bounds:
            is_power = each.name is LimitName.MOTOR_POWER
            yield replace(each, force=each.force * power_factor) if is_power else each


def reference_of(advice: Advice) -> Reference:
    """Derive the reference of a workingstep around its programmed feed.

    Parameters
    ----------
    advice : Advice
        From any plan of the program; its state as programmed is used.
    """
    name, state = advice.workingstep.id, advice.before
    inhibition = advice.programmed.inhibition
    if advice.programmed.is_synchronised:
        inhibition = inhibition or "the feed is bound to the pitch of the thread"
    if state is None or advice.cut is None:
        return Reference(workingstep=name, inhibition=inhibition)
    bounds = sorted(_force_bounds(advice.cut, state), key=lambda bound: bound.force)
    rubbing = max(_overrides(state, BoundSide.AT_LEAST), default=0.0)
    ceiling = _ceiling(state, rubbing)
    least = min(rubbing, ceiling, 1.0)
    strengths = [
        RUPTURE_RATIO * each.force for each in bounds if each.name is LimitName.SHANK_STRENGTH
    ]
    breakage = BREAKAGE_RATIO * bounds[0].force if bounds else inf
    return Reference(
        workingstep=name,
        bounds=tuple(bounds),
        floor=min(max(least, _catalogue_floor(state)), ceiling),
        least=least,
        ceiling=ceiling,
        breakage=min(strengths, default=breakage),
        inhibition=inhibition,
    )


def _ceiling(state: EvaluatedSetting, rubbing: float) -> float:
    """Override that all limits on the feed allow.

    A roughness that no feed attains, or none at which the edge still cuts, is ignored: the plan
    reports it, and feeds that only rub make it worse.
    """
    ceiling = min(_overrides(state, BoundSide.AT_MOST), default=inf)
    ceiling = ceiling if ceiling > rubbing else max(rubbing, 1.0)
    return min(ceiling, max(1.0, min(_plunge_overrides(state), default=inf)))


def _catalogue_floor(state: EvaluatedSetting) -> float:
    """Override of the catalogue's least feed; 0 without one, or if the program is below it.

    A program that feeds less than the catalogue has decided against it: what counts then is
    the least chip.
    """
    floors = [
        _override(load, state)
        for load in state.loads
        if load.limit.name is LimitName.FEED_PER_TOOTH
        and load.limit.sense is BoundSide.AT_LEAST
    ]
    return max((each for each in floors if each <= 1.0), default=0.0)


def _plunge_overrides(state: EvaluatedSetting) -> Iterator[float]:
    """Overrides that the ways down allow; one override applies to them and to the passes.

    Forces on a ramp are limited like those of a pass, so that the loop controls them; the
    thrust of a straight plunge is not.
    """
    at = state.setting
    for load in state.plunge_loads:
        is_drilled = load.limit.words.endswith(STRAIGHT_DOWN)
        if at.plunge_feed is not None and (is_drilled or load.limit.name in FEED_LIMITS):
            yield load.limit.feed_at_bound(at.depth, at.speed) / at.plunge_feed


def _force_bounds(cut: Cut, state: EvaluatedSetting) -> Iterator[ForceBound]:
    """Force bounds of the loads that rise with the cutting force."""
    shares = _shares(cut, state)
    for load in state.loads:
        rises = load.value - _constant(load, state)
        if load.limit.name in FORCE_LIMITS and rises > 0.0:
            own = state.cutting_force * shares.get(_part(load), 1.0)
            force = own * (load.bound - _constant(load, state)) / rises
            if force <= 0.0:  # The chisel edge alone exceeds the bound: no force keeps it.
                continue
            ratio = _over_mean(cut, load, state.setting.depth)
            is_wall = load.limit.name is LimitName.TOOL_DEFLECTION
            yield ForceBound(
                name=load.limit.name,
                words=load.limit.words,
                force=force,
                peak=0.0 if is_wall else force * ratio,
                wall=force * ratio if is_wall else 0.0,
            )


def _over_mean(cut: Cut, load: LimitLoad, depth: float) -> float:
    """Ratio of a tool load to the mean force, in the loaded part of the cut.

    0 for loads that depend on the mean force.
    """
    name, floor = load.limit.name, cut.floor
    is_floor = floor is not None and not load.limit.load.knows_depth
    part = floor if is_floor and floor is not None else cut
    if is_floor and floor is not None:
        depth = floor.total_depth
    law = Kienzle(k_c11=1.0, m_c=1.0 - load.limit.load.feed_exponent)
    force = None
    if name is LimitName.TOOL_DEFLECTION:
        force = loads.wall_force(part, law, 1.0)
    elif name is LimitName.SHANK_STRENGTH:
        force = loads.shank_force(part, law, 1.0)
    if force is None or not isinstance(force.curve, loads.DepthCurve):
        return 0.0
    return loads.over_mean(force.curve, depth)


def _constant(load: LimitLoad, state: EvaluatedSetting) -> float:
    """Part of a load that does not depend on the feed, such as the chisel-edge thrust."""
    by, at = load.limit.load, state.setting
    return float(by.offset * by.depth_factor(at.depth) * at.speed**by.speed_exponent)


def _shares(cut: Cut, state: EvaluatedSetting) -> dict[tuple[str, float], float]:
    """Force of each part of the cut over that of the hardest part, from their torques.

    Walls, the floor that is swept with them and a plunge take different forces with the same
    cutter; the state gives the greatest of them. The force of a plunge acts at the middle of
    its lips.
    """
    forces: dict[tuple[str, float], float] = {}
    for load in state.loads:
        if load.limit.name is LimitName.SPINDLE_TORQUE:
            part = _part(load)
            is_plunge = cut.plunge is not None and part[0].endswith(STRAIGHT_DOWN)
            acting = cut.plunge if is_plunge and cut.plunge is not None else cut
            forces[part] = max(load.value / acting.force_diameter, forces.get(part, 0.0))
    greatest = max(forces.values(), default=0.0)
    return {part: force / greatest for part, force in forces.items() if force > 0.0}


def _part(load: LimitLoad) -> tuple[str, float]:
    """Key of a part of a cut: its label, and whether its load depends on the depth."""
    label = load.limit.label.removeprefix(load.limit.name.words)
    return label, float(load.limit.load.knows_depth)


def _overrides(state: EvaluatedSetting, sense: BoundSide) -> Iterator[float]:
    """Overrides at which limits on the feed are reached."""
    names = FEED_LIMITS if sense is BoundSide.AT_MOST else {LimitName.CHIP_THICKNESS}
    for load in state.loads:
        if load.limit.name in names and load.limit.sense is sense:
            yield _override(load, state)


def _override(load: LimitLoad, state: EvaluatedSetting) -> float:
    at = state.setting
    return load.limit.feed_at_bound(at.depth, at.speed) / at.feed
