"""What a running shop tells: parts made, and times that machines spent in their states."""

from typing import NamedTuple, Protocol

from simulator.factory.machining import Settings
from simulator.factory.states import MachineState
from simulator.factory.store import Batch


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
    settings: Settings
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


class Recorder(Protocol):
    """Receiver of what a shop tells."""

    def part(self, part: PartMade) -> None:
        """A part left a machine."""

    def state(self, spent: StateSpent) -> None:
        """A machine left a state."""

    def entered(self, batch: Batch) -> None:
        """A batch entered the shop at the time of its release."""

    def left(self, batch: Batch, *, time: float) -> None:
        """A batch left the shop."""
