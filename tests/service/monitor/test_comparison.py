"""A measured run beside its prediction."""

from dataclasses import replace
from math import isnan

import pytest

from service.monitor.observed_run import (
    AlignedPart,
    ObservedRun,
    ObservedStep,
    PredictedStep,
    StepState,
    compared,
    predicted_steps,
)

PREDICTED = (
    PredictedStep(id="", begin=0.0, time=2.0, energy=20.0),
    PredictedStep(id="A", begin=2.0, time=10.0, energy=1000.0),
    PredictedStep(id="B", begin=12.0, time=5.0, energy=400.0),
    PredictedStep(id="C", begin=17.0, time=3.0, energy=300.0),
)


def step(id: str, begin: float, time: float, energy: float, **more: bool) -> ObservedStep:
    words = {"is_running": False, "is_whole": True, **more}
    return ObservedStep(id=id, begin=begin, time=time, energy=energy, **words)


RUN = ObservedRun(
    program="p", begin=100.0, is_running=True,
    steps=(
        step("", 100.0, 2.0, 22.0), step("A", 102.0, 12.0, 1100.0),
        step("B", 114.0, 1.0, 90.0, is_running=True),
    ),
)  # fmt: skip


def test_a_workingstep_is_compared_once_it_is_done() -> None:
    found = compared(RUN, PREDICTED)
    states = [each.state for each in found.steps]
    assert states == [StepState.DONE, StepState.DONE, StepState.RUNNING, StepState.TO_COME]
    assert found.steps[1].time_ratio == pytest.approx(1.2)
    assert found.steps[1].energy_ratio == pytest.approx(1.1)
    assert isnan(found.steps[2].time_ratio)
    assert isnan(found.steps[3].measured_time)
    assert (found.done.measured_time, found.done.predicted_time) == (14.0, 12.0)
    assert found.done.energy_ratio == pytest.approx(1122.0 / 1020.0)


def test_the_prediction_is_moved_to_the_beginning_of_each_workingstep() -> None:
    assert compared(RUN, PREDICTED).parts == (
        AlignedPart(begin=0.0, end=2.0, shift=100.0),
        AlignedPart(begin=2.0, end=12.0, shift=100.0),
        AlignedPart(begin=12.0, end=17.0, shift=102.0),
        AlignedPart(begin=17.0, end=20.0, shift=102.0),
    )


def test_a_part_ends_where_the_next_one_begins() -> None:
    fast = replace(RUN, steps=(RUN.steps[0], RUN.steps[1], step("B", 106.0, 1.0, 90.0)))
    assert compared(fast, PREDICTED).parts[1] == AlignedPart(begin=2.0, end=6.0, shift=100.0)


def test_a_run_whose_beginning_was_missed_is_aligned_from_the_next_workingstep() -> None:
    steps = (step("A", 50.0, 3.0, 100.0, is_whole=False), step("B", 53.0, 1.0, 90.0))
    found = compared(replace(RUN, begin=None, steps=steps), PREDICTED)
    assert [part.begin for part in found.parts] == [12.0, 17.0]
    assert found.steps[1].state is StepState.PARTIAL
    assert isnan(found.steps[1].time_ratio)
    assert found.done.measured_time == 1.0
    assert compared(replace(RUN, begin=None, steps=steps[:1]), PREDICTED).parts == ()


def test_a_machine_without_workingsteps_is_aligned_at_the_beginning() -> None:
    found = compared(replace(RUN, steps=(step("", 100.0, 30.0, 9.0),)), PREDICTED)
    assert {part.shift for part in found.parts} == {100.0}


def test_what_only_the_machine_knows_comes_last_and_does_not_count() -> None:
    found = compared(replace(RUN, steps=(*RUN.steps, step("Z", 120.0, 7.0, 9.0))), PREDICTED)
    assert [each.id for each in found.steps] == ["", "A", "B", "C", "Z"]
    assert isnan(found.steps[-1].predicted_time)
    assert found.done.measured_time == 14.0


def test_before_the_first_run_everything_is_to_come() -> None:
    found = compared(None, PREDICTED)
    assert {each.state for each in found.steps} == {StepState.TO_COME}
    assert found.parts == ()
    assert isnan(found.done.time_ratio)


def test_predictions_are_read_from_a_result() -> None:
    row = {"id": None, "begin_s": 0.0, "time_s": 2.0, "energy_j": {"total": 20.0}}
    assert predicted_steps({"workingsteps": [row]}) == PREDICTED[:1]
