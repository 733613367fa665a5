"""Time and energy by workingstep, from what a machine tells."""

from math import isnan, nan

import pytest

from service.monitor import observed_run as observed
from service.monitor.observed_run import ObservedMoment, ObservedRun, ObservedStep, RunTracker


def at(
    time: float,
    execution: str | None,
    step: str = "",
    *,
    power: float = 100.0,
    program: str = "p",
) -> ObservedMoment:
    return ObservedMoment(
        time=time, execution=execution, program=program, workingstep=step or None, power=power
    )


def after(*moments: ObservedMoment) -> ObservedRun:
    tracker = RunTracker()
    for moment in moments:
        tracker.advance(moment)
    assert tracker.run is not None
    return tracker.run


def sums(run: ObservedRun) -> list[tuple[str, float, float, bool]]:
    return [(step.id, step.time, step.energy, step.is_whole) for step in run.steps]


def test_a_run_that_is_seen_from_its_beginning_is_whole() -> None:
    run = after(
        at(0.0, "READY"), at(5.0, "ACTIVE", "A"), at(15.0, "ACTIVE", "B", power=200.0),
        at(20.0, "FEED_HOLD", "B"), at(22.0, "PROGRAM_COMPLETED", "B"), at(90.0, "READY"),
    )  # fmt: skip
    assert (run.begin, run.program, run.is_running) == (5.0, "p", False)
    assert sums(run) == [("A", 10.0, 1000.0, True), ("B", 7.0, 1200.0, True)]
    assert [step.begin for step in run.steps] == [5.0, 15.0]


def test_a_run_that_is_found_running_has_no_beginning() -> None:
    run = after(at(3.0, "ACTIVE", "A"), at(4.0, "ACTIVE", "B"), at(6.0, "ACTIVE", "B"))
    assert run.begin is None
    assert sums(run) == [("A", 1.0, 100.0, False), ("B", 2.0, 200.0, True)]
    assert [step.is_running for step in run.steps] == [False, True]
    assert after(at(0.0, None), at(1.0, "ACTIVE", "A")).begin is None


def test_a_new_program_or_a_new_start_begins_a_new_run() -> None:
    first = [at(0.0, "READY"), at(1.0, "ACTIVE", "A"), at(2.0, "PROGRAM_COMPLETED")]
    again = after(*first, at(3.0, "ACTIVE", "A"), at(7.0, "ACTIVE", "A"))
    assert (again.begin, sums(again)) == (3.0, [("A", 4.0, 400.0, True)])
    other = after(
        *first[:2], at(5.0, "ACTIVE", "B", program="q"), at(6.0, "ACTIVE", "B", program="q")
    )
    assert (other.program, other.begin) == ("q", 5.0)
    assert sums(other) == [("B", 1.0, 100.0, True)]


def test_lost_observations_make_a_run_partial() -> None:
    tracker = RunTracker()
    for moment in (at(0.0, "READY"), at(1.0, "ACTIVE", "A"), at(2.0, "ACTIVE", "B")):
        tracker.advance(moment)
    tracker.interrupt()
    assert tracker.run is not None
    assert [step.is_whole for step in tracker.run.steps] == [True, False]
    assert not tracker.run.is_running
    tracker.advance(at(9.0, "ACTIVE", "B"))
    tracker.advance(at(10.0, "ACTIVE", "C"))
    assert tracker.run.begin is None
    assert sums(tracker.run) == [("B", 1.0, 100.0, False), ("C", 0.0, 0.0, True)]


def test_words_of_one_moment_leave_no_workingstep_without_time() -> None:
    run = after(
        at(0.0, "PROGRAM_COMPLETED", "LAST"), at(1.0, "ACTIVE", "LAST"), at(1.0, "ACTIVE", "A"),
        at(2.0, "ACTIVE", "A"),
    )  # fmt: skip
    assert sums(run) == [("A", 1.0, 100.0, True)]


def test_without_power_there_is_no_energy() -> None:
    run = after(at(0.0, "READY"), at(1.0, "ACTIVE", "A", power=nan), at(2.0, "ACTIVE", "A"))
    assert run.steps[0].time == 1.0
    assert isnan(run.steps[0].energy)


def test_without_execution_a_workingstep_says_that_a_program_runs() -> None:
    run = after(at(0.0, None), at(1.0, None, "A"), at(2.0, None, "A"))
    assert run.is_running
    assert [step.id for step in run.steps] == ["A"]


def test_workingsteps_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(observed, "MOST_STEPS", 2)
    run = after(at(0.0, "READY"), *(at(float(n), "ACTIVE", f"S{n}") for n in range(1, 6)))
    assert sums(run)[:2] == [("S1", 1.0, 100.0, True), ("S2", 1.0, 100.0, True)]
    assert run.steps[2] == ObservedStep(
        id="", begin=3.0, time=2.0, energy=200.0, is_running=True, is_whole=False
    )
    assert len(run.steps) == 3
