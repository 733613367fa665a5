"""Machine behind the loop of ``control``: virtual, recorded, or a control that runs now."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from simulator.plant.controlled_machine import TrueState
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange, HiddenTruth
from simulator.reading import Reading
from simulator.spec import Machine


class LoopMachine(Protocol):
    """Sensor and override of the loop, with the state that a run writes down."""

    course: NominalCourse
    truth: TrueState

    @property
    def time(self) -> float:
        """Time of the run, s."""

    @property
    def commanded(self) -> float:
        """Last commanded override."""

    @property
    def share(self) -> float:
        """Completed share of the program, 0 to 1."""

    def set(self, override: float, /) -> None:
        """Set the ratio of feed to programmed feed."""

    def change(self, change: HiddenChange) -> None:
        """Apply a hidden change at its time."""

    def read(self) -> Reading | None:
        """Wait for the next reading; None at the end of the program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """Control that runs the program in place of the virtual machine."""

    name: str
    """Its name in the record of the outcomes."""
    connect: Callable[[NominalCourse, HiddenTruth, Machine], LoopMachine]
    """Connects to it, for a course, hidden behaviour and a machine."""
