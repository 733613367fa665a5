"""What held the override, in words, and for how long in each workingstep.

The guard says why a law did not have its way (:class:`controller.guard.Holding`); at an end of
the band it is the plan that says whose end it is. Running state. Units s.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import inf, isfinite

from controller.aims import Aims
from controller.cycle import Cycle
from controller.guard import Holding, aimed
from controller.orders import Criterion, EventKind
from controller.reference import FEED_LIMITS, Reference, reference_of
from controller.target import wanted
from controller.threshold import Level
from optimiser.advice import Advice, State
from optimiser.limit import LimitName, Sense

NO_CHIPS = "no chips"
TOP = "top of the override band"
BOTTOM = "bottom of the override band"
PROGRAMMED = "the programmed feed, by mode QC"
PROGRAMMED_LEAST = "the programmed feed, at which the edge rubs"
FREE = "the programmed feed, as nothing bounds the force"
OFF = "the programmed feed, as control is off"
ASKED = "force asked for"
STRENGTH = "strength of the tool"
RUBBING = "no feed keeps the roughness"

CLOSE = 1e-6
"""relative distance within which the override counts as being at an end"""

NEAR = 1e-3
"""relative distance below which two bounds of the force are told as the first"""

_LEVELS = {
    EventKind.SAFE: Level.SAFE,
    EventKind.WARNING: Level.WARNING,
    EventKind.OVER: Level.OVER,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ends:
    """Between which overrides a workingstep may run, and what says so."""

    reference: Reference
    ceiling: tuple[float, str] = (inf, "")
    floor: tuple[float, str] = (0.0, "")

    def force_bound(self, aims: Aims) -> str:
        """What the set point of the force follows from; empty: there is none."""
        force = wanted(aims, self.reference)
        if aimed(force, self.reference) < force * (1.0 - NEAR):
            return STRENGTH
        if aims.set_point is not None:
            return ASKED
        bound = self.reference.bound(power_factor=aims.power_factor)
        return "" if bound is None else bound.words


AROUND = Ends(reference=Reference(workingstep=""))
"""of what stands before the first workingstep"""


@dataclass(kw_only=True)
class Held:
    """One workingstep. Running state."""

    begin: float
    """s of the run"""
    holds: int = 0
    """of the feed"""
    seconds: dict[str, float] = field(default_factory=dict)
    """with chips, by what held the override"""
    blind: float = 0.0
    """s without a force at feed"""

    @property
    def shares(self) -> tuple[tuple[str, float], ...]:
        """What held the override and its share of the time with chips, the longest first."""
        whole = sum(self.seconds.values())
        ordered = sorted(self.seconds.items(), key=lambda item: -item[1])
        return tuple((words, seconds / whole) for words, seconds in ordered)


class Holdings:
    """Looks at each cycle. Running state.

    Parameters
    ----------
    advices : sequence of Advice
        Of the workingsteps in the order of their beginning; None: nothing is known of it.
    """

    def __init__(self, advices: Sequence[Advice | None]) -> None:
        self.steps: dict[int, Held] = {}
        """by the workingstep's number"""
        self.level = Level.SAFE
        self.words = ""
        """what holds the override now"""
        self._ends = [AROUND if advice is None else ends_of(advice) for advice in advices]

    def add(self, cycle: Cycle, aims: Aims) -> None:
        """One more cycle."""
        reading = cycle.reading
        held = self.steps.get(reading.workingstep)
        if held is None:
            held = Held(begin=reading.time - reading.period)
            self.steps[reading.workingstep] = held
        for event in cycle.events:
            held.holds += event.kind is EventKind.HOLD
            self.level = _LEVELS.get(event.kind, self.level)
        if reading.can_override and cycle.allowed.holding is Holding.SILENCE:
            held.blind += reading.period
        if not reading.can_override:
            self.words = ""
        elif cycle.revolution is not None:
            has_chips = cycle.revolution.force > aims.chips
            ends = self.ends(reading.workingstep)
            self.words = reason(cycle, ends, aims) if has_chips else NO_CHIPS
            if has_chips:
                period = cycle.revolution.period
                held.seconds[self.words] = held.seconds.get(self.words, 0.0) + period

    def ends(self, workingstep: int) -> Ends:
        """Of a workingstep by its number."""
        return self._ends[workingstep - 1] if 0 < workingstep <= len(self._ends) else AROUND


def reason(cycle: Cycle, ends: Ends, aims: Aims) -> str:
    """What holds the override in a revolution with chips."""
    holding, override = cycle.allowed.holding, cycle.allowed.override
    if holding is Holding.OFF:
        return OFF
    if holding not in {Holding.NOTHING, Holding.BAND}:
        return holding.value
    if not isfinite(cycle.set_point) and override == 1.0:
        return FREE
    most = (1.0 if aims.criterion is Criterion.QC else inf, PROGRAMMED)
    ceiling, above = min(ends.ceiling, (aims.band.ceiling, TOP), most)
    floor, below = max(ends.floor, (aims.band.floor, BOTTOM))
    if override >= ceiling * (1.0 - CLOSE):
        return above
    if override <= floor * (1.0 + CLOSE):
        return below
    return ends.force_bound(aims)


def ends_of(advice: Advice) -> Ends:
    """What the limits on the feed allow around the feed as programmed."""
    reference, state = reference_of(advice), advice.before
    if state is None:
        return Ends(reference=reference)
    highest = dict(_overrides(state, FEED_LIMITS, Sense.AT_MOST))
    lowest = dict(_overrides(state, frozenset({LimitName.CHIP_THICKNESS}), Sense.AT_LEAST))
    return Ends(
        reference=reference,
        ceiling=(reference.ceiling, highest.get(reference.ceiling, RUBBING)),
        floor=(reference.floor, lowest.get(reference.floor, PROGRAMMED_LEAST)),
    )


def _overrides(
    state: State, names: frozenset[LimitName], sense: Sense
) -> Iterator[tuple[float, str]]:
    """Overrides at which limits on the feed are reached, with their words."""
    at = state.setting
    for load in state.loads:
        limit = load.limit
        if limit.name in names and limit.sense is sense:
            yield limit.feed_at_bound(at.depth, at.speed) / at.feed, limit.words
