"""Interface of control laws: functions of a state and a situation.

Cutting force over feed is a power law, ``F = K·g·u^p`` with the override u, the expected
force g at u = 1, an unknown factor K, and p = 1 − m_c: in logarithms a linear, time-invariant
plant of gain p behind the lag of the feed drives. Laws work in logarithms, once a revolution.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: adaptive control of the peak
   force by the feed, once a revolution of the spindle.
"""

from dataclasses import dataclass
from typing import Protocol, TypeVar

S = TypeVar("S")


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """Input of a control law for one revolution of the spindle."""

    force: float
    """Mean force of the last revolution, N, above 0."""
    set_point: float
    """Set point of the force, N, above 0."""
    override: float
    """Last commanded override."""
    actual: float
    """Override that the axes ran in the last revolution."""
    floor: float
    """Least override that the guard allows."""
    ceiling: float
    """Greatest override that the guard allows."""
    expected: float = 0.0
    """Force g expected in the last revolution at override 1, N; 0: not known."""
    ahead: tuple[float, ...] = ()
    """Force g expected in each of the next revolutions, N; empty: not known.

    Each value is the greatest within one revolution before and after.
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class Plant:
    """Process model for which a law is tuned."""

    exponent: float = 0.8
    """Exponent p = 1 − m_c of force over feed."""
    lag: float = 3.0
    """Lag of the feed drives, revolutions."""


class ControlLaw(Protocol[S]):
    """Control law; the object holds the tuning, and everything that changes is in the state."""

    def begin(self, override: float) -> S:
        """Initial state for a cut that begins at a given override."""
        ...

    def decide(self, state: S, at: Situation) -> tuple[S, float]:
        """Return the next state and the override requested, within floor and ceiling.

        Called once a revolution while there are chips. A law that requests more than it gets
        must not wind up: the override that was applied is ``at.override``, as limited by the
        guard.
        """
        ...
