"""Jobs: each is claimed once, what a stale attempt says is not written, none is forgotten."""

import sys
import time
from subprocess import PIPE, Popen

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import Conflict, NotFound, TooMany
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import (
    LOCAL,
    MOST_ATTEMPTS,
    MOST_ATTEMPTS_SHARED,
    Job,
    JobKind,
    JobRequest,
    JobState,
)
from service.storage.pages import PageCursor

ALL = tuple(JobKind)
REVIEW = JobRequest(kind=JobKind.REVIEW, request={"a": [1, None, "é"]}, owner="anna")


def queued(
    data_folder: DataFolder, kind: JobKind = JobKind.REVIEW, *, owner: str = "anna"
) -> Job:
    return jobs.add(data_folder, JobRequest(kind=kind, request={}, owner=owner))


def claimed(data_folder: DataFolder, kind: JobKind = JobKind.REVIEW) -> Job:
    id = queued(data_folder, kind).id
    job = jobs.claim(data_folder, kinds=[kind])
    assert job is not None
    assert job.id == id
    return job


def test_a_job_is_asked_for_claimed_and_finished(data_folder: DataFolder) -> None:
    job = jobs.add(data_folder, REVIEW)
    assert (job.state, job.attempt, job.request) == (JobState.QUEUED, 0, REVIEW.request)
    running = jobs.claim(data_folder, kinds=ALL)
    assert running is not None
    assert (running.id, running.state, running.attempt) == (job.id, JobState.RUNNING, 1)
    jobs.tell(data_folder, running, share=0.5, message="half")
    told = jobs.get(data_folder, job.id)
    assert (told.share, told.message, told.started is None) == (0.5, "half", False)
    jobs.finish(data_folder, running, JobState.SUCCEEDED)
    done = jobs.get(data_folder, job.id, JobKind.REVIEW)
    assert (done.state, done.share, done.problem) == (JobState.SUCCEEDED, 1.0, None)
    assert done.ended is not None
    assert jobs.claim(data_folder, kinds=ALL) is None


def test_the_oldest_of_the_wanted_kinds_comes_first(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = [queued(data_folder).id for _ in range(4)]
    monkeypatch.setattr(time, "time_ns", lambda: 0)  # a wall clock that was set back
    made.append(queued(data_folder).id)
    queued(data_folder, JobKind.TRIAL)
    assert jobs.claim(data_folder, kinds=[]) is None
    found = [jobs.claim(data_folder, kinds=[JobKind.REVIEW, JobKind.ADVICE]) for _ in range(6)]
    assert [each and each.id for each in found] == [*made, None]


def test_jobs_that_wait_for_the_clock_are_told_from_those_that_work(
    data_folder: DataFolder,
) -> None:
    def add(kind: JobKind, **request: object) -> str:
        return jobs.add(data_folder, JobRequest(kind=kind, request=request, owner="anna")).id

    paced = {
        add(JobKind.SIMULATION, pace=0.5),
        add(JobKind.TRIAL, pace=1),
        add(JobKind.CONTROL, pace=0.0),
    }
    plain = {
        add(JobKind.SIMULATION, pace=0.0), add(JobKind.SIMULATION), add(JobKind.ADVICE),
        add(JobKind.REVIEW),
    }  # fmt: skip
    for wanted, is_paced in ((plain, False), (paced, True)):
        found = [jobs.claim(data_folder, is_paced=is_paced) for _ in range(len(wanted) + 1)]
        assert found[-1] is None
        assert {job.id for job in found if job} == wanted
        assert {job.is_paced for job in found if job} == {is_paced}


def test_a_kind_is_told_from_another(data_folder: DataFolder) -> None:
    job = queued(data_folder, JobKind.TRIAL)
    with pytest.raises(NotFound, match="there is no control-run"):
        jobs.get(data_folder, job.id, JobKind.CONTROL)
    with pytest.raises(NotFound, match="there is no job"):
        jobs.get(data_folder, "../etc")


CLAIMER = """
import sys
from pathlib import Path
from service.storage import jobs
from service.storage.folder import open_data_folder
data_folder = open_data_folder(Path(sys.argv[1]), database=sys.argv[2])
print("ready", flush=True)
sys.stdin.read(1)
while (job := jobs.claim(data_folder, kinds=list(jobs.JobKind))) is not None:
    print(job.id)
"""


def test_processes_that_claim_at_once_get_each_job_once(data_folder: DataFolder) -> None:
    made = {queued(data_folder).id for _ in range(60)}
    address = data_folder.address
    command = [sys.executable, "-c", CLAIMER, address.root, address.database]
    claimers = [Popen(command, stdin=PIPE, stdout=PIPE, text=True) for _ in range(3)]
    for claimer in claimers:
        assert claimer.stdout is not None
        assert claimer.stdout.readline() == "ready\n"
    for claimer in claimers:
        assert claimer.stdin is not None
        claimer.stdin.write("!")
        claimer.stdin.flush()
    found: list[str] = []
    for claimer in claimers:
        out, _ = claimer.communicate(timeout=120.0)
        assert claimer.returncode == 0
        found += out.split()
    assert len(found) == 60
    assert set(found) == made
    assert {job.attempt for job in jobs.running(data_folder)} == {1}


def test_a_stale_attempt_writes_nothing(data_folder: DataFolder) -> None:
    stale = claimed(data_folder)
    jobs.recover(data_folder, jobs.running(data_folder))
    fresh = jobs.claim(data_folder, kinds=ALL)
    assert fresh is not None
    assert (fresh.id, fresh.attempt) == (stale.id, 2)
    jobs.tell(data_folder, stale, share=0.9, message="of the dead")
    jobs.finish(data_folder, stale, JobState.FAILED, problem={"title": "of the dead"})
    now = jobs.get(data_folder, stale.id)
    assert (now.state, now.share, now.message, now.problem) == (JobState.RUNNING, 0.0, "", None)
    jobs.finish(data_folder, fresh, JobState.SUCCEEDED)
    assert jobs.get(data_folder, stale.id).state is JobState.SUCCEEDED


def test_the_first_end_of_a_job_is_its_end(data_folder: DataFolder) -> None:
    job = claimed(data_folder)
    jobs.finish(data_folder, job, JobState.SUCCEEDED)
    jobs.finish(data_folder, job, JobState.FAILED, problem=jobs.lost("late"))
    jobs.tell(data_folder, job, share=0.1, message="late")
    done = jobs.get(data_folder, job.id)
    assert (done.state, done.problem, done.share) == (JobState.SUCCEEDED, None, 1.0)


def test_one_that_waits_is_cancelled_at_once_and_never_claimed(data_folder: DataFolder) -> None:
    job = queued(data_folder)
    assert jobs.cancel(data_folder, job.id).state is JobState.CANCELLED
    assert jobs.cancel(data_folder, job.id).state is JobState.CANCELLED
    assert jobs.claim(data_folder, kinds=ALL) is None


def test_one_that_runs_is_asked_to_end(data_folder: DataFolder) -> None:
    job = claimed(data_folder)
    found = jobs.cancel(data_folder, job.id)
    assert (found.state, found.is_cancelling) == (JobState.RUNNING, True)
    jobs.finish(data_folder, job, JobState.CANCELLED)
    assert jobs.get(data_folder, job.id).state is JobState.CANCELLED


def test_what_is_over_is_not_cancelled(data_folder: DataFolder) -> None:
    job = claimed(data_folder)
    jobs.finish(data_folder, job, JobState.SUCCEEDED)
    with pytest.raises(Conflict, match="nothing to cancel"):
        jobs.cancel(data_folder, job.id)
    assert not jobs.get(data_folder, job.id).is_cancelling
    with pytest.raises(NotFound):
        jobs.cancel(data_folder, "0" * 26)


def test_a_job_is_deleted_with_its_results_once_it_is_over(data_folder: DataFolder) -> None:
    job = claimed(data_folder)
    folder = data_folder.job_folder(job.id)
    folder.mkdir()
    (folder / "result.json").write_text("{}")
    with pytest.raises(Conflict, match="cancel it first"):
        jobs.remove(data_folder, job.id)
    jobs.finish(data_folder, job, JobState.SUCCEEDED)
    jobs.remove(data_folder, job.id)
    assert not folder.exists()
    with pytest.raises(NotFound):
        jobs.remove(data_folder, job.id)


def test_a_lost_job_is_queued_again_but_not_for_ever(data_folder: DataFolder) -> None:
    id = claimed(data_folder).id
    most = MOST_ATTEMPTS_SHARED if data_folder.database.is_shared else MOST_ATTEMPTS
    for attempt in range(1, most):
        jobs.recover(data_folder, jobs.running(data_folder))
        assert jobs.get(data_folder, id).state is JobState.QUEUED
        again = jobs.claim(data_folder, kinds=ALL)
        assert again is not None
        assert again.attempt == attempt + 1
    jobs.recover(data_folder, jobs.running(data_folder))
    lost = jobs.get(data_folder, id)
    assert lost.state is JobState.FAILED
    assert lost.problem is not None
    assert lost.problem["type"] == "urn:stepnc:problem:job-lost"
    assert f"{most} attempts" in lost.problem["detail"]


@pytest.mark.parametrize("kind", [JobKind.TRIAL, JobKind.CONTROL])
def test_a_lost_run_with_people_has_failed_and_says_so(
    data_folder: DataFolder, kind: JobKind
) -> None:
    job = claimed(data_folder, kind)
    jobs.recover(data_folder, jobs.running(data_folder))
    found = jobs.get(data_folder, job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert "live run" in found.problem["detail"]


def test_a_lost_job_that_was_to_end_is_cancelled(data_folder: DataFolder) -> None:
    job = claimed(data_folder)
    jobs.cancel(data_folder, job.id)
    jobs.recover(data_folder, jobs.running(data_folder))
    assert jobs.get(data_folder, job.id).state is JobState.CANCELLED


def test_recovery_leaves_what_waits_and_what_is_over(data_folder: DataFolder) -> None:
    done, waits = claimed(data_folder), queued(data_folder)
    jobs.finish(data_folder, done, JobState.FAILED, problem=jobs.lost("why"))
    jobs.recover(data_folder, jobs.running(data_folder))
    assert jobs.get(data_folder, done.id).state is JobState.FAILED
    assert jobs.get(data_folder, waits.id) == waits


def test_the_queue_has_an_end(data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 2)
    queued(data_folder, owner=LOCAL)
    queued(data_folder, owner=LOCAL)
    with pytest.raises(TooMany):
        queued(data_folder, owner=LOCAL)
    jobs.claim(data_folder, kinds=ALL)
    queued(data_folder, owner=LOCAL)


def test_one_owner_leaves_room_in_the_queue_for_others(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 8)
    for _ in range(2):
        queued(data_folder, owner="anna")
    with pytest.raises(TooMany):
        queued(data_folder, owner="anna")
    assert queued(data_folder, owner="bert").owner == "bert"
    jobs.claim(data_folder, kinds=ALL)
    assert queued(data_folder, owner="anna").owner == "anna"


def test_lists_are_by_kind_state_and_program(data_folder: DataFolder) -> None:
    trial, review = queued(data_folder, JobKind.TRIAL), claimed(data_folder)
    found = jobs.listed(data_folder, PageCursor(), kind=JobKind.TRIAL)
    assert [job.id for job in found.items] == [trial.id]
    found = jobs.listed(data_folder, PageCursor(), state=JobState.RUNNING)
    assert [job.id for job in found.items] == [review.id]
    assert jobs.listed(data_folder, PageCursor(), program="' OR 1=1 --").items == ()


Steps = st.lists(st.sampled_from(["add", "claim", "cancel", "finish", "recover"]), max_size=25)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(Steps)
def test_whatever_happens_what_is_over_stays_over(
    data_folder: DataFolder, steps: list[str]
) -> None:
    over: dict[str, JobState] = {}
    ids, held = [queued(data_folder).id], None
    for step in steps:
        if step == "add":
            ids.append(queued(data_folder).id)
        elif step == "claim":
            held = jobs.claim(data_folder, kinds=ALL) or held
        elif step == "cancel" and jobs.get(data_folder, ids[0]).state not in {
            JobState.SUCCEEDED,
            JobState.FAILED,
        }:
            jobs.cancel(data_folder, ids[0])
        elif step == "finish" and held is not None:
            jobs.finish(data_folder, held, JobState.SUCCEEDED)
        elif step == "recover":
            jobs.recover(data_folder, jobs.running(data_folder))
        now = {id: jobs.get(data_folder, id).state for id in ids}
        assert {id: now[id] for id in over} == over
        over |= {id: state for id, state in now.items() if state.is_finished}
    while (left := jobs.claim(data_folder, kinds=ALL)) is not None:
        jobs.finish(data_folder, left, JobState.CANCELLED)


def test_the_share_of_the_queue_belongs_to_a_key_not_to_its_name(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 2 * jobs.OWNERS)
    one, two = (JobRequest(kind=JobKind.REVIEW, request={}, owner="anna", key=k) for k in "xy")
    for _ in range(2):
        jobs.add(data_folder, one)
    with pytest.raises(TooMany):
        jobs.add(data_folder, one)
    jobs.add(data_folder, two)
