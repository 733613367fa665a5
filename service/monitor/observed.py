"""The run of a program as it was measured: time and energy by workingstep.

A run begins when the execution leaves rest. A workingstep is whole if its beginning was
observed and no observation was lost since. Between two moments the values of the earlier one
hold.
"""

from dataclasses import dataclass, field
from math import isnan, nan

AT_REST = frozenset({"READY", "STOPPED", "PROGRAM_COMPLETED"})
"""Values of EXECUTION between two runs."""

MOST_STEPS = 1000
"""Workingsteps of a run that are told apart; further ones count as outside workingsteps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedMoment:
    """State of a machine from a moment on."""

    time: float
    """s, on the time axis of the rows."""
    execution: str | None
    program: str | None
    workingstep: str | None
    power: float = nan
    """Total power, in W; NaN: unknown."""

    @property
    def is_running(self) -> bool:
        """Whether a program is running; by its workingstep where the execution is unknown."""
        if self.execution is None:
            return bool(self.workingstep)
        return self.execution not in AT_REST


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedStep:
    """Time and energy of a workingstep so far."""

    id: str
    """Empty: outside workingsteps."""
    begin: float
    """s, on the time axis of the rows."""
    time: float
    """s"""
    energy: float
    """J; NaN: the power was unknown."""
    is_running: bool
    is_whole: bool
    """Whether it was measured from its beginning, without a gap."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedRun:
    """Run of a program so far."""

    program: str
    begin: float | None
    """s, on the time axis of the rows; None: the beginning was not observed."""
    is_running: bool
    steps: tuple[ObservedStep, ...] = ()
    """In the order in which they began."""


@dataclass(kw_only=True)
class _Sum:
    """Sums of a workingstep. Running state."""

    begin: float
    is_whole: bool
    time: float = 0.0
    energy: float = 0.0


@dataclass(kw_only=True)
class RunTracker:
    """Follows the runs of a machine. Running state."""

    _program: str = ""
    _begin: float | None = None
    _has_run: bool = False
    _sums: dict[str, _Sum] = field(default_factory=dict)
    last: ObservedMoment | None = None
    """Latest moment; None: nothing is known of the present."""

    def advance(self, now: ObservedMoment) -> None:
        """Take the state at a moment, not earlier than the last one."""
        last = self.last
        if last is not None and last.is_running:
            self._add(last, max(now.time - last.time, 0.0))
            self._drop_empty(now)
        if now.is_running:
            if self._is_new(now):
                is_observed = last is not None and (
                    last.execution in AT_REST or last.is_running
                )
                self._program = now.program or ""
                self._begin = now.time if is_observed else None
                self._has_run = True
                self._sums = {}
            self._enter(now)
        self.last = now

    def interrupt(self) -> None:
        """Note that observations were lost: what runs now is not whole."""
        if self.last is not None and self.last.is_running and self._key in self._sums:
            self._sums[self._key].is_whole = False
        self.last = None

    @property
    def run(self) -> ObservedRun | None:
        """The current run, or else the latest one."""
        if not self._has_run:
            return None
        is_running = self.last is not None and self.last.is_running
        return ObservedRun(
            program=self._program,
            begin=self._begin,
            is_running=is_running,
            steps=tuple(
                ObservedStep(
                    id=id,
                    begin=each.begin,
                    time=each.time,
                    energy=each.energy,
                    is_running=is_running and id == self._key,
                    is_whole=each.is_whole,
                )
                for id, each in self._sums.items()
            ),
        )

    @property
    def _key(self) -> str:
        """Workingstep of the last moment."""
        step = (self.last.workingstep if self.last is not None else None) or ""
        return step if step in self._sums else ""

    def _is_new(self, now: ObservedMoment) -> bool:
        last = self.last
        if last is None or not last.is_running:
            return True
        return bool(now.program and self._program and now.program != self._program)

    def _enter(self, now: ObservedMoment) -> None:
        """Begin a workingstep that is new to the run."""
        step = now.workingstep or ""
        if step in self._sums or len(self._sums) >= MOST_STEPS:
            return
        is_first = not self._sums
        is_whole = self._begin is not None or not is_first
        self._sums[step] = _Sum(begin=now.time, is_whole=is_whole)

    def _drop_empty(self, now: ObservedMoment) -> None:
        """Forget a workingstep that lasted no time: words of one moment come one by one."""
        key = self._key
        if key in self._sums and key != (now.workingstep or "") and not self._sums[key].time:
            del self._sums[key]

    def _add(self, last: ObservedMoment, seconds: float) -> None:
        step = last.workingstep or ""
        found = self._sums.get(step) or self._sums.setdefault(
            "", _Sum(begin=last.time, is_whole=False)
        )
        found.time += seconds
        if seconds > 0.0:
            found.energy += nan if isnan(last.power) else last.power * seconds
