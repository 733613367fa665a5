"""Ring buffer of observations, with checkpoints of the state. Running state.

Observations are kept as columns and written as XML once, when they are first asked for.
Sequence numbers start at 1 and never repeat: they give the order. Timestamps are those of the
senders, whose clocks may differ, so that they may go back.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extras.agent.model.model import DeviceModel
from simulator.motion.segments import Ints

SIZE = 1 << 17
"""observations that are kept unless told otherwise"""

EVERY = 1000
"""observations between checkpoints"""

CONDITIONS = ("NORMAL", "WARNING", "FAULT", "UNAVAILABLE")


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionValue:
    """A report of a condition."""

    level: str
    """of ``CONDITIONS``"""
    native_code: str = ""
    native_severity: str = ""
    qualifier: str = ""
    text: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeSeriesValue:
    """Values at a constant rate; the timestamp is that of the last."""

    values: tuple[float, ...]
    rate: float
    """Hz; 0: that of the data item"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AssetReference:
    """Asset that was changed or removed."""

    id: str
    type: str


Value = (
    float
    | int
    | str
    | None
    | ConditionValue
    | TimeSeriesValue
    | AssetReference
    | dict[str, str | None]
)
"""None is UNAVAILABLE; a number or a text; an entry of a data set that is None is removed"""


@dataclass(frozen=True, slots=True)
class StateEntry:
    """A value that holds, with the observation that brought it."""

    sequence: int
    time: int
    """µs since 1970"""
    value: Value


State = list[tuple[StateEntry, ...]]
"""for each data item what holds: one entry, or one for each active condition"""


@dataclass(kw_only=True)
class ObservationBuffer:
    """Ring buffer of observations: the oldest are dropped first."""

    model: DeviceModel
    size: int = SIZE
    now: int
    """µs since 1970, when it is made"""
    next: int = 1
    """sequence number of the next observation"""
    state: State = field(init=False)
    """what holds after the last observation"""

    def __post_init__(self) -> None:
        # Some more than are shown, so that each that is shown comes after a checkpoint.
        self._room = self.size + EVERY
        self._latest = self.now
        self._items: Ints = np.zeros(self._room, dtype=np.int64)
        self._times: Ints = np.zeros(self._room, dtype=np.int64)
        self._values: list[Value] = [None] * self._room
        self._rendered: list[bytes | None] = [None] * self._room
        self._is_compound = np.array([
            item.category == "CONDITION" or item.representation in {"DATA_SET", "TABLE"}
            for item in self.model.items
        ])
        self._checkpoints: dict[int, State] = {}
        """state before the observation of a sequence number"""
        count = len(self.model.items)
        self.state = [() for _ in range(count)]
        self._checkpoints[1] = list(self.state)
        values: list[Value] = [
            ConditionValue(level="UNAVAILABLE")
            if item.category == "CONDITION"
            else item.constant
            for item in self.model.items
        ]
        self.append(np.arange(count), np.full(count, self.now), values)

    @property
    def first(self) -> int:
        """Sequence number of the oldest observation that is kept."""
        return max(1, self.next - self.size)

    @property
    def last(self) -> int:
        """Sequence number of the newest observation."""
        return self.next - 1

    @property
    def last_time(self) -> int:
        """Latest timestamp so far, µs since 1970."""
        return self._latest

    def append(self, items: Ints, times: Ints, values: Sequence[Value]) -> None:
        """Add observations in the order in which they came.

        Parameters
        ----------
        items : array (N,)
            Numbers of the data items.
        times : array (N,), µs since 1970
            Kept as they are, in any order.
        values : sequence (N,)
        """
        begin, count = 0, len(items)
        if count:
            self._latest = max(self._latest, int(times.max()))
        while begin < count:
            # Up to the next checkpoint and the end of the ring.
            to_checkpoint = EVERY - (self.next - 1) % EVERY
            place = self.next % self._room
            end = min(count, begin + to_checkpoint, begin + self._room - place)
            step = end - begin
            self._items[place : place + step] = items[begin:end]
            self._times[place : place + step] = times[begin:end]
            self._values[place : place + step] = values[begin:end]
            self._rendered[place : place + step] = [None] * step
            self._hold(
                self.state, self.next, items[begin:end], times[begin:end], values[begin:end]
            )
            self.next += step
            begin = end
            if (self.next - 1) % EVERY == 0:
                self._checkpoint()

    def take(self, sequences: Ints) -> tuple[Ints, Ints]:
        """Items and timestamps of observations that are kept."""
        places = sequences % self._room
        return self._items[places], self._times[places]

    def value(self, sequence: int) -> Value:
        """Value of an observation that is kept."""
        return self._values[sequence % self._room]

    def rendered(self, sequence: int, render: Callable[[int, int, int, Value], bytes]) -> bytes:
        """An observation as ``render(item, time, sequence, value)`` makes it, once."""
        place = sequence % self._room
        text = self._rendered[place]
        if text is None:
            item, time = int(self._items[place]), int(self._times[place])
            text = self._rendered[place] = render(item, time, sequence, self._values[place])
        return text

    def state_at(self, sequence: int) -> State:
        """State after an observation that is kept."""
        start = max(each for each in self._checkpoints if each <= sequence)
        state = list(self._checkpoints[start])
        span = np.arange(start, sequence + 1)
        items, times = self.take(span)
        self._hold(state, start, items, times, [self.value(each) for each in span.tolist()])
        return state

    def _hold(
        self, state: State, first: int, items: Ints, times: Ints, values: Sequence[Value]
    ) -> None:
        """Let observations count, in place: plain ones by the last of each item."""
        count = len(items)
        if not count:
            return
        numbers, rows = np.unique(items[::-1], return_index=True)
        for item, row in zip(numbers.tolist(), (count - 1 - rows).tolist(), strict=True):
            if not self._is_compound[item]:
                state[item] = (StateEntry(first + row, int(times[row]), values[row]),)
        for row in np.flatnonzero(self._is_compound[items]).tolist():
            item, value = int(items[row]), values[row]
            entry = StateEntry(first + row, int(times[row]), value)
            if isinstance(value, ConditionValue):
                state[item] = _active(state[item], entry, value)
            elif isinstance(value, dict):
                state[item] = (_merged(state[item], entry, value),)
            else:
                state[item] = (entry,)

    def _checkpoint(self) -> None:
        self._checkpoints[self.next] = list(self.state)
        # The oldest that is needed stands at or before the oldest observation.
        older = [each for each in self._checkpoints if each <= self.first]
        for each in older[:-1]:
            del self._checkpoints[each]


def _active(
    before: tuple[StateEntry, ...], entry: StateEntry, value: ConditionValue
) -> tuple[StateEntry, ...]:
    """Active conditions after a report: one for each native code."""
    if value.level == "UNAVAILABLE" or (value.level == "NORMAL" and not value.native_code):
        return (entry,)
    others = tuple(
        each
        for each in before
        if isinstance(each.value, ConditionValue)
        and each.value.level in {"WARNING", "FAULT"}
        and each.value.native_code != value.native_code
    )
    if value.level == "NORMAL":
        plain = StateEntry(entry.sequence, entry.time, ConditionValue(level="NORMAL"))
        return others or (plain,)
    return (*others, entry)


def _merged(
    before: tuple[StateEntry, ...], entry: StateEntry, value: dict[str, Any]
) -> StateEntry:
    """Data set after changes of some of its keys."""
    old = before[0].value if before else None
    merged = {**(old if isinstance(old, dict) else {}), **value}
    kept = {key: each for key, each in merged.items() if each is not None}
    return StateEntry(entry.sequence, entry.time, kept)
