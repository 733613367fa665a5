"""A measured run beside its prediction: workingstep by workingstep, and on one time axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isnan, nan
from typing import Any

from service.monitor.observed import ObservedRun, ObservedStep


class StepState(StrEnum):
    """How much of a workingstep was measured."""

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
