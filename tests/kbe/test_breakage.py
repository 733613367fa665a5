"""Disks fill up, files are damaged, servers stop: what then."""

import hashlib
import os
import pickle
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import psycopg
import pytest
from sqlalchemy import URL, make_url

from kbe.errors import (
    KnowledgeError,
    StoreDamaged,
    StoreReadOnly,
    StoreUnavailable,
)
from kbe.store import open_store
from stepnc_model.outcome import ProcessOutcome
from tests.rights import Capability, without

OutcomeMaker = Callable[..., list[ProcessOutcome]]
UrlMaker = Callable[[], str]

FILLER = """
import os, pickle, resource, sys
sys.dont_write_bytecode = True
from contextlib import closing
from pathlib import Path
from kbe.errors import StoreFull
from kbe.store import open_store

outcomes = pickle.load(sys.stdin.buffer)
path, how = sys.argv[1:]
ballast = Path(path).with_name("ballast")


def fill_disk():
    if how == "limit":
        resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, resource.RLIM_INFINITY))
    else:
        ballast.write_bytes(bytes(600_000))


def make_room():
    if how == "limit":
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    else:
        ballast.unlink()


with open_store(path) as store:
    fill_disk()
    accepted = 0
    try:
        for first in range(0, len(outcomes), 10):
            store.add(outcomes[first : first + 10])
            accepted += 10
    except StoreFull as error:
        assert "Free some space" in str(error)
    assert 0 < accepted < len(outcomes), accepted
    assert list(store.outcomes()) == outcomes[:accepted]
    store.check()
    make_room()
    store.add([outcomes[accepted]])
with open_store(path) as store:
    assert list(store.outcomes()) == outcomes[: accepted + 1]
    store.check()
print("survived", flush=True)
"""


def filled(command: list[str], outcomes: list[ProcessOutcome]) -> str:
    done = subprocess.run(
        command, input=pickle.dumps(outcomes), capture_output=True, timeout=120.0, check=False
    )
    return (done.stdout + done.stderr).decode()


def test_file_that_may_not_grow_keeps_what_was_accepted(
    tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    command = [sys.executable, "-c", FILLER, str(tmp_path / "kbe.db"), "limit"]
    assert filled(command, outcomes(600)) == "survived\n"


def test_full_disk_keeps_what_was_accepted(tmp_path: Path, outcomes: OutcomeMaker) -> None:
    """A disk of 1 MiB of our own, that nobody else sees and that goes with its program."""
    mount = f"mount -t tmpfs -o size=1m tmpfs '{tmp_path}'"
    trial = subprocess.run(
        ["unshare", "--mount", "sh", "-c", mount],
        capture_output=True,
        check=False,
        timeout=120.0,
    )
    if trial.returncode:
        pytest.skip(f"may not mount: {trial.stderr.decode().strip()}")
    fill = f'{mount} && exec "$@"'
    python = [sys.executable, "-c", FILLER, str(tmp_path / "kbe.db"), "disk"]
    command = ["unshare", "--mount", "sh", "-c", fill, "sh", *python]
    assert filled(command, outcomes(2000)) == "survived\n"


@pytest.fixture
def file(sqlite_place: UrlMaker, outcomes: OutcomeMaker) -> Path:
    name = sqlite_place()
    with open_store(name) as store:
        store.add(outcomes(1000))
    return Path(name)


def digest(folder: Path) -> list[tuple[str, bytes]]:
    return sorted(
        (path.name, hashlib.sha256(path.read_bytes()).digest()) for path in folder.iterdir()
    )


def use(file: Path, outcomes: list[ProcessOutcome]) -> None:
    """Whatever one does with a store first."""
    with open_store(str(file)) as store:
        store.check()
        store.add(outcomes)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 0.9])
def test_overwritten_bytes_are_found_and_left(
    file: Path, outcomes: OutcomeMaker, share: float
) -> None:
    with file.open("r+b") as damaged:
        damaged.seek(int(share * file.stat().st_size) // 4096 * 4096)
        damaged.write(b"\xa5" * 8192)
    before = digest(file.parent)
    with pytest.raises(StoreDamaged, match="restore a backup") as caught:
        use(file, outcomes(1))
    assert caught.value.place == str(file)
    assert digest(file.parent) == before


@pytest.mark.parametrize("share", [0.01, 0.5, 0.999])
def test_truncated_file_is_found_and_left(
    file: Path, outcomes: OutcomeMaker, share: float
) -> None:
    os.truncate(file, int(share * file.stat().st_size))
    before = digest(file.parent)
    with pytest.raises(StoreDamaged, match="restore a backup"):
        use(file, outcomes(1))
    assert digest(file.parent) == before


def test_decision_without_its_correction_is_found(file: Path) -> None:
    """Another program need not keep foreign keys."""
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute(
            "INSERT INTO decision VALUES (1, 99, 'accepted', 'Eve', '2026-01-01 00:00:00')"
        )
    with open_store(str(file)) as store, pytest.raises(StoreDamaged, match="decision"):
        store.check()


def test_file_of_something_else_is_left(tmp_path: Path) -> None:
    letter = tmp_path / "letter.txt"
    letter.write_text("Dear Ann, " * 500, encoding="utf-8")
    before = digest(tmp_path)
    with pytest.raises(StoreDamaged, match="not a knowledge base"):
        open_store(str(letter))
    assert digest(tmp_path) == before


def test_read_only_file_is_read_and_not_written(file: Path, outcomes: OutcomeMaker) -> None:
    file.chmod(0o444)
    with without(Capability.DAC_OVERRIDE), open_store(str(file)) as store:
        assert store.count() == 1000
        with pytest.raises(StoreReadOnly, match="allow this user"):
            store.add(outcomes(1))


def test_folder_that_may_not_be_written(file: Path, outcomes: OutcomeMaker) -> None:
    file.parent.chmod(0o555)
    with without(Capability.DAC_OVERRIDE):
        with pytest.raises(StoreUnavailable, match="allow this user to write"):
            open_store(str(file.with_name("new.db")))
        with pytest.raises(KnowledgeError, match="allow this user to write"):
            use(file, outcomes(1))


def test_server_that_crashes_keeps_what_was_accepted(
    request: pytest.FixtureRequest, outcomes: OutcomeMaker
) -> None:
    """The server is stopped as by a power cut; the store that was open goes on afterwards."""
    server = request.getfixturevalue("new_server")()
    kept = outcomes(20)
    with open_store(server.url) as store:
        for outcome in kept:
            store.add([outcome])
        server.stop("immediate")
        with pytest.raises(StoreUnavailable, match="check that it runs"):
            store.add(kept)
        with pytest.raises(StoreUnavailable, match="check that it runs"):
            open_store(server.url)
        server.start()
        assert list(store.outcomes()) == kept
        store.add(outcomes(1, run="after"))
        assert store.count() == 21


def shown(url: URL) -> str:
    """The whole address."""
    return url.render_as_string(hide_password=False)


def test_database_that_is_not_there(postgres_url: str) -> None:
    with pytest.raises(StoreUnavailable, match="nowhere"):
        open_store(shown(make_url(postgres_url).set(database="nowhere")))


GUEST = f"guest_{os.getpid()}"
"""a role belongs to the whole server, which others may use as well"""


@pytest.fixture
def guest(postgres_url: str) -> Iterator[psycopg.Connection]:
    """Somebody who has no rights yet, and a connection that may grant them."""
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        connection.execute(f"CREATE ROLE {GUEST} LOGIN PASSWORD 'guest'")
        try:
            yield connection
        finally:
            connection.execute(f"DROP OWNED BY {GUEST}")
            connection.execute(f"DROP ROLE {GUEST}")


def test_rights_that_were_not_granted(
    guest: psycopg.Connection, postgres_place: UrlMaker, outcomes: OutcomeMaker
) -> None:
    url = postgres_place()
    with open_store(url) as store:
        store.add(outcomes(2))
    as_guest = shown(make_url(url).set(username=GUEST, password="guest"))
    with pytest.raises(StoreUnavailable, match="its rights"):
        open_store(as_guest)
    schema = url.rpartition("%3D")[2]
    guest.execute(f"GRANT USAGE ON SCHEMA {schema} TO {GUEST}")
    with pytest.raises(StoreReadOnly, match="grant the rights"):
        open_store(as_guest)
    guest.execute(f"GRANT SELECT ON ALL TABLES IN SCHEMA {schema} TO {GUEST}")
    with open_store(as_guest) as store:
        assert list(store.outcomes()) == outcomes(2)
        with pytest.raises(StoreReadOnly, match="grant the rights"):
            store.add(outcomes(1))
