"""An ``Idempotency-Key``: the same request makes nothing twice, another one is refused."""

import sys
from subprocess import PIPE, Popen

import pytest

from service.errors import Conflict
from service.storage import jobs, programs
from service.storage.folder import DataFolder
from service.storage.idempotency import KEPT, IdempotencyKey, made_before
from service.storage.jobs import JobKind, JobRequest
from service.storage.pages import PageCursor

ORDER = JobRequest(kind=JobKind.REVIEW, request={}, owner="anna")


def key(key: str = "k", fingerprint: str = "f", owner: str = "anna") -> IdempotencyKey:
    return IdempotencyKey(owner=owner, key=key, fingerprint=fingerprint)


def test_the_same_request_gets_the_same_and_leaves_no_second_file(
    data_folder: DataFolder,
) -> None:
    first = programs.add(data_folder, b"bytes", name="a.stpnc", owner="anna", idempotency=key())
    again = programs.add(data_folder, b"bytes", name="a.stpnc", owner="anna", idempotency=key())
    assert again == first
    assert len(list((data_folder.root / "programs").iterdir())) == 1
    assert jobs.add(data_folder, ORDER, idempotency=key("j")) == jobs.add(
        data_folder, ORDER, idempotency=key("j")
    )


def test_another_request_with_the_same_key_is_refused_and_makes_nothing(
    data_folder: DataFolder,
) -> None:
    programs.add(data_folder, b"bytes", name="a.stpnc", owner="anna", idempotency=key())
    with pytest.raises(Conflict, match="Idempotency-Key 'k'"):
        programs.add(
            data_folder,
            b"other",
            name="a.stpnc",
            owner="anna",
            idempotency=key(fingerprint="g"),
        )
    with pytest.raises(Conflict):
        jobs.add(data_folder, ORDER, idempotency=key(fingerprint="g"))
    assert len(list((data_folder.root / "programs").iterdir())) == 1
    assert len(jobs.listed(data_folder, PageCursor()).items) == 0


def test_keys_are_their_owners(data_folder: DataFolder) -> None:
    one = jobs.add(data_folder, ORDER, idempotency=key())
    other = jobs.add(data_folder, ORDER, idempotency=key(owner="bert", fingerprint="g"))
    assert one.id != other.id


def test_without_a_key_each_request_makes_one_more(data_folder: DataFolder) -> None:
    assert jobs.add(data_folder, ORDER).id != jobs.add(data_folder, ORDER).id


def test_a_key_is_free_again_after_a_day(data_folder: DataFolder) -> None:
    first = jobs.add(data_folder, ORDER, idempotency=key())
    with data_folder.database.writing() as connection:
        connection.execute("UPDATE requests SET created = created - ?", (KEPT + 1.0,))
    assert jobs.add(data_folder, ORDER, idempotency=key()).id != first.id


def test_what_was_deleted_is_not_made_again_and_said(data_folder: DataFolder) -> None:
    program = programs.add(
        data_folder, b"bytes", name="a.stpnc", owner="anna", idempotency=key()
    )
    programs.remove(data_folder, program.id)
    with pytest.raises(Conflict, match="what this request created was deleted"):
        programs.add(data_folder, b"bytes", name="a.stpnc", owner="anna", idempotency=key())
    assert list((data_folder.root / "programs").iterdir()) == []
    job = jobs.add(data_folder, ORDER, idempotency=key("j"))
    jobs.cancel(data_folder, job.id)
    jobs.remove(data_folder, job.id)
    with pytest.raises(Conflict, match="what this request created was deleted"):
        jobs.add(data_folder, ORDER, idempotency=key("j"))
    with pytest.raises(Conflict, match="was used for another request"):
        jobs.add(data_folder, ORDER, idempotency=key("j", fingerprint="g"))


def test_a_key_is_looked_up_without_a_turn_to_write(data_folder: DataFolder) -> None:
    first = jobs.add(data_folder, ORDER, idempotency=key())
    with data_folder.database.reading() as connection:
        assert made_before(connection, key()) == first.id
        assert made_before(connection, key("other")) is None
        assert made_before(connection, None) is None


def test_a_job_that_could_not_be_queued_keeps_no_key(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 0)
    with pytest.raises(Exception, match="too many requests"):
        jobs.add(data_folder, ORDER, idempotency=key())
    monkeypatch.undo()
    assert jobs.add(data_folder, ORDER, idempotency=key()).state is jobs.JobState.QUEUED


ASKED_AT_ONCE = """
import sys
from pathlib import Path
from service.storage import jobs, programs
from service.storage.folder import open_data_folder
from service.storage.jobs import JobKind, JobRequest
from service.storage.idempotency import IdempotencyKey
data_folder = open_data_folder(Path(sys.argv[1]), database=sys.argv[2])
print("ready", flush=True)
sys.stdin.read(1)
for number in range(20):
    asked = IdempotencyKey(owner="anna", key=f"p{number}", fingerprint="f")
    added = programs.add(data_folder, b"x", name="a.stpnc", owner="anna", idempotency=asked)
    print(added.id)
    asked = IdempotencyKey(owner="anna", key=f"j{number}", fingerprint="f")
    order = JobRequest(kind=JobKind.REVIEW, request={}, owner="anna")
    print(jobs.add(data_folder, order, idempotency=asked).id)
"""


def test_the_same_keys_from_two_processes_at_once_make_one_program_and_one_job_each(
    data_folder: DataFolder,
) -> None:
    address = data_folder.address
    command = [sys.executable, "-c", ASKED_AT_ONCE, address.root, address.database]
    askers = [Popen(command, stdin=PIPE, stdout=PIPE, text=True) for _ in range(2)]
    for asker in askers:
        assert asker.stdout is not None
        assert asker.stdout.readline() == "ready\n"
    answers = []
    for asker in askers:
        assert asker.stdin is not None
        asker.stdin.write("!")
        asker.stdin.flush()
    for asker in askers:
        out, _ = asker.communicate(timeout=120.0)
        assert asker.returncode == 0
        answers.append(out.split())
    assert answers[0] == answers[1]
    assert len(set(answers[0])) == 40
    assert len(list((data_folder.root / "programs").iterdir())) == 20
    assert len(programs.listed(data_folder, PageCursor(limit=100)).items) == 20
    assert len(jobs.listed(data_folder, PageCursor(limit=100)).items) == 20
