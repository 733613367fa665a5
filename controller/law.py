"""Interface of control laws: functions of a state and a situation.

Cutting force over feed is a power law, ``F = K·g·u^p`` with the override u, the expected
force g at u = 1, a factor K that nobody knows, and p = 1 − m_c: in logarithms a linear,
time-invariant plant of gain p behind the lag of the feed drives. Laws work there, once a
revolution.

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
    """Input of a law's decision: one revolution of the spindle."""

    force: float
    """N, mean of the last revolution, above 0"""
    set_point: float
    """N, above 0"""
    override: float
    """that was commanded last"""
    actual: float
    """override that the axes ran in the last revolution"""
    floor: float
    """least override that the guard lets through"""
    ceiling: float
    """greatest override that the guard lets through"""
    expected: float = 0.0
    """N, g of the last revolution: expected at override 1; 0: not known"""
    ahead: tuple[float, ...] = ()
    """N, g of each of the next revolutions, the greatest within one revolution before and
    after; empty: nothing is known ahead"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plant:
    """Process model that a law is tuned for."""

    exponent: float = 0.8
    """p = 1 − m_c, of force over feed"""
    lag: float = 3.0
    """of the feed drives, revolutions"""


class ControlLaw(Protocol[S]):
    """A control law. The object holds what was tuned; all that changes is in the state."""

    def begin(self, override: float) -> S:
        """State with which a cut begins that runs at this override."""
        ...

    def decide(self, state: S, at: Situation) -> tuple[S, float]:
        """The next state, and the override that the law wants, within floor and ceiling.

        Called once a revolution while there are chips. A law that wants more than it gets
        must not wind up: what counts is ``at.override``, which the guard let through.
        """
        ...
