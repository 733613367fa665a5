"""What the plan allows in a workingstep, as the loop needs it: a force and a band of overrides.

Every limit that rises with the force is brought to the cutting force at which it is reached;
every limit on the feed to the override at which it is reached. Units N, mm, rad.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

from optimiser.advice import Advice, Load, State
from optimiser.limit import LimitName, Sense

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

BREAKAGE_RATIO = 3.0
"""of the set point, where the strength of the tool is not known; customary"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceBound:
    """A limit as the cutting force that reaches it."""

    name: LimitName
    words: str
    force: float
    """N, mean of a revolution"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """What the loop is to keep in one workingstep."""

    workingstep: str
    bounds: tuple[ForceBound, ...] = ()
    """least first; none: nothing bounds the force"""
    floor: float = 0.0
    """override below which the edge rubs"""
    ceiling: float = inf
    """override that chip load, feed mechanism and roughness allow"""
    breakage: float = inf
    """N that the tool bears"""
    inhibition: str = ""
    """why nobody may touch the feed; empty: the loop may"""

    def bound(self, *, power_factor: float = 1.0) -> ForceBound | None:
        """The least force bound while the motor gives a factor of its power."""
        scaled = (
            ForceBound(name=each.name, words=each.words, force=each.force * power_factor)
            if each.name is LimitName.MOTOR_POWER
            else each
            for each in self.bounds
        )
        return min(scaled, key=lambda each: each.force, default=None)


def reference_of(advice: Advice) -> Reference:
    """What a workingstep allows around the feed that the program gives it.

    Parameters
    ----------
    advice : Advice
        Of any plan of the program: the state as programmed counts.
    """
    name, state = advice.workingstep.id, advice.before
    inhibition = advice.programmed.inhibition
    if advice.programmed.is_synchronised:
        inhibition = inhibition or "the feed is bound to the pitch of the thread"
    if state is None:
        return Reference(workingstep=name, inhibition=inhibition)
    bounds = sorted(_force_bounds(state), key=lambda bound: bound.force)
    ceiling = min(_overrides(state, Sense.AT_MOST), default=inf)
    strengths = [each.force for each in bounds if each.name is LimitName.SHANK_STRENGTH]
    breakage = BREAKAGE_RATIO * bounds[0].force if bounds else inf
    return Reference(
        workingstep=name,
        bounds=tuple(bounds),
        floor=min(max(_overrides(state, Sense.AT_LEAST), default=0.0), ceiling, 1.0),
        ceiling=ceiling,
        breakage=min(strengths, default=breakage),
        inhibition=inhibition,
    )


def _force_bounds(state: State) -> Iterator[ForceBound]:
    """Loads in proportion to the force, at the force that makes them reach their bounds."""
    for load in state.loads:
        if load.limit.name in FORCE_LIMITS and load.value > 0.0:
            yield ForceBound(
                name=load.limit.name,
                words=load.limit.words,
                force=state.cutting_force * load.bound / load.value,
            )


def _overrides(state: State, sense: Sense) -> Iterator[float]:
    """Overrides at which limits on the feed are reached."""
    names = FEED_LIMITS if sense is Sense.AT_MOST else {LimitName.CHIP_THICKNESS}
    for load in state.loads:
        if load.limit.name in names and load.limit.sense is sense:
            yield _override(load, state)


def _override(load: Load, state: State) -> float:
    at = state.setting
    return load.limit.feed_at_bound(at.depth, at.speed) / at.feed
