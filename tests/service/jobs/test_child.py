"""The process of one job, here in ours: however it ends, the job says how."""

import logging
import signal
import sqlite3
from collections.abc import Iterator

import pytest

from service.depot import database, jobs, programs
from service.depot.folder import open_depot
from service.depot.jobs import Job, Kind, State
from service.errors import NotFound
from service.jobs import child
from service.jobs.task import Task
from tests.service.jobs.conftest import Shop, made_shop
from tests.service.live.room import within_room
from tests.service.rest.samples import SAMPLE


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
    assert jobs.claim(shop.depot, kinds=[job.kind]) is not None
    child.main(str(shop.depot.root), shop.depot.knowledge, job.id)
    return shop.job(job.id)


def upload(shop: Shop, data: bytes) -> str:
    return programs.add(shop.depot, data, name="bad.stpnc", owner="anna").id


def test_a_line_that_cannot_be_read_is_named(idle: Shop) -> None:
    job = ran(idle, idle.order(Kind.ADVICE, upload(idle, b"ISO-10303-21;\nHEADER;\nno((;\n")))
    assert job.state is State.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:part21-error"
    assert (job.problem["status"], job.problem["line"]) == (422, 4)


def test_an_entity_that_is_missing_is_named(idle: Shop) -> None:
    lines = SAMPLE.read_bytes().splitlines(keepends=True)
    toolless = b"".join(line for line in lines if b"=MILLING_CUTTING_TOOL(" not in line)
    job = ran(idle, idle.order(Kind.ADVICE, upload(idle, toolless)))
    assert job.state is State.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:schema-error"
    assert job.problem["entity"] == "#50"


def test_a_workingstep_that_is_not_there_is_named(idle: Shop) -> None:
    job = ran(idle, idle.order(Kind.ADVICE, workingsteps=["NO SUCH STEP"]))
    assert job.state is State.FAILED
    assert job.problem is not None
    assert "NO SUCH STEP" in job.problem["detail"]


def test_no_problem_tells_where_the_data_lies(idle: Shop) -> None:
    programs_folder = idle.depot.root / "programs"
    (programs_folder / f"{idle.program}.stpnc").unlink()
    for kind in (Kind.ADVICE, Kind.SIMULATION, Kind.CONTROL):
        job = ran(idle, idle.order(kind))
        assert job.state is State.FAILED
        assert str(idle.depot.root) not in str(job.problem)


def test_a_fault_of_the_program_is_no_fault_of_the_client(idle: Shop) -> None:
    job = idle.order(Kind.ADVICE, mode=None)
    with pytest.raises(Exception, match=r".") as fault:
        ran(idle, job)
    assert not isinstance(fault.value, NotFound)
    found = idle.job(job.id)
    assert found.state is State.FAILED
    assert found.problem is not None
    assert (found.problem["status"], found.problem["title"]) == (500, "Fault")
    assert "Traceback" not in str(found.problem)
    assert str(fault.value) not in found.problem["detail"]


def test_an_end_is_said_once_the_database_answers_again(
    idle: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = idle.order(Kind.SIMULATION)
    claimed = jobs.claim(idle.depot)
    assert claimed is not None
    monkeypatch.setattr(database, "WAIT", 0.01)
    depot = open_depot(idle.depot.root, knowledge=idle.depot.knowledge)
    other = sqlite3.connect(idle.depot.database.file, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        if len(waits) == 3:
            other.execute("ROLLBACK")

    monkeypatch.setattr(child, "sleep", wait)
    task = Task(depot=depot, job=claimed)
    # A word of progress is no reason to fail.
    task.progress(0.5, "half")
    child._finish(task, State.SUCCEEDED, None)
    other.close()
    found = idle.job(job.id)
    assert (found.state, found.message, len(waits)) == (State.SUCCEEDED, "", 3)


ON_FULL_DISK = """
from service.jobs import child
child.main(sys.argv[1], "none.db", sys.argv[2])
"""


def test_a_job_without_room_says_so_and_frees_what_it_took(idle: Shop) -> None:
    root = idle.depot.root
    job = idle.order(Kind.SIMULATION, rate_hz=1000.0)
    assert jobs.claim(idle.depot) is not None
    within_room(ON_FULL_DISK, root, job.id, room=2_000_000)
    found = idle.job(job.id)
    assert found.state is State.FAILED
    assert found.problem is not None
    assert found.problem["status"] == 507
    assert str(root) not in str(found.problem)
    left = {each.name for each in idle.depot.job_folder(job.id).iterdir()}
    assert left <= {"status.json"}


def test_what_another_attempt_left_half_done_is_cleared_away(idle: Shop) -> None:
    job = idle.order(Kind.ADVICE)
    folder = idle.depot.job_folder(job.id)
    folder.mkdir()
    for name in (".samples.parquet.abc", "samples.partial.parquet"):
        (folder / name).write_bytes(b"half")
    assert ran(idle, job).state is State.SUCCEEDED
    names = {each.name for each in folder.iterdir()}
    assert "result.json" in names
    assert not [name for name in names if name.startswith(".") or "partial" in name]


def test_a_job_that_was_asked_to_end_is_cancelled(idle: Shop) -> None:
    with pytest.raises(child.Cancelled):
        child._cancel(signal.SIGTERM, None)
    # Told to end before its first line of work.
    job = idle.order(Kind.SIMULATION, pace=0.5)
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    previous = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGTERM))
    try:
        signal.setitimer(signal.ITIMER_REAL, 2.0)
        found = ran(idle, job)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)
    assert (found.state, found.problem) == (State.CANCELLED, None)
