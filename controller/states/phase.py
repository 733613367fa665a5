"""Phases of the control loop, :mod:`controller.states.loop_state`. Units: N."""

from dataclasses import dataclass
from enum import Enum

from controller.guard import OverrideReason


class Phase(Enum):
    """Phase of the loop, which determines the override; its value is the reported reason."""

    FOLLOWING = OverrideReason.NOTHING
    HELD = OverrideReason.OVERLOAD
    BLIND = OverrideReason.SILENCE
    INHIBITED = OverrideReason.INHIBITED
    OFF = OverrideReason.OFF
    STOPPED = OverrideReason.STOPPED


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedHold:
    """Overload that caused a feed hold, while the phase is HELD."""

    override: float
    """Override that the axes ran when the force was greatest."""
    force: float
    """Greatest force since the hold began, N."""
    calm: int = 0
    """Consecutive tooth periods below the set point; with runout, one is not enough."""
