"""Shifts while a shop runs: a SimPy process that tells of their beginnings and ends."""

from collections.abc import Callable

from simpy import Environment

from simulator.factory.calendar import Calendar
from simulator.factory.store import Course


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
