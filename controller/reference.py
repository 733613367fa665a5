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
    """What the loop is to keep in one workingstep.

    Raises
    ------
    ValueError
        When the ceiling or the breakage force is not positive, or the floor is negative.
    """

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

    def __post_init__(self) -> None:
        if not (self.ceiling > 0.0 and self.breakage > 0.0 and self.floor >= 0.0):
            raise ValueError(
                f"workingstep '{self.workingstep}': ceiling {self.ceiling:g} and breakage "
                f"force {self.breakage:g} N must be positive, floor {self.floor:g} not negative"
            )

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
    rubbing = max(_overrides(state, Sense.AT_LEAST), default=0.0)
    ceiling = _ceiling(state, rubbing)
    strengths = [each.force for each in bounds if each.name is LimitName.SHANK_STRENGTH]
    breakage = BREAKAGE_RATIO * bounds[0].force if bounds else inf
    return Reference(
        workingstep=name,
        bounds=tuple(bounds),
        floor=min(rubbing, ceiling, 1.0),
        ceiling=ceiling,
        breakage=min(strengths, default=breakage),
        inhibition=inhibition,
    )


def _ceiling(state: State, rubbing: float) -> float:
    """Override that all limits on the feed allow.

    A roughness that no feed attains, or none at which the edge still cuts, bounds nothing: the
    plan says so, and feeds that only rub make it worse.
    """
    ceiling = min(_overrides(state, Sense.AT_MOST), default=inf)
    return ceiling if ceiling > rubbing else max(rubbing, 1.0)


def _force_bounds(state: State) -> Iterator[ForceBound]:
    """Loads in proportion to the force, at the force that makes them reach their bounds."""
    shares = _shares(state)
    for load in state.loads:
        if load.limit.name in FORCE_LIMITS and load.value > 0.0:
            own = state.cutting_force * shares.get(_part(load), 1.0)
            yield ForceBound(
                name=load.limit.name,
                words=load.limit.words,
                force=own * load.bound / load.value,
            )


def _shares(state: State) -> dict[tuple[str, float], float]:
    """Force of each part of the cut over that of the hardest, by their torques.

    Walls, the floor that is swept with them and a plunge take different forces with the same
    cutter; the state tells the greatest of them.
    """
    torques: dict[tuple[str, float], float] = {}
    for load in state.loads:
        if load.limit.name is LimitName.SPINDLE_TORQUE:
            torques[_part(load)] = max(load.value, torques.get(_part(load), 0.0))
    greatest = max(torques.values(), default=0.0)
    return {part: torque / greatest for part, torque in torques.items() if torque > 0.0}


def _part(load: Load) -> tuple[str, float]:
    """What tells the parts of a cut: how they are labelled, and how they know their depth."""
    label = load.limit.label.removeprefix(load.limit.name.words)
    return label, load.limit.load.depth_exponent


def _overrides(state: State, sense: Sense) -> Iterator[float]:
    """Overrides at which limits on the feed are reached."""
    names = FEED_LIMITS if sense is Sense.AT_MOST else {LimitName.CHIP_THICKNESS}
    for load in state.loads:
        if load.limit.name in names and load.limit.sense is sense:
            yield _override(load, state)


def _override(load: Load, state: State) -> float:
    at = state.setting
    return load.limit.feed_at_bound(at.depth, at.speed) / at.feed
