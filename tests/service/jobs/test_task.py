"""What a job is given: its folder, whom to tell, the program it works on."""

import json
import logging

import numpy as np
import pytest

from service.errors import NotFound
from service.ids import new_id
from service.jobs.child import ProgressHandler
from service.jobs.task import RunningJob, optimised_name, program_file
from service.storage import jobs, programs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from service.storage.results import OPTIMISED, RESULT
from tests.service.storage.conftest import data_folder  # noqa: F401 (a fixture)


def running(data_folder: DataFolder, **words: str) -> RunningJob:  # noqa: F811
    jobs.add(
        data_folder, JobRequest(kind=JobKind.ADVICE, request={"a": 1}, owner="anna", **words)
    )
    job = jobs.claim(data_folder, kinds=[JobKind.ADVICE])
    assert job is not None
    task = RunningJob(data_folder=data_folder, job=job)
    assert task.make_folder()
    return task


def test_a_result_is_json_whatever_the_numbers(data_folder: DataFolder) -> None:  # noqa: F811
    task = running(data_folder)
    task.keep({"a": np.array([1.0, np.nan]), "b": float("inf"), 3: "ü"})
    found = json.loads((task.folder / RESULT).read_bytes())
    assert found == {"a": [1.0, None], "b": None, "3": "ü"}


def test_progress_is_told_now_and_then_and_words_without_a_share_never(
    data_folder: DataFolder,  # noqa: F811
) -> None:
    task = running(data_folder)
    task.tell("material: as requested")
    assert jobs.get(data_folder, task.job.id).message == ""
    task.tell("3 of 10 workingsteps")
    told = jobs.get(data_folder, task.job.id)
    assert (told.share, told.message) == (0.3, "3 of 10 workingsteps")
    task.tell("4 of 10 workingsteps")
    assert jobs.get(data_folder, task.job.id).share == 0.3
    task._said = 0.0
    task.progress(7.0, "too much")
    assert jobs.get(data_folder, task.job.id).share == 1.0


def test_what_a_library_says_is_progress_and_no_line_of_the_log(
    data_folder: DataFolder,  # noqa: F811
    capfd: pytest.CaptureFixture[str],
) -> None:
    task = running(data_folder)
    words = {"msg": "compiling march for this machine", "levelno": logging.WARNING}
    ProgressHandler(task).handle(logging.makeLogRecord(words))
    assert jobs.get(data_folder, task.job.id).message == "compiling march for this machine"
    assert capfd.readouterr().err == ""


def test_a_program_is_an_upload_or_what_an_advice_made_of_it(data_folder: DataFolder) -> None:  # noqa: F811
    stored = programs.add(data_folder, b"x", name="part.one.stp", owner="anna")
    task = running(data_folder, program=stored.id)
    assert task.program_file() == (data_folder.program_file(stored.id), "part.one.stp")
    words = {"program": stored.id, "source": task.job.id}
    with pytest.raises(NotFound, match="optimised program of advice"):
        program_file(data_folder, **words)
    (task.folder / OPTIMISED).write_bytes(b"y")
    assert program_file(data_folder, **words) == (
        data_folder.job_folder(task.job.id) / OPTIMISED,
        "part.one.optimised.stpnc",
    )
    with pytest.raises(NotFound, match="there is no advice"):
        program_file(data_folder, program=stored.id, source=new_id())
    with pytest.raises(NotFound, match="there is no program"):
        program_file(data_folder, program=new_id(), source="")


def test_names_of_optimised_programs() -> None:
    assert optimised_name("part.stpnc") == "part.optimised.stpnc"
    assert optimised_name("part") == "part.optimised.stpnc"
