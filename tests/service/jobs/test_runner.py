"""The runner: what is killed is not forgotten, what is cancelled ends, nobody stays."""

import multiprocessing
import os
import signal
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

import pytest

from service.errors import Conflict
from service.jobs import preloaded, preloaded_common, runner
from service.storage import jobs
from service.storage.folder import DATABASE, open_data_folder
from service.storage.jobs import JobKind, JobState
from tests.service.jobs.conftest import IMPATIENT, MAIN, Shop
from tests.service.waiting import children, ended, is_alive, until


def process_of(shop: Shop, id: str) -> int:
    """Of a running job: the one that has its rows open."""
    series = str(shop.data_folder.job_folder(id) / "series.bin")
    for pid in children(shop.runners[-1].pid):
        try:
            opened = [os.readlink(each) for each in Path(f"/proc/{pid}/fd").iterdir()]
        except OSError:
            continue
        if series in opened:
            return pid
    raise AssertionError("no process works on it")


def test_a_running_simulation_is_cancelled_within_seconds(shop: Shop) -> None:
    id = shop.order(JobKind.SIMULATION, pace=0.1).id
    shop.runs(id)
    jobs.cancel(shop.data_folder, id)
    job = shop.over(id, within=120.0)
    assert (job.state, job.problem) == (JobState.CANCELLED, None)
    folder = shop.data_folder.job_folder(id)
    assert not (folder / "result.json").exists()
    assert not [each.name for each in folder.iterdir() if each.name.startswith(".samples")]


def test_a_job_whose_process_was_killed_says_so_and_the_next_one_runs(shop: Shop) -> None:
    id = shop.order(JobKind.SIMULATION, pace=0.1).id
    shop.runs(id)
    next_one = shop.order(JobKind.SIMULATION).id
    os.kill(process_of(shop, id), signal.SIGKILL)
    job = shop.over(id)
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:job-lost"
    assert "SIGKILL" in job.problem["detail"]
    assert shop.over(next_one).state is JobState.SUCCEEDED


def test_live_runs_do_not_wait_for_other_jobs(shop: Shop) -> None:
    paced = [shop.order(JobKind.SIMULATION, pace=0.1).id for _ in range(2)]
    trials = [shop.order(JobKind.TRIAL).id for _ in range(2)]
    for id in (*paced, *trials):
        shop.runs(id)
    assert shop.over(shop.order(JobKind.SIMULATION).id).state is JobState.SUCCEEDED
    for id in (*paced, *trials):
        jobs.cancel(shop.data_folder, id)
    assert {shop.over(id).state for id in (*paced, *trials)} == {JobState.CANCELLED}


def test_one_runner_works_for_a_folder(shop: Shop) -> None:
    with pytest.raises(Conflict, match="another server is using this folder"):
        runner.locked(shop.data_folder.root)


def test_a_lock_is_free_again_when_it_is_closed(tmp_path: Path) -> None:
    with runner.locked(tmp_path):
        pass
    with runner.locked(tmp_path):
        pass


def test_a_sign_of_life_grows_old(tmp_path: Path) -> None:
    data_folder = open_data_folder(tmp_path, knowledge="none.db")
    assert not runner.is_alive(data_folder)
    runner.beat(data_folder)
    runner.beat(data_folder)
    assert runner.is_alive(data_folder)
    with data_folder.database.writing() as connection:
        connection.execute("UPDATE runner SET seen = seen - ?", (5.0 * runner.BEAT,))
    assert not runner.is_alive(data_folder)


def test_a_locked_database_ends_nobody_and_what_happened_is_told_later(
    own_shop: Shop,
) -> None:
    server = own_shop.start(IMPATIENT)
    trial, killed = own_shop.order(JobKind.TRIAL).id, own_shop.order(JobKind.TRIAL).id
    own_shop.runs(trial)
    own_shop.runs(killed)
    with closing(sqlite3.connect(own_shop.data_folder.root / DATABASE)) as other:
        other.isolation_level = None
        other.execute("BEGIN IMMEDIATE")
        pid = process_of(own_shop, killed)
        os.kill(pid, signal.SIGKILL)
        until(lambda: "does not answer" in own_shop.log.read_text(encoding="utf-8"))
        until(lambda: "job ended" in own_shop.log.read_text(encoding="utf-8"))
        assert own_shop.job(killed).state is JobState.RUNNING
        other.execute("ROLLBACK")
    lost = own_shop.over(killed, within=120.0)
    assert lost.problem is not None
    assert "SIGKILL" in lost.problem["detail"]
    assert own_shop.over(own_shop.order(JobKind.SIMULATION).id).state is JobState.SUCCEEDED
    assert (server.poll(), own_shop.job(trial).state) == (None, JobState.RUNNING)
    assert own_shop.log.read_text(encoding="utf-8").count("does not answer") == 1


def test_a_folder_that_was_moved_away_is_not_made_anew_and_may_come_back(
    own_shop: Shop, tmp_path: Path
) -> None:
    server = own_shop.start()
    root = own_shop.data_folder.root
    root.rename(tmp_path / "moved")
    until(lambda: "does not answer" in own_shop.log.read_text(encoding="utf-8"))
    assert not root.exists()
    (tmp_path / "moved").rename(root)
    assert own_shop.over(own_shop.order(JobKind.SIMULATION).id).state is JobState.SUCCEEDED
    assert server.poll() is None


HASTY = f"""
from service.jobs import runner
runner.LONGEST_PACED = 0.5
{MAIN}"""


def test_a_run_for_which_nobody_comes_has_an_end_that_says_why(own_shop: Shop) -> None:
    own_shop.start(HASTY)
    job = own_shop.over(own_shop.order(JobKind.TRIAL).id)
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:too-long"
    assert "h, the time limit of such a job" in job.problem["detail"]


def test_all_are_ended_though_one_of_them_is_gone_already(own_shop: Shop) -> None:
    context = multiprocessing.get_context("forkserver")
    gone, stays = (context.Process(target=signal.pause) for _ in range(2))
    for each in (gone, stays):
        each.start()
    gone.kill()
    gone.join()
    gone.close()
    made = runner.Runner(data_folder=own_shop.data_folder, workers=1)
    for each in (gone, stays):
        own_shop.order(JobKind.TRIAL)
        job = jobs.claim(own_shop.data_folder)
        assert job is not None
        made.running[job.id] = runner.Running(job=job, process=each)
    made._end_all()
    assert not stays.is_alive()


def test_what_is_preloaded_is_loaded() -> None:
    assert preloaded.__doc__ is not None
    assert preloaded_common.__doc__ is not None
    assert {"service.verbs.simulate.result", "pydantic.type_adapter"} <= set(sys.modules)


def test_a_killed_runner_leaves_nobody_and_the_next_one_finishes_its_job(
    own_shop: Shop,
) -> None:
    killed = own_shop.start()
    id, trial = (
        own_shop.order(JobKind.SIMULATION, pace=40.0).id,
        own_shop.order(JobKind.TRIAL).id,
    )
    own_shop.runs(id)
    own_shop.runs(trial)
    below = children(killed.pid)
    assert {process_of(own_shop, id), process_of(own_shop, trial)} <= below
    killed.kill()
    ended(killed)
    until(lambda: not any(map(is_alive, below)))
    assert own_shop.job(id).state is JobState.RUNNING
    own_shop.start()
    job = own_shop.over(id)
    assert (job.state, job.attempt) == (JobState.SUCCEEDED, 2)
    lost = own_shop.job(trial)
    assert (lost.state, lost.attempt) == (JobState.FAILED, 1)
    assert lost.problem is not None
    assert "cannot be resumed" in lost.problem["detail"]


def test_a_runner_that_is_told_to_stop_ends_its_jobs_for_the_next_one(own_shop: Shop) -> None:
    first = own_shop.start()
    id = own_shop.order(JobKind.SIMULATION, pace=40.0).id
    own_shop.runs(id)
    below = children(first.pid)
    first.send_signal(signal.SIGINT)
    first.send_signal(signal.SIGTERM)
    assert ended(first) == 0
    until(lambda: not any(map(is_alive, below)))
    with runner.locked(own_shop.data_folder.root):
        """free at once"""
    assert own_shop.job(id).state is JobState.RUNNING
    own_shop.start()
    assert own_shop.over(id).state is JobState.SUCCEEDED
