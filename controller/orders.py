"""Orders of the operator to the running loop, and events that the loop reports.

The switches of the simulator in [1]_, Fig. 9: ON/OFF, TC/QC, and the motor power.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model".
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf


class Criterion(StrEnum):
    """Criterion by which the override is chosen."""

    TC = "TC"
    """Time-critical: as fast as the force bound and the chip load allow."""
    QC = "QC"
    """Quality-critical: the programmed chip load, less only where the force demands it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SwitchTo:
    """Order to switch the control on or off; when off, the programmed feed runs."""

    is_on: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CriterionTo:
    """Order to change the criterion to TC or QC."""

    criterion: Criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorPowerTo:
    """Order to limit the motor to a share of its power; 1 is the full power.

    Raises
    ------
    ValueError
        When the share is not positive and finite.
    """

    factor: float

    def __post_init__(self) -> None:
        if not 0.0 < self.factor < inf:
            raise ValueError(f"motor power × {self.factor:g}: it must be positive")


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedHoldTo:
    """Order to hold the feed, or to resume it."""

    is_held: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class OverrideAtMost:
    """Order to bound the override from above; the guard may keep it lower.

    Raises
    ------
    ValueError
        When the bound is not positive and finite.
    """

    most: float

    def __post_init__(self) -> None:
        if not 0.0 < self.most < inf:
            raise ValueError(f"override at most {self.most:g}: it must be positive")


Order = SwitchTo | CriterionTo | MotorPowerTo | FeedHoldTo | OverrideAtMost


class EventKind(StrEnum):
    """Kind of event reported by the control loop."""

    WORKINGSTEP = "workingstep"
    ORDER = "order"
    WARNING = "warning"
    OVER = "over"
    SAFE = "safe"
    HOLD = "hold"
    RESUME = "resume"
    STOP = "stop"
    BREAKAGE = "breakage"
    WEAR = "wear"
    HARDNESS = "hardness"
    UNREACHABLE = "unreachable"
    ASTRAY = "not followed"
    FOLLOWED = "followed"
    AVERAGED = "averaged"
    SILENCE = "silence"
    LOST = "lost"
    INHIBITED = "inhibited"


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopEvent:
    """Event reported by the control loop."""

    time: float
    """Time of the event, s."""
    kind: EventKind
    text: str
    """Sentence with numbers and units."""
