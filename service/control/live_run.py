"""What every run offers that is watched and changed while it runs. Units s.

Nothing here knows wall time: who paces a run asks it to go on until a time of the machine.
"""

from dataclasses import dataclass
from typing import Protocol, TypeVar

from controller.orders import Event
from service.control.trace import Moment

C_contra = TypeVar("C_contra", contravariant=True)
"""what is asked of the run"""
S_co = TypeVar("S_co", covariant=True)
"""how it is"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Taken:
    """What happened since it was asked last, ascending in time."""

    moments: tuple[Moment, ...] = ()
    """a row for each revolution, or quarter of a second"""
    events: tuple[Event, ...] = ()


class LiveRun(Protocol[C_contra, S_co]):
    """A run that goes on when it is told to."""

    @property
    def time(self) -> float:
        """S of the machine."""
        ...

    def advance(self, until: float) -> bool:
        """Run until a time, s; False: it does not go on any more."""
        ...

    def taken(self) -> Taken:
        """What happened since it was asked last."""
        ...

    def change(self, wanted: C_contra, /) -> None:
        """Let something be otherwise from the next cycle on.

        Raises
        ------
        StepNcError
            When it cannot be; nothing has changed then.
        """
        ...

    def status(self) -> S_co:
        """How the run is now."""
        ...
