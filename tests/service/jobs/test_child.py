"""The process of one job, here in ours: however it ends, the job says how."""

import logging
import signal
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from service.jobs import child, verb_job
from service.jobs.task import RunningJob
from service.storage import database, jobs, programs
from service.storage.folder import DATABASE, open_data_folder
from service.storage.jobs import Job, JobKind, JobState
from service.web.problem import problem_of
from stepnc_model.errors import StepNcError
from tests.full_disk import files_of_at_most
from tests.service.jobs.conftest import Shop, made_shop
from tests.service.live.room import within_room
from tests.service.rest.samples import SAMPLE
from tests.service.waiting import until


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    """What the process of a job sets for itself, and other tests must not meet."""
    before = {each: signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)}
    compilers = logging.getLogger(child.COMPILERS)
    yield
    for each, handler in before.items():
        signal.signal(each, handler)
    logging.disable(logging.NOTSET)
    compilers.handlers.clear()
    compilers.propagate = True


@pytest.fixture
def idle(tmp_path_factory: pytest.TempPathFactory) -> Shop:
    """Without a runner."""
    return made_shop(tmp_path_factory.mktemp("idle"))


def ran(shop: Shop, job: Job) -> Job:
    claimed = jobs.claim(shop.data_folder, kinds=[job.kind])
    assert claimed is not None
    child.main(shop.data_folder.address, job.id, claimed.attempt)
    return shop.job(job.id)


def upload(shop: Shop, data: bytes) -> str:
    return programs.add(shop.data_folder, data, name="bad.stpnc", owner="anna").id


def test_a_line_that_cannot_be_read_is_named(idle: Shop) -> None:
    job = ran(
        idle, idle.order(JobKind.ADVICE, upload(idle, b"ISO-10303-21;\nHEADER;\nno((;\n"))
    )
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:part21-error"
    assert (job.problem["status"], job.problem["line"]) == (422, 4)


def test_an_entity_that_is_missing_is_named(idle: Shop) -> None:
    lines = SAMPLE.read_bytes().splitlines(keepends=True)
    toolless = b"".join(line for line in lines if b"=MILLING_CUTTING_TOOL(" not in line)
    job = ran(idle, idle.order(JobKind.ADVICE, upload(idle, toolless)))
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:schema-error"
    assert job.problem["entity"] == "#50"


def test_a_workingstep_that_is_not_there_is_named(idle: Shop) -> None:
    job = ran(idle, idle.order(JobKind.ADVICE, workingsteps=["NO SUCH STEP"]))
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert "NO SUCH STEP" in job.problem["detail"]


def test_no_problem_tells_where_the_data_lies(idle: Shop) -> None:
    programs_folder = idle.data_folder.root / "programs"
    (programs_folder / f"{idle.program}.stpnc").unlink()
    for kind in (JobKind.ADVICE, JobKind.SIMULATION, JobKind.CONTROL):
        job = ran(idle, idle.order(kind))
        assert job.state is JobState.FAILED
        assert str(idle.data_folder.root) not in str(job.problem)


def test_a_stored_request_that_is_none_is_named(idle: Shop) -> None:
    job = ran(idle, idle.order(JobKind.ADVICE, mode=None))
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert "mode" in job.problem["detail"]


def test_a_fault_of_the_program_is_no_fault_of_the_client(
    idle: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_task: RunningJob) -> None:
        raise ZeroDivisionError("of the inside")

    monkeypatch.setattr(verb_job, "run", fail)
    job = idle.order(JobKind.ADVICE)
    with pytest.raises(ZeroDivisionError):
        ran(idle, job)
    found = idle.job(job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert (found.problem["status"], found.problem["title"]) == (500, "Fault")
    assert "Traceback" not in str(found.problem)
    assert "of the inside" not in str(found.problem)


def test_an_end_is_said_once_the_database_answers_again(
    idle: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = idle.order(JobKind.SIMULATION)
    claimed = jobs.claim(idle.data_folder)
    assert claimed is not None
    monkeypatch.setattr(database, "WAIT", 0.01)
    data_folder = open_data_folder(idle.data_folder.root, knowledge=idle.data_folder.knowledge)
    other = sqlite3.connect(idle.data_folder.root / DATABASE, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        if len(waits) == 3:
            other.execute("ROLLBACK")

    monkeypatch.setattr(child, "sleep", wait)
    task = RunningJob(data_folder=data_folder, job=claimed)
    # A word of progress is no reason to fail.
    task.progress(0.5, "half")
    child._finish(task, child.JobEnd(state=JobState.SUCCEEDED))
    other.close()
    found = idle.job(job.id)
    assert (found.state, found.message, len(waits)) == (JobState.SUCCEEDED, "", 3)


ON_FULL_DISK = """
from service.jobs import child, verb_job
from service.storage.folder import FolderAddress
child.main(FolderAddress(root=sys.argv[1], knowledge="none.db"), sys.argv[2], 1)
"""


def test_a_job_without_room_says_so_and_frees_what_it_took(idle: Shop) -> None:
    root = idle.data_folder.root
    job = idle.order(JobKind.SIMULATION, rate_hz=1000.0)
    assert jobs.claim(idle.data_folder) is not None
    within_room(ON_FULL_DISK, root, job.id, room=2_000_000)
    found = idle.job(job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert found.problem["status"] == 507
    assert str(root) not in str(found.problem)
    left = {each.name for each in idle.data_folder.job_folder(job.id).iterdir()}
    assert left <= {"status.json"}


def test_a_job_waits_for_room_on_a_full_disk(
    idle: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    idle.order(JobKind.ADVICE)
    claimed = jobs.claim(idle.data_folder)
    assert claimed is not None
    task = RunningJob(data_folder=idle.data_folder, job=claimed)
    waits: list[float] = []
    with ExitStack() as stack:

        def wait(seconds: float) -> None:
            waits.append(seconds)
            stack.close()

        monkeypatch.setattr(child, "sleep", wait)
        stack.enter_context(files_of_at_most(0))
        end = child._end_of(task)
    assert (end.state, waits) == (JobState.SUCCEEDED, [child.UNTIL_ROOM])
    assert (task.folder / "result.json").is_file()


def test_what_another_attempt_left_half_done_is_cleared_away(idle: Shop) -> None:
    job = idle.order(JobKind.ADVICE)
    folder = idle.data_folder.job_folder(job.id)
    folder.mkdir()
    for name in (".samples.parquet.abc", "samples.partial.parquet"):
        (folder / name).write_bytes(b"half")
    assert ran(idle, job).state is JobState.SUCCEEDED
    names = {each.name for each in folder.iterdir()}
    assert "result.json" in names
    assert not [name for name in names if name.startswith(".") or "partial" in name]


def test_a_job_that_was_asked_to_end_is_cancelled(idle: Shop) -> None:
    with pytest.raises(child.Cancelled):
        child._cancel(signal.SIGTERM, None)
    # Told to end before its first line of work.
    job = idle.order(JobKind.SIMULATION, pace=0.5)
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    previous = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGTERM))
    try:
        signal.setitimer(signal.ITIMER_REAL, 2.0)
        found = ran(idle, job)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)
    assert (found.state, found.problem) == (JobState.CANCELLED, None)


class Dropped:
    """Whose destructor is where the request to end comes."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("error", [ZeroDivisionError, StepNcError])
def test_an_error_in_place_of_a_request_to_end_is_no_fault(
    idle: Shop, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
) -> None:
    """Compiled code that is interrupted raises an error of its own."""

    def swallow(_task: RunningJob) -> None:
        try:
            signal.raise_signal(signal.SIGTERM)
        except child.Cancelled:
            raise error("interrupted") from None

    monkeypatch.setattr(verb_job, "run", swallow)
    job = ran(idle, idle.order(JobKind.ADVICE))
    assert (job.state, job.problem) == (JobState.CANCELLED, None)


def test_a_request_to_end_within_a_destructor_is_repeated_where_it_counts() -> None:
    def work() -> None:
        Dropped()
        until(lambda: None, within=20.0)

    with pytest.raises(child.Cancelled), child._cancellable([]):
        work()


def test_a_request_to_end_after_the_end_changes_nothing() -> None:
    with child._cancellable([]):
        """The work of a job."""
    signal.raise_signal(signal.SIGTERM)


def test_a_request_to_end_while_an_error_is_told_is_no_fault(
    idle: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(*words: Any, **named: Any) -> dict[str, Any]:
        signal.raise_signal(signal.SIGTERM)
        return problem_of(*words, **named)

    monkeypatch.setattr("service.jobs.child.problem_of", late)
    found = ran(idle, idle.order(JobKind.ADVICE, workingsteps=["NO SUCH STEP"]))
    assert (found.state, found.problem) == (JobState.CANCELLED, None)
