"""A private PostgreSQL server for tests of the knowledge base and of the service."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Protocol
from urllib.parse import quote

import psycopg
import pytest
from sqlalchemy.engine import make_url

AUDIT = """
CREATE TABLE stepnc_service.ends (id TEXT, state TEXT, attempt BIGINT);
CREATE FUNCTION stepnc_service.record_end() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  INSERT INTO stepnc_service.ends VALUES (NEW.id, NEW.state, NEW.attempt);
  RETURN NULL;
END $$;
CREATE TRIGGER ends AFTER UPDATE ON stepnc_service.jobs FOR EACH ROW
WHEN (OLD.state <> NEW.state AND NEW.state NOT IN ('queued', 'running'))
EXECUTE FUNCTION stepnc_service.record_end()
"""
"""The database itself counts how often each job has ended."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Server:
    """A PostgreSQL server of our own: no network, only a socket in its own folder."""

    programs: Path
    folder: Path
    user: str
    """that it runs as; empty: as who we are"""

    @property
    def url(self) -> str:
        return f"postgresql://postgres@/postgres?host={quote(str(self.folder), safe='')}"

    def run(self, program: str, *arguments: str) -> None:
        subprocess.run(
            [self.programs / program, "-D", self.folder / "data", *arguments],
            check=True,
            cwd=self.folder,
            user=self.user or None,
            group=self.user or None,
            extra_groups=[] if self.user else None,
            stdout=subprocess.DEVNULL,
            timeout=120.0,
        )

    def start(self) -> None:
        # Truncated to the socket; what is committed is on the disk.
        options = f"-c listen_addresses='' -k {self.folder} -c fsync=on"
        self.run("pg_ctl", "start", "-w", "-l", str(self.folder / "log"), "-o", options)

    def stop(self, mode: str) -> None:
        """``fast``, or ``immediate`` as when it crashes."""
        self.run("pg_ctl", "stop", "-w", "-m", mode)


@pytest.fixture(scope="session")
def new_server() -> Iterator["ServerMaker"]:
    """Makes servers, which run until the tests end."""
    servers: list[Server] = []

    def make() -> Server:
        server = started_server()
        servers.append(server)
        return server

    yield make
    for server in servers:
        server.stop("fast")
        shutil.rmtree(server.folder)


class ServerMaker(Protocol):
    """Makes a server, or skips the test."""

    def __call__(self) -> Server: ...


def started_server() -> Server:
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    if not found:
        pytest.skip("no PostgreSQL: set STEPNC_TEST_POSTGRES or apt-get install postgresql")
    # A server refuses to run as root; the name of a socket may have 107 letters at most.
    folder = Path(tempfile.mkdtemp(prefix="stepnc-pg-", dir="/tmp"))
    user = "postgres" if os.geteuid() == 0 else ""
    if user:
        shutil.chown(folder, user, user)
    server = Server(programs=found[-1].parent, folder=folder, user=user)
    try:
        server.run(
            "initdb", "--no-sync", "--auth=trust", "--username=postgres", "--encoding=UTF8",
            "--locale=C",
        )  # fmt: skip
        server.start()
    except BaseException:
        shutil.rmtree(folder)
        raise
    return server


@pytest.fixture(scope="session")
def postgres_url(request: pytest.FixtureRequest) -> str:
    """A database that tests may make schemas in."""
    given = os.environ.get("STEPNC_TEST_POSTGRES", "")
    if given:
        return given
    new_server: ServerMaker = request.getfixturevalue("new_server")
    return new_server().url


NAMES = count()


@pytest.fixture
def new_database(postgres_url: str) -> Iterator[str]:
    """Address of a database without tables, which is dropped at the end."""
    name = f"test_{os.getpid()}_{next(NAMES)}"
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        connection.execute(f"CREATE DATABASE {name}".encode())
    place = make_url(postgres_url).set(database=name)
    yield place.render_as_string(hide_password=False)
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        connection.execute(f"DROP DATABASE {name} WITH (FORCE)".encode())
