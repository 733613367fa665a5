"""An ``Idempotency-Key``: the same request makes nothing twice, another one is refused."""

import sys
from subprocess import PIPE, Popen

import pytest

from service.depot import jobs, programs
from service.depot.folder import Depot
from service.depot.jobs import Kind, Order
from service.depot.once import KEPT, Once, made_before
from service.depot.pages import Place
from service.errors import Conflict

ORDER = Order(kind=Kind.REVIEW, request={}, owner="anna")


def once(key: str = "k", fingerprint: str = "f", owner: str = "anna") -> Once:
    return Once(owner=owner, key=key, fingerprint=fingerprint)


def test_the_same_request_gets_the_same_and_leaves_no_second_file(depot: Depot) -> None:
    first = programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once())
    again = programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once())
    assert again == first
    assert len(list((depot.root / "programs").iterdir())) == 1
    assert jobs.add(depot, ORDER, once=once("j")) == jobs.add(depot, ORDER, once=once("j"))


def test_another_request_with_the_same_key_is_refused_and_makes_nothing(depot: Depot) -> None:
    programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once())
    with pytest.raises(Conflict, match="Idempotency-Key 'k'"):
        programs.add(depot, b"other", name="a.stpnc", owner="anna", once=once(fingerprint="g"))
    with pytest.raises(Conflict):
        jobs.add(depot, ORDER, once=once(fingerprint="g"))
    assert len(list((depot.root / "programs").iterdir())) == 1
    assert len(jobs.listed(depot, Place()).items) == 0


def test_keys_are_their_owners(depot: Depot) -> None:
    one = jobs.add(depot, ORDER, once=once())
    other = jobs.add(depot, ORDER, once=once(owner="bert", fingerprint="g"))
    assert one.id != other.id


def test_without_a_key_each_request_makes_one_more(depot: Depot) -> None:
    assert jobs.add(depot, ORDER).id != jobs.add(depot, ORDER).id


def test_a_key_is_free_again_after_a_day(depot: Depot) -> None:
    first = jobs.add(depot, ORDER, once=once())
    with depot.database.writing() as connection:
        connection.execute("UPDATE requests SET created = created - ?", (KEPT + 1.0,))
    assert jobs.add(depot, ORDER, once=once()).id != first.id


def test_what_was_deleted_is_not_made_again_and_said(depot: Depot) -> None:
    program = programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once())
    programs.remove(depot, program.id)
    with pytest.raises(Conflict, match="what this request made was deleted"):
        programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once())
    assert list((depot.root / "programs").iterdir()) == []
    job = jobs.add(depot, ORDER, once=once("j"))
    jobs.cancel(depot, job.id)
    jobs.remove(depot, job.id)
    with pytest.raises(Conflict, match="what this request made was deleted"):
        jobs.add(depot, ORDER, once=once("j"))
    with pytest.raises(Conflict, match="came with another request"):
        jobs.add(depot, ORDER, once=once("j", fingerprint="g"))


def test_a_key_is_looked_up_without_a_turn_to_write(depot: Depot) -> None:
    first = jobs.add(depot, ORDER, once=once())
    with depot.database.reading() as connection:
        assert made_before(connection, once()) == first.id
        assert made_before(connection, once("other")) is None
        assert made_before(connection, None) is None


def test_a_job_that_could_not_be_queued_keeps_no_key(
    depot: Depot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "MOST_WAITING", 0)
    with pytest.raises(Exception, match="too many requests"):
        jobs.add(depot, ORDER, once=once())
    monkeypatch.undo()
    assert jobs.add(depot, ORDER, once=once()).state is jobs.State.QUEUED


ASKED_AT_ONCE = """
import sys
from pathlib import Path
from service.depot import jobs, programs
from service.depot.folder import open_depot
from service.depot.jobs import Kind, Order
from service.depot.once import Once
depot = open_depot(Path(sys.argv[1]))
print("ready", flush=True)
sys.stdin.read(1)
for number in range(20):
    once = Once(owner="anna", key=f"p{number}", fingerprint="f")
    print(programs.add(depot, b"bytes", name="a.stpnc", owner="anna", once=once).id)
    once = Once(owner="anna", key=f"j{number}", fingerprint="f")
    order = Order(kind=Kind.REVIEW, request={}, owner="anna")
    print(jobs.add(depot, order, once=once).id)
"""


def test_the_same_keys_from_two_processes_at_once_make_one_program_and_one_job_each(
    depot: Depot,
) -> None:
    command = [sys.executable, "-c", ASKED_AT_ONCE, str(depot.root)]
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
        out, _ = asker.communicate(timeout=60.0)
        assert asker.returncode == 0
        answers.append(out.split())
    assert answers[0] == answers[1]
    assert len(set(answers[0])) == 40
    assert len(list((depot.root / "programs").iterdir())) == 20
    assert len(programs.listed(depot, Place(limit=100)).items) == 20
    assert len(jobs.listed(depot, Place(limit=100)).items) == 20
