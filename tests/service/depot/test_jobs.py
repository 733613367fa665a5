"""Jobs: each is claimed once, what a stale attempt says is not written, none is forgotten."""

import sys
from subprocess import PIPE, Popen

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.depot import jobs
from service.depot.folder import Depot
from service.depot.jobs import LOCAL, MOST_ATTEMPTS, Job, Kind, Order, State
from service.depot.pages import Place
from service.errors import Conflict, NotFound, TooMany

ALL = tuple(Kind)
REVIEW = Order(kind=Kind.REVIEW, request={"a": [1, None, "é"]}, owner="anna")


def queued(depot: Depot, kind: Kind = Kind.REVIEW, *, owner: str = "anna") -> Job:
    return jobs.add(depot, Order(kind=kind, request={}, owner=owner))


def claimed(depot: Depot, kind: Kind = Kind.REVIEW) -> Job:
    id = queued(depot, kind).id
    job = jobs.claim(depot, kinds=[kind])
    assert job is not None
    assert job.id == id
    return job


def test_a_job_is_asked_for_claimed_and_finished(depot: Depot) -> None:
    job = jobs.add(depot, REVIEW)
    assert (job.state, job.attempt, job.request) == (State.QUEUED, 0, REVIEW.request)
    running = jobs.claim(depot, kinds=ALL)
    assert running is not None
    assert (running.id, running.state, running.attempt) == (job.id, State.RUNNING, 1)
    jobs.tell(depot, running, share=0.5, message="half")
    told = jobs.get(depot, job.id)
    assert (told.share, told.message, told.started is None) == (0.5, "half", False)
    jobs.finish(depot, running, State.SUCCEEDED)
    done = jobs.get(depot, job.id, Kind.REVIEW)
    assert (done.state, done.share, done.problem) == (State.SUCCEEDED, 1.0, None)
    assert done.ended is not None
    assert jobs.claim(depot, kinds=ALL) is None


def test_the_oldest_of_the_wanted_kinds_comes_first(depot: Depot) -> None:
    made = sorted(queued(depot).id for _ in range(4))
    queued(depot, Kind.TRIAL)
    assert jobs.claim(depot, kinds=[]) is None
    found = [jobs.claim(depot, kinds=[Kind.REVIEW, Kind.ADVICE]) for _ in range(5)]
    assert [each and each.id for each in found] == [*made, None]


def test_jobs_that_wait_for_the_clock_are_told_from_those_that_work(depot: Depot) -> None:
    def add(kind: Kind, **request: object) -> str:
        return jobs.add(depot, Order(kind=kind, request=request, owner="anna")).id

    paced = {
        add(Kind.SIMULATION, pace=0.5), add(Kind.TRIAL, pace=1), add(Kind.CONTROL, pace=0.0)
    }  # fmt: skip
    plain = {
        add(Kind.SIMULATION, pace=0.0), add(Kind.SIMULATION), add(Kind.ADVICE),
        add(Kind.REVIEW),
    }  # fmt: skip
    for wanted, is_paced in ((plain, False), (paced, True)):
        found = [jobs.claim(depot, is_paced=is_paced) for _ in range(len(wanted) + 1)]
        assert found[-1] is None
        assert {job.id for job in found if job} == wanted
        assert {job.is_paced for job in found if job} == {is_paced}


def test_a_kind_is_told_from_another(depot: Depot) -> None:
    job = queued(depot, Kind.TRIAL)
    with pytest.raises(NotFound, match="there is no control-run"):
        jobs.get(depot, job.id, Kind.CONTROL)
    with pytest.raises(NotFound, match="there is no job"):
        jobs.get(depot, "../etc")


CLAIMER = """
import sys
from pathlib import Path
from service.depot import jobs
from service.depot.folder import open_depot
depot = open_depot(Path(sys.argv[1]))
print("ready", flush=True)
sys.stdin.read(1)
while (job := jobs.claim(depot, kinds=list(jobs.Kind))) is not None:
    print(job.id)
"""


def test_processes_that_claim_at_once_get_each_job_once(depot: Depot) -> None:
    made = {queued(depot).id for _ in range(60)}
    command = [sys.executable, "-c", CLAIMER, str(depot.root)]
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
        out, _ = claimer.communicate(timeout=60.0)
        assert claimer.returncode == 0
        found += out.split()
    assert len(found) == 60
    assert set(found) == made
    assert {job.attempt for job in jobs.running(depot)} == {1}


def test_a_stale_attempt_writes_nothing(depot: Depot) -> None:
    stale = claimed(depot)
    jobs.recover(depot)
    fresh = jobs.claim(depot, kinds=ALL)
    assert fresh is not None
    assert (fresh.id, fresh.attempt) == (stale.id, 2)
    jobs.tell(depot, stale, share=0.9, message="of the dead")
    jobs.finish(depot, stale, State.FAILED, problem={"title": "of the dead"})
    now = jobs.get(depot, stale.id)
    assert (now.state, now.share, now.message, now.problem) == (State.RUNNING, 0.0, "", None)
    jobs.finish(depot, fresh, State.SUCCEEDED)
    assert jobs.get(depot, stale.id).state is State.SUCCEEDED


def test_the_first_end_of_a_job_is_its_end(depot: Depot) -> None:
    job = claimed(depot)
    jobs.finish(depot, job, State.SUCCEEDED)
    jobs.finish(depot, job, State.FAILED, problem=jobs.lost("late"))
    jobs.tell(depot, job, share=0.1, message="late")
    done = jobs.get(depot, job.id)
    assert (done.state, done.problem, done.share) == (State.SUCCEEDED, None, 1.0)


def test_one_that_waits_is_cancelled_at_once_and_never_claimed(depot: Depot) -> None:
    job = queued(depot)
    assert jobs.cancel(depot, job.id).state is State.CANCELLED
    assert jobs.cancel(depot, job.id).state is State.CANCELLED
    assert jobs.claim(depot, kinds=ALL) is None


def test_one_that_runs_is_asked_to_end(depot: Depot) -> None:
    job = claimed(depot)
    found = jobs.cancel(depot, job.id)
    assert (found.state, found.is_cancelling) == (State.RUNNING, True)
    jobs.finish(depot, job, State.CANCELLED)
    assert jobs.get(depot, job.id).state is State.CANCELLED


def test_what_is_over_is_not_cancelled(depot: Depot) -> None:
    job = claimed(depot)
    jobs.finish(depot, job, State.SUCCEEDED)
    with pytest.raises(Conflict, match="nothing to cancel"):
        jobs.cancel(depot, job.id)
    assert not jobs.get(depot, job.id).is_cancelling
    with pytest.raises(NotFound):
        jobs.cancel(depot, "0" * 26)


def test_a_job_is_deleted_with_its_results_once_it_is_over(depot: Depot) -> None:
    job = claimed(depot)
    folder = depot.job_folder(job.id)
    folder.mkdir()
    (folder / "result.json").write_text("{}")
    with pytest.raises(Conflict, match="cancel it first"):
        jobs.remove(depot, job.id)
    jobs.finish(depot, job, State.SUCCEEDED)
    jobs.remove(depot, job.id)
    assert not folder.exists()
    with pytest.raises(NotFound):
        jobs.remove(depot, job.id)


def test_a_lost_job_is_queued_again_but_not_for_ever(depot: Depot) -> None:
    id = claimed(depot).id
    for attempt in range(1, MOST_ATTEMPTS):
        jobs.recover(depot)
        assert jobs.get(depot, id).state is State.QUEUED
        again = jobs.claim(depot, kinds=ALL)
        assert again is not None
        assert again.attempt == attempt + 1
    jobs.recover(depot)
    lost = jobs.get(depot, id)
    assert lost.state is State.FAILED
    assert lost.problem is not None
    assert lost.problem["type"] == "urn:stepnc:problem:job-lost"
    assert "3 attempts" in lost.problem["detail"]


@pytest.mark.parametrize("kind", [Kind.TRIAL, Kind.CONTROL])
def test_a_lost_run_with_people_has_failed_and_says_so(depot: Depot, kind: Kind) -> None:
    job = claimed(depot, kind)
    jobs.recover(depot)
    found = jobs.get(depot, job.id)
    assert found.state is State.FAILED
    assert found.problem is not None
    assert "people" in found.problem["detail"]


def test_a_lost_job_that_was_to_end_is_cancelled(depot: Depot) -> None:
    job = claimed(depot)
    jobs.cancel(depot, job.id)
    jobs.recover(depot)
    assert jobs.get(depot, job.id).state is State.CANCELLED


def test_recovery_leaves_what_waits_and_what_is_over(depot: Depot) -> None:
    done, waits = claimed(depot), queued(depot)
    jobs.finish(depot, done, State.FAILED, problem=jobs.lost("why"))
    jobs.recover(depot)
    assert jobs.get(depot, done.id).state is State.FAILED
    assert jobs.get(depot, waits.id) == waits


def test_the_queue_has_an_end(depot: Depot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 2)
    queued(depot, owner=LOCAL)
    queued(depot, owner=LOCAL)
    with pytest.raises(TooMany):
        queued(depot, owner=LOCAL)
    jobs.claim(depot, kinds=ALL)
    queued(depot, owner=LOCAL)


def test_one_owner_leaves_room_in_the_queue_for_others(
    depot: Depot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 8)
    for _ in range(2):
        queued(depot, owner="anna")
    with pytest.raises(TooMany):
        queued(depot, owner="anna")
    assert queued(depot, owner="bert").owner == "bert"
    jobs.claim(depot, kinds=ALL)
    assert queued(depot, owner="anna").owner == "anna"


def test_lists_are_by_kind_state_and_program(depot: Depot) -> None:
    trial, review = queued(depot, Kind.TRIAL), claimed(depot)
    found = jobs.listed(depot, Place(), kind=Kind.TRIAL)
    assert [job.id for job in found.items] == [trial.id]
    found = jobs.listed(depot, Place(), state=State.RUNNING)
    assert [job.id for job in found.items] == [review.id]
    assert jobs.listed(depot, Place(), program="' OR 1=1 --").items == ()


Steps = st.lists(st.sampled_from(["add", "claim", "cancel", "finish", "recover"]), max_size=25)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(Steps)
def test_whatever_happens_what_is_over_stays_over(depot: Depot, steps: list[str]) -> None:
    over: dict[str, State] = {}
    ids, held = [queued(depot).id], None
    for step in steps:
        if step == "add":
            ids.append(queued(depot).id)
        elif step == "claim":
            held = jobs.claim(depot, kinds=ALL) or held
        elif step == "cancel" and jobs.get(depot, ids[0]).state not in {
            State.SUCCEEDED,
            State.FAILED,
        }:
            jobs.cancel(depot, ids[0])
        elif step == "finish" and held is not None:
            jobs.finish(depot, held, State.SUCCEEDED)
        elif step == "recover":
            jobs.recover(depot)
        now = {id: jobs.get(depot, id).state for id in ids}
        assert {id: now[id] for id in over} == over
        over |= {id: state for id, state in now.items() if state.is_over}
    while (left := jobs.claim(depot, kinds=ALL)) is not None:
        jobs.finish(depot, left, State.CANCELLED)
