"""Open-loop law without control: the programmed feed runs, and the run is only recorded."""

from dataclasses import dataclass

from controller.laws.axes import within
from controller.laws.law import Situation

PROGRAMMED = 1.0
"""Override of the programmed feed."""


@dataclass(frozen=True, slots=True)
class OpenLoop:
    """Open-loop law that keeps the override at 1; it needs no state."""

    def begin(self, override: float) -> None:
        """Return no state, because the law remembers nothing."""

    def decide(self, state: None, at: Situation) -> tuple[None, float]:
        """Return an override of 1, or the nearest that the guard allows."""
        return state, within(PROGRAMMED, at)
