"""States of machines of a live shop over time, from the file of their changes, for a screen.

Where a range has more changes than a screen shows, each part of it shows the state that the
machine was in for the longest.
"""

from dataclasses import dataclass

import numpy as np

from extras.factory.model.states import MachineState
from service.live.series import Series
from simulator.motion.segments import Floats, Ints

STATES = tuple(MachineState)
"""States in the order of their numbers in the file."""

COLUMNS = ("time_s", "machine", "state")

MOST_ROWS = 2_000_000
"""Most changes that are looked at, 50 MB; of more, the latest."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StateBars:
    """States of one machine, one after another without gaps."""

    state: tuple[str, ...]
    begin: tuple[float, ...]
    """s"""
    end: tuple[float, ...]
    """s"""


def state_bars(
    series: Series, machines: int, *, begin: float, end: float, bars: int
) -> list[StateBars]:
    """States of each machine in a range of time.

    Parameters
    ----------
    series : Series
        With :data:`COLUMNS`.
    machines : int
        Number of machines.
    begin, end : float, s
    bars : int
        Most bars of a machine.
    """
    rows = np.asarray(series.values[-MOST_ROWS:], dtype=np.float64)
    rows = rows[: int(np.searchsorted(rows[:, 0], end, side="left"))]
    return [
        _bars(rows[rows[:, 1] == row], begin=begin, end=end, bars=bars)
        for row in range(machines)
    ]


def _bars(rows: Floats, *, begin: float, end: float, bars: int) -> StateBars:
    """States of one machine from its changes."""
    times, states = rows[:, 0], rows[:, 2].astype(np.int64)
    first = max(0, int(np.searchsorted(times, begin, side="right")) - 1)
    times, states = np.maximum(times[first:], begin), states[first:]
    # Of changes at one time the last one holds.
    lasts = np.append(np.diff(times) > 0.0, True)[: len(times)]
    times, states = times[lasts], states[lasts]
    if len(times) > bars:
        times, states = _longest(times, states, end=end, bars=bars)
    differs = np.append(True, states[1:] != states[:-1])[: len(states)]
    times, states = times[differs], states[differs]
    ends = np.append(times[1:], end)[: len(times)]
    return StateBars(
        state=tuple(STATES[each].value for each in states.tolist()),
        begin=tuple(times.tolist()),
        end=tuple(ends.tolist()),
    )


def _longest(times: Floats, states: Ints, *, end: float, bars: int) -> tuple[Floats, Ints]:
    """State that lasts longest in each of equal parts of a range."""
    edges = np.linspace(times[0], end, bars + 1)
    nodes = np.append(times, end)
    lengths = np.diff(nodes)
    spent = np.empty((len(STATES), bars))
    for state in range(len(STATES)):
        until = np.concatenate(([0.0], np.cumsum(np.where(states == state, lengths, 0.0))))
        spent[state] = np.diff(np.interp(edges, nodes, until))
    return edges[:-1], spent.argmax(axis=0)
