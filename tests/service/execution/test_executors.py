"""Work on processes: results of all tasks, also after a process was killed."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.execution.executors import MOST_LOSSES, processes, results
from stepnc_model.errors import StepNcError
from tests.service.execution import work
from tests.service.waiting import until


def test_every_task_has_one_result() -> None:
    tasks = [(number,) for number in range(600)]
    found = list(results(processes, work.square, tasks, tell=pytest.fail, what="squares"))
    assert sorted(found) == [(number, number * number) for number in range(600)]


def test_tasks_are_taken_as_there_is_room_for_them() -> None:
    taken: list[int] = []

    def tasks() -> Iterator[tuple[int]]:
        for number in range(2000):
            taken.append(number)
            yield (number,)

    first = next(results(processes, work.square, tasks(), tell=pytest.fail, what="squares"))
    assert first == (first[0], first[0] ** 2)
    assert len(taken) < 1000


def test_what_a_killed_process_had_is_made_again(tmp_path: Path) -> None:
    told: list[str] = []
    tasks = [(tmp_path / "killed", number) for number in range(20)]
    found = list(results(processes, work.end_once, tasks, tell=told.append, what="numbers"))
    assert sorted(found) == [(number, number) for number in range(20)]
    assert len(told) == 1
    assert "a process was ended from outside" in told[0]


def test_work_that_ends_every_process_is_given_up() -> None:
    told: list[str] = []
    with pytest.raises(StepNcError, match=f"2 numbers: .* were ended {MOST_LOSSES} times"):
        list(
            results(processes, work.end_always, [(1,), (2,)], tell=told.append, what="numbers")
        )
    assert len(told) == MOST_LOSSES - 1


def test_an_error_of_the_work_is_that_of_the_caller() -> None:
    with pytest.raises(ValueError, match="number 1"):
        list(results(processes, work.refuse, [(1,)], tell=pytest.fail, what="numbers"))


def test_what_is_done_when_the_caller_is_interrupted_is_broken_off(tmp_path: Path) -> None:
    mark = tmp_path / "mark"

    def interrupted() -> None:
        with processes(1) as pool:
            for _ in range(3):
                pool.submit(work.go_on, mark)
            until(mark.exists)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not mark.exists()
