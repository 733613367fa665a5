"""No control: the programmed feed, as if there were no law; runs are only recorded."""

from dataclasses import dataclass

from controller.law import Situation
from controller.laws.axes import within

PROGRAMMED = 1.0
"""override"""


@dataclass(frozen=True, slots=True)
class OpenLoop:
    """The law that leaves the override at 1; it needs no state."""

    def begin(self, override: float) -> None:
        """Nothing to remember."""

    def decide(self, state: None, at: Situation) -> tuple[None, float]:
        """An override of 1, or what of it the guard lets through."""
        return state, within(PROGRAMMED, at)
