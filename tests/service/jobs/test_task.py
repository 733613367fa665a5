"""What a job is given: its folder, whom to tell, the program it works on."""

import json
import logging

import numpy as np
import pytest

from service.depot import jobs, programs
from service.depot.folder import Depot
from service.depot.ids import new_id
from service.depot.jobs import Kind, Order
from service.errors import NotFound
from service.jobs.child import Words
from service.jobs.task import OPTIMISED, RESULT, Task, optimised_name, program_file
from tests.service.depot.conftest import depot  # noqa: F401 (a fixture)


def running(depot: Depot, **words: str) -> Task:  # noqa: F811
    jobs.add(depot, Order(kind=Kind.ADVICE, request={"a": 1}, owner="anna", **words))
    job = jobs.claim(depot, kinds=[Kind.ADVICE])
    assert job is not None
    task = Task(depot=depot, job=job)
    task.folder.mkdir()
    return task


def test_a_result_is_json_whatever_the_numbers(depot: Depot) -> None:  # noqa: F811
    task = running(depot)
    task.keep({"a": np.array([1.0, np.nan]), "b": float("inf"), 3: "ü"})
    found = json.loads((task.folder / RESULT).read_bytes())
    assert found == {"a": [1.0, None], "b": None, "3": "ü"}


def test_progress_is_told_now_and_then_and_words_without_a_share_never(
    depot: Depot,  # noqa: F811
) -> None:
    task = running(depot)
    task.tell("material: as asked for")
    assert jobs.get(depot, task.job.id).message == ""
    task.tell("3 of 10 workingsteps")
    told = jobs.get(depot, task.job.id)
    assert (told.share, told.message) == (0.3, "3 of 10 workingsteps")
    task.tell("4 of 10 workingsteps")
    assert jobs.get(depot, task.job.id).share == 0.3
    task._said = 0.0
    task.progress(7.0, "too much")
    assert jobs.get(depot, task.job.id).share == 1.0


def test_what_a_library_says_is_progress_and_no_line_of_the_log(
    depot: Depot,  # noqa: F811
    capfd: pytest.CaptureFixture[str],
) -> None:
    task = running(depot)
    words = {"msg": "compiling march for this machine", "levelno": logging.WARNING}
    Words(task).handle(logging.makeLogRecord(words))
    assert jobs.get(depot, task.job.id).message == "compiling march for this machine"
    assert capfd.readouterr().err == ""


def test_the_request_is_a_copy(depot: Depot) -> None:  # noqa: F811
    task = running(depot)
    task.request["a"] = 2
    assert task.request == {"a": 1}


def test_a_program_is_an_upload_or_what_an_advice_made_of_it(depot: Depot) -> None:  # noqa: F811
    stored = programs.add(depot, b"x", name="part.one.stp", owner="anna")
    task = running(depot, program=stored.id)
    assert task.program_file() == (depot.program_file(stored.id), "part.one.stp")
    words = {"program": stored.id, "source": task.job.id}
    with pytest.raises(NotFound, match="optimised program of advice"):
        program_file(depot, **words)
    (task.folder / OPTIMISED).write_bytes(b"y")
    assert program_file(depot, **words) == (task.folder / OPTIMISED, "part.one.optimised.stpnc")
    with pytest.raises(NotFound, match="there is no advice"):
        program_file(depot, program=stored.id, source=new_id())
    with pytest.raises(NotFound, match="there is no program"):
        program_file(depot, program=new_id(), source="")


def test_names_of_optimised_programs() -> None:
    assert optimised_name("part.stpnc") == "part.optimised.stpnc"
    assert optimised_name("part") == "part.optimised.stpnc"
