"""The run of a program as it was measured: time and energy by workingstep.

A run begins when the execution leaves rest. A workingstep is whole if its beginning was
observed and no observation was lost since. Between two moments the values of the earlier one
hold.

A measured run beside its prediction: workingstep by workingstep, and on one time axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import isnan, nan
from typing import Any

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
        """True if a program is running; by its workingstep where the execution is unknown."""
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


class StepState(StrEnum):
    """Share of a workingstep that was measured."""

    TO_COME = "to come"
    RUNNING = "running"
    DONE = "done"
    PARTIAL = "partial"
    """It is over, but its beginning or a part of it was not observed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedStep:
    """Time and energy of a workingstep in a simulated run."""

    id: str
    """Empty: outside workingsteps."""
    begin: float
    """Time from the beginning of the program, in s."""
    time: float
    """s"""
    energy: float
    """J"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepComparison:
    """Workingstep as measured and as predicted; NaN: not known."""

    id: str
    state: StepState
    measured_time: float
    """s, so far"""
    measured_energy: float
    """J, so far"""
    predicted_time: float
    """s"""
    predicted_energy: float
    """J"""

    @property
    def time_ratio(self) -> float:
        """Measured over predicted time; NaN until the workingstep is done."""
        return self._ratio(self.measured_time, self.predicted_time)

    @property
    def energy_ratio(self) -> float:
        """Measured over predicted energy; NaN until the workingstep is done."""
        return self._ratio(self.measured_energy, self.predicted_energy)

    def _ratio(self, measured: float, predicted: float) -> float:
        return measured / predicted if self.state is StepState.DONE and predicted else nan


@dataclass(frozen=True, slots=True, kw_only=True)
class AlignedPart:
    """Part of the prediction, moved to the time axis of the measured rows."""

    begin: float
    """Time in the prediction, in s."""
    end: float
    """Time in the prediction, in s."""
    shift: float
    """What is added to the time of the prediction, in s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Measured run beside its prediction."""

    steps: tuple[StepComparison, ...]
    done: StepComparison
    """Sum of all workingsteps that are done and predicted."""
    parts: tuple[AlignedPart, ...]
    """Empty as long as neither the beginning nor a common workingstep was observed."""


def predicted_steps(result: Mapping[str, Any]) -> tuple[PredictedStep, ...]:
    """Read the workingsteps from the result of a simulation."""
    return tuple(
        PredictedStep(
            id=row["id"] or "",
            begin=row["begin_s"],
            time=row["time_s"],
            energy=row["energy_j"]["total"],
        )
        for row in result["workingsteps"]
    )


def compared(run: ObservedRun | None, predicted: Sequence[PredictedStep]) -> Comparison:
    """Compare a measured run with its prediction.

    Workingsteps come in the order of the prediction; those that only the machine knows follow.
    """
    measured = {} if run is None else {step.id: step for step in run.steps}
    by_id = {step.id: step for step in predicted}
    ids = [*by_id, *(id for id in measured if id not in by_id)]
    steps = tuple(_compared(id, measured.get(id), by_id.get(id)) for id in ids)
    return Comparison(steps=steps, done=_done(steps), parts=_aligned(run, predicted))


def _compared(
    id: str, measured: ObservedStep | None, predicted: PredictedStep | None
) -> StepComparison:
    return StepComparison(
        id=id,
        state=_state(measured),
        measured_time=nan if measured is None else measured.time,
        measured_energy=nan if measured is None else measured.energy,
        predicted_time=nan if predicted is None else predicted.time,
        predicted_energy=nan if predicted is None else predicted.energy,
    )


def _state(measured: ObservedStep | None) -> StepState:
    if measured is None:
        return StepState.TO_COME
    if measured.is_running:
        return StepState.RUNNING
    return StepState.DONE if measured.is_whole else StepState.PARTIAL


def _done(steps: Sequence[StepComparison]) -> StepComparison:
    done = [
        step
        for step in steps
        if step.state is StepState.DONE and not isnan(step.predicted_time)
    ]
    return StepComparison(
        id="",
        state=StepState.DONE,
        measured_time=sum(step.measured_time for step in done),
        measured_energy=sum(step.measured_energy for step in done),
        predicted_time=sum(step.predicted_time for step in done),
        predicted_energy=sum(step.predicted_energy for step in done),
    )


def _aligned(
    run: ObservedRun | None, predicted: Sequence[PredictedStep]
) -> tuple[AlignedPart, ...]:
    """Move each workingstep to its measured beginning; others follow the one before."""
    if run is None:
        return ()
    begins = {
        step.id: step.begin
        for number, step in enumerate(run.steps)
        # Where the beginning of the run was missed, so was that of its first workingstep.
        if step.id and (number or run.begin is not None)
    }
    shift = run.begin
    found: list[AlignedPart] = []
    for step in predicted:
        if step.id in begins:
            shift = begins[step.id] - step.begin
        if shift is not None:
            found.append(AlignedPart(begin=step.begin, end=step.begin + step.time, shift=shift))
    return tuple(_without_overlap(found))


def _without_overlap(parts: Sequence[AlignedPart]) -> list[AlignedPart]:
    """Cut each part where the next one begins on the measured axis."""
    found = []
    for number, part in enumerate(parts):
        end = part.end
        if number + 1 < len(parts):
            following = parts[number + 1]
            end = min(end, following.begin + following.shift - part.shift)
        if end > part.begin:
            found.append(AlignedPart(begin=part.begin, end=end, shift=part.shift))
    return found
