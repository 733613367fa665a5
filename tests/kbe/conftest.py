"""Outcomes made by hand, and stores in SQLite and in a private PostgreSQL server."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from itertools import count
from pathlib import Path
from typing import Protocol
from urllib.parse import quote

import psycopg
import pytest

from kbe.store import Store, open_store
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    LearnedCorrection,
    ProcessOutcome,
)

NOON = datetime(2026, 3, 5, 12, 0, tzinfo=UTC)

POCKET = ProcessOutcome(
    context=Context(machine="vmc15", material="C45", tool="endmill 16"),
    program="part.stpnc",
    workingstep="WS ROUGH POCKET",
    feature=FeatureFacts(id="POCKET1", kind="closed_pocket", length=80.0, width=50.0),
    is_finishing=False,
    mode="TC",
    specific_force=1700.0,
    cutting_speed=3000.0,
    step_depth=EvaluatedQuantity(predicted=4.0, measured=4.0),
    feed_per_tooth=EvaluatedQuantity(predicted=0.1, measured=0.08),
    immersion=FaceMillingImmersion.FULL_IMMERSION,
    strategy="contour_parallel",
    roughness=EvaluatedQuantity(predicted=0.0016),
    time=EvaluatedQuantity(predicted=50.0, measured=55.0),
    force=EvaluatedQuantity(predicted=800.0, measured=900.0),
    feed=EvaluatedQuantity(predicted=16.0, measured=14.0),
    force_bound=950.0,
    force_ratio=ForceRatio(log_mean=0.12, log_deviation=0.05, readings=2200),
    trace="run-1.parquet",
    run="run-1",
    recorded_at=NOON,
    recorded_by="virtual machine",
)

PROPOSAL = LearnedCorrection(
    context=POCKET.context,
    log_centre=0.12,
    log_scale=0.03,
    degrees=7.5,
    outcomes=8,
    confidence=0.97,
    proposed_at=NOON,
)


class OutcomeMaker(Protocol):
    """Makes so many outcomes of one run, a minute apart; each has a workingstep of its own."""

    def __call__(self, number: int, *, run: str = "run-1") -> list[ProcessOutcome]: ...


def made(number: int, *, run: str = "run-1") -> list[ProcessOutcome]:
    return [
        replace(
            POCKET,
            run=run,
            workingstep=f"{run} WS{index}",
            recorded_at=NOON + timedelta(minutes=index),
        )
        for index in range(number)
    ]


@pytest.fixture(scope="session")
def outcome() -> ProcessOutcome:
    return POCKET


@pytest.fixture(scope="session")
def proposal() -> LearnedCorrection:
    return PROPOSAL


@pytest.fixture(scope="session")
def outcomes() -> OutcomeMaker:
    return made


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
            timeout=60.0,
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


SCHEMAS = count()


class UrlMaker(Protocol):
    """Names a place where no store is yet."""

    def __call__(self) -> str: ...


@pytest.fixture
def postgres_place(postgres_url: str) -> Iterator[UrlMaker]:
    schemas: list[str] = []

    def place() -> str:
        schema = f"test_{os.getpid()}_{next(SCHEMAS)}"
        with psycopg.connect(postgres_url, autocommit=True) as connection:
            connection.execute(f"CREATE SCHEMA {schema}")
        schemas.append(schema)
        joint = "&" if "?" in postgres_url else "?"
        return f"{postgres_url}{joint}options=-csearch_path%3D{schema}"

    yield place
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        for schema in schemas:
            connection.execute(f"DROP SCHEMA {schema} CASCADE")


@pytest.fixture
def sqlite_place(tmp_path: Path) -> UrlMaker:
    numbers = count()
    return lambda: str(tmp_path / f"store-{next(numbers)}.db")


@pytest.fixture(params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest) -> UrlMaker:
    """Names new places: once in SQLite, once in PostgreSQL."""
    kind = "sqlite_place" if request.param == "sqlite" else "postgres_place"
    made: UrlMaker = request.getfixturevalue(kind)
    return made


@pytest.fixture
def url(place: UrlMaker) -> str:
    return place()


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    """A new store: once in SQLite, once in PostgreSQL."""
    with open_store(url) as opened:
        yield opened
