"""Records of a running shop: parts made, and times that machines spent in their states."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from extras.factory.model.states import MachineState
from extras.factory.model.store import Batch
from stepnc_model.editing.cut_settings import CutSettings


class PartMade(NamedTuple):
    """One part that left a machine. Times without failures and waits, s."""

    machine: int
    """Index of the machine."""
    product: int
    step: int
    batch: int
    part: int
    end: float
    """Time at which it was ejected, s."""
    batch_setup: float
    """0 for all parts but the first of a batch on this machine."""
    part_setup: float
    machining: float
    part_ejection: float
    batch_ejection: float
    """0 for all parts but the last of a batch on this machine."""
    energy: float
    """Energy of machining, J."""
    peak_power: float
    """W"""
    settings: CutSettings
    is_good: bool


class StateSpent(NamedTuple):
    """Time that a machine spent in a state."""

    machine: int
    state: MachineState
    begin: float
    """s"""
    end: float
    """s"""
    energy: float
    """J"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Listeners:
    """Functions that are told what happens in a running shop."""

    part: tuple[Callable[[PartMade], None], ...] = ()
    """Called with each part that leaves a machine."""
    count: tuple[Callable[[int, float], None], ...] = ()
    """Called with the number of parts that left a machine, and the time in s; parts of which
    nobody else hears may be told together, as their batch leaves."""
    state: tuple[Callable[[StateSpent], None], ...] = ()
    """Called when a machine leaves a state."""
    began: tuple[Callable[[int], None], ...] = ()
    """Called with the index of a machine that has entered a state, at that time."""
    entered: tuple[Callable[[Batch], None], ...] = ()
    """Called with each batch that enters the shop, at its release."""
    left: tuple[Callable[[Batch, float], None], ...] = ()
    """Called with each batch that leaves the shop, and the time in s."""

    def plus(self, other: "Listeners") -> "Listeners":
        """All functions of both."""
        return Listeners(
            part=self.part + other.part,
            count=self.count + other.count,
            state=self.state + other.state,
            began=self.began + other.began,
            entered=self.entered + other.entered,
            left=self.left + other.left,
        )
