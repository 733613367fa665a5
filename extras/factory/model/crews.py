"""Crews while a shop runs: free members, and tasks that wait for one. Running state."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from simpy import Environment, Event

from extras.factory.model.calendar import Calendar
from extras.factory.model.shop import Crew
from extras.factory.model.store import Course


@dataclass(slots=True, eq=False)
class CrewOnDuty:
    """Crew with its free members. Running state."""

    env: Environment
    crew: Crew
    start: float
    """Time of the week at which the run begins, s."""
    busy: int = 0
    waiting: deque[Event] = field(default_factory=deque)

    @property
    def _is_open(self) -> bool:
        calendar = self.crew.calendar
        return calendar is None or calendar.is_open(self.start + self.env.now)

    def claim(self) -> Event | None:
        """Ask for a member; the event comes with one, None: one is free at once."""
        if self.busy < self.crew.members and self._is_open and not self.waiting:
            self.busy += 1
            return None
        event = self.env.event()
        self.waiting.append(event)
        return event

    def release(self) -> None:
        """Give a member back."""
        self.busy -= 1
        self.serve()

    def serve(self) -> None:
        """Let free members begin with tasks that wait."""
        while self.waiting and self.busy < self.crew.members and self._is_open:
            self.busy += 1
            self.waiting.popleft().succeed()


def changes_of_shift(
    env: Environment, calendar: Calendar, start: float, tell: Callable[[], object]
) -> Course:
    """SimPy process that calls a function whenever working hours begin or end.

    Parameters
    ----------
    start : float, s
        Time of the week at which the run begins.
    """
    while True:
        now = start + env.now
        yield env.timeout(calendar.next_change(now) - now)
        tell()
