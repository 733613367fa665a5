"""Reasons that limited the override in each workingstep, in words, with their durations.

The guard says why it overrode the law (:class:`controller.guard.OverrideReason`); at an end of
the override band, the plan says which limit sets that end. Running state. Units s.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import inf, isfinite

from controller.cycle import LoopCycle
from controller.guard import OverrideReason, aimed
from controller.monitoring.threshold import AlarmLevel
from controller.orders import Criterion, EventKind
from controller.reference import FEED_LIMITS, Reference, reference_of
from controller.states.loop_settings import LoopSettings
from controller.states.set_point import wanted
from optimiser.advice import Advice, EvaluatedSetting
from optimiser.solver.problem import BoundSide, LimitName

NO_CHIPS = "no chips"
TOP = "top of the override band"
BOTTOM = "bottom of the override band"
PROGRAMMED = "the programmed feed, by mode QC"
PROGRAMMED_LEAST = "the programmed feed, at which the edge rubs"
FREE = "the programmed feed, as nothing bounds the force"
OFF = "the programmed feed, as control is off"
FORCE_ORDER = "force asked for"
STRENGTH = "strength of the tool"
RUBBING = "no feed keeps the roughness"

LEAST_FEEDS = frozenset({LimitName.CHIP_THICKNESS, LimitName.FEED_PER_TOOTH})
"""Limits that set the least feed."""

CLOSE = 1e-6
"""Relative distance within which the override counts as being at an end of its band."""

NEAR = 1e-3
"""Relative distance below which two force bounds count as equal."""

_LEVELS = {
    EventKind.SAFE: AlarmLevel.SAFE,
    EventKind.WARNING: AlarmLevel.WARNING,
    EventKind.OVER: AlarmLevel.OVER,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class OverrideLimits:
    """Override range of a workingstep, with the limits that set its ends."""

    reference: Reference
    ceiling: tuple[float, str] = (inf, "")
    floor: tuple[float, str] = (0.0, "")

    def force_bound(self, settings: LoopSettings) -> str:
        """Name of the limit that sets the force set point; empty if there is none."""
        force = wanted(settings, self.reference)
        if aimed(force, self.reference) < force * (1.0 - NEAR):
            return STRENGTH
        if settings.set_point is not None:
            return FORCE_ORDER
        bound = self.reference.bound(power_factor=settings.power_factor)
        return "" if bound is None else bound.words


AROUND = OverrideLimits(reference=Reference(workingstep=""))
"""Override limits outside all workingsteps."""


@dataclass(kw_only=True)
class HoldTally:
    """Durations of the reasons that limited the override in one workingstep. Running state."""

    begin: float
    """Start time in the run, in s."""
    holds: int = 0
    """Number of feed holds."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Cutting time by the reason that limited the override, in s."""
    blind: float = 0.0
    """Time at feed without a measured force, in s."""

    @property
    def shares(self) -> tuple[tuple[str, float], ...]:
        """Reasons that limited the override, with shares of the cutting time, longest first."""
        whole = sum(self.seconds.values())
        ordered = sorted(self.seconds.items(), key=lambda item: -item[1])
        return tuple((words, seconds / whole) for words, seconds in ordered)


class HoldTallies:
    """Tallies of all workingsteps, updated in each control cycle. Running state.

    Parameters
    ----------
    advices : sequence of Advice
        Advices of the workingsteps in order of execution; None where no advice exists.
    """

    def __init__(self, advices: Sequence[Advice | None]) -> None:
        self.steps: dict[int, HoldTally] = {}
        """Tallies by workingstep number."""
        self.level = AlarmLevel.SAFE
        self.words = ""
        """Reason that limits the override now."""
        self._ends = [AROUND if advice is None else ends_of(advice) for advice in advices]

    def add(self, cycle: LoopCycle, settings: LoopSettings) -> None:
        """Add a control cycle."""
        reading = cycle.reading
        held = self.steps.get(reading.workingstep)
        if held is None:
            held = HoldTally(begin=reading.time - reading.period)
            self.steps[reading.workingstep] = held
        for event in cycle.events:
            held.holds += event.kind is EventKind.HOLD
            self.level = _LEVELS.get(event.kind, self.level)
        if reading.can_override and cycle.allowed.holding is OverrideReason.SILENCE:
            held.blind += reading.period
        if not reading.can_override:
            self.words = ""
        elif cycle.revolution is not None:
            has_chips = cycle.revolution.force > settings.chips
            ends = self.ends(reading.workingstep)
            self.words = reason(cycle, ends, settings) if has_chips else NO_CHIPS
            if has_chips:
                period = cycle.revolution.period
                held.seconds[self.words] = held.seconds.get(self.words, 0.0) + period

    def ends(self, workingstep: int) -> OverrideLimits:
        """Return the override limits of a workingstep, by its number."""
        return self._ends[workingstep - 1] if 0 < workingstep <= len(self._ends) else AROUND


def reason(cycle: LoopCycle, ends: OverrideLimits, settings: LoopSettings) -> str:
    """Return the reason that limits the override in a revolution with chips."""
    holding, override = cycle.allowed.holding, cycle.allowed.override
    if holding is OverrideReason.OFF:
        return OFF
    if holding not in {OverrideReason.NOTHING, OverrideReason.BAND}:
        return holding.value
    if not isfinite(cycle.set_point) and override == 1.0:
        return FREE
    most = (1.0 if settings.criterion is Criterion.QC else inf, PROGRAMMED)
    ceiling, above = min(ends.ceiling, (settings.band.ceiling, TOP), most)
    floor, below = max(ends.floor, (settings.band.floor, BOTTOM))
    if override >= ceiling * (1.0 - CLOSE):
        return above
    if override <= floor * (1.0 + CLOSE):
        return below
    return ends.force_bound(settings)


def ends_of(advice: Advice) -> OverrideLimits:
    """Return the override limits around the programmed feed."""
    reference, state = reference_of(advice), advice.before
    if state is None:
        return OverrideLimits(reference=reference)
    highest = dict(_overrides(state, FEED_LIMITS, BoundSide.AT_MOST))
    lowest = dict(_overrides(state, LEAST_FEEDS, BoundSide.AT_LEAST))
    return OverrideLimits(
        reference=reference,
        ceiling=(reference.ceiling, highest.get(reference.ceiling, RUBBING)),
        floor=(reference.floor, lowest.get(reference.floor, PROGRAMMED_LEAST)),
    )


def _overrides(
    state: EvaluatedSetting, names: frozenset[LimitName], sense: BoundSide
) -> Iterator[tuple[float, str]]:
    """Yield the overrides at which feed limits are reached, with the names of the limits."""
    at = state.setting
    for load in state.loads:
        limit = load.limit
        if limit.name in names and limit.sense is sense:
            yield limit.feed_at_bound(at.depth, at.speed) / at.feed, limit.words
