"""Two hosts on one database, as process groups: whoever is killed, each job has one result."""

import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from random import Random
from subprocess import DEVNULL, Popen
from threading import Event, Thread

import psycopg
import pytest

from kbe.store import open_store
from service.jobs import runner
from service.requests.fields import dumped
from service.requests.knowledge import ReviewRequest
from service.storage import jobs
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import JobKind, JobRequest, JobState
from tests.postgres import AUDIT, Server, ServerMaker
from tests.service.waiting import ended, environment, until

MAIN = """
import os, sys
from service.jobs import runner
from service.storage.folder import FolderAddress
runner.BEAT = 0.2
# All that these jobs need: a host that was killed is soon at work again.
runner.LOADED = ("service.jobs.preloaded_common", "service.verbs.kbe.review.run")
folder = FolderAddress(root=sys.argv[1], files=sys.argv[2], database=sys.argv[3])
runner.main(folder, 2, os.getppid())
"""

JOBS = 4
"""Jobs ordered before each kill, as many as the hosts run at a time: more would only be left
when all kills are done."""

KILLS = 12


@dataclass(kw_only=True)
class Host:
    """A runner and its jobs, in a process group of their own. Running state."""

    root: Path
    files: Path
    database: str
    process: Popen[bytes] | None = None

    def start(self) -> None:
        self.root.mkdir(exist_ok=True)
        with (self.root / "log").open("ab") as log:
            self.process = Popen(
                [sys.executable, "-c", MAIN, str(self.root), str(self.files), self.database],
                env=environment(self.root), stdin=DEVNULL, stdout=log, stderr=log,
                start_new_session=True,
            )  # fmt: skip

    def signal(self, number: signal.Signals) -> None:
        """All of its processes at once."""
        assert self.process is not None
        os.killpg(self.process.pid, number)

    def kill(self) -> None:
        assert self.process is not None
        self.signal(signal.SIGKILL)
        ended(self.process)
        self.process = None

    @property
    def name(self) -> str:
        """Last part of the name of its runner; empty before it has begun."""
        file = self.root / "runner.name"
        return file.read_text("ascii").strip() if file.is_file() else ""

    def said(self) -> str:
        return (self.root / "log").read_text("utf-8", "replace")


@dataclass(kw_only=True)
class Shop:
    """A database, a folder of files and two hosts. Running state."""

    url: str
    data_folder: DataFolder
    hosts: list[Host] = field(default_factory=list)

    def order(self, kind: JobKind = JobKind.REVIEW, **words: object) -> str:
        request = dumped(ReviewRequest()) if kind is JobKind.REVIEW else words
        asked = JobRequest(kind=kind, request=request, owner=jobs.LOCAL)
        return jobs.add(self.data_folder, asked).id

    def runner_of(self, id: str) -> str:
        with self.data_folder.database.reading() as connection:
            row = connection.execute(
                "SELECT runner FROM jobs WHERE id = ? AND state = 'running'", (id,)
            ).fetchone()
        return "" if row is None else str(row["runner"])

    def busy(self) -> list[Host]:
        """Hosts that run jobs."""
        with self.data_folder.database.reading() as connection:
            rows = connection.execute(
                "SELECT DISTINCT runner FROM jobs WHERE state = 'running'"
            ).fetchall()
        return [
            host for host in self.hosts
            if host.name and any(host.name in row["runner"] for row in rows)
        ]  # fmt: skip

    def host_of(self, id: str) -> Host:
        name = until(lambda: self.runner_of(id))
        return next(
            host for host in self.hosts
            if host.name and host.name in name
        )  # fmt: skip


def made_shop(url: str, folder: Path) -> Shop:
    data_folder = open_data_folder(folder / "client", database=url, files=str(folder / "files"))
    with open_store(url):
        """made when it is new"""
    hosts = [
        Host(root=folder / name, files=folder / "files", database=url) for name in ("a", "b")
    ]
    return Shop(url=url, data_folder=data_folder, hosts=hosts)


@pytest.fixture
def shop(new_database: str, tmp_path: Path) -> Iterator[Shop]:
    made = made_shop(new_database, tmp_path)
    yield made
    for host in made.hosts:
        if host.process is not None:
            host.kill()
    made.data_folder.database.close()


def waiting(shop: Shop) -> int:
    """Jobs that have not ended."""
    with shop.data_folder.database.reading() as connection:
        row = connection.execute(
            "SELECT count(*) AS n FROM jobs WHERE state IN ('queued', 'running')"
        ).fetchone()
    return int(row["n"])


def test_killed_hosts_lose_no_job_and_no_job_has_two_results(shop: Shop) -> None:
    with psycopg.connect(shop.url, autocommit=True) as connection:
        connection.execute(AUDIT)
    made: list[str] = []
    random = Random(18)
    for host in shop.hosts:
        host.start()
    pause = Event()
    for kill in range(KILLS):
        # Beside the hosts: orders come while jobs run and end.
        client = Thread(target=lambda: made.extend(shop.order() for _ in range(JOBS)))
        client.start()
        # One that is still starting would tell nothing.
        host = random.choice(until(shop.busy))
        pause.wait(random.uniform(0.0, 0.5))
        host.kill()
        client.join()
        if kill % 5 == 4:
            # Longer than the lease: the other host takes over.
            pause.wait(1.5)
        host.start()
    until(lambda: not waiting(shop), within=600.0)
    with psycopg.connect(shop.url) as connection:
        ends = connection.execute(
            "SELECT id, state, attempt FROM stepnc_service.ends"
        ).fetchall()
    assert len(made) == JOBS * KILLS
    assert sorted(row[0] for row in ends) == sorted(made)
    attempts = {row[0]: row[2] for row in ends}
    assert {row[1] for row in ends} == {"succeeded"}
    assert max(attempts.values()) > 1
    folder = shop.data_folder.files / "jobs"
    shown = {*made, *(f"{id}.{attempts[id]}" for id in made)}
    assert {each.name for each in folder.iterdir()} == shown
    for id in made:
        assert (folder / id).readlink().name == f"{id}.{attempts[id]}"
        assert (folder / id / "result.json").stat().st_size > 0


def test_a_host_that_is_gone_loses_its_job_to_another_and_a_frozen_one_gives_up(
    shop: Shop,
) -> None:
    for host in shop.hosts:
        host.start()
    trial = shop.order(JobKind.TRIAL, inputs={}, seed=0, pace=1.0)
    run = shop.order(JobKind.SIMULATION, pace=1.0)
    frozen = shop.host_of(trial)
    frozen.signal(signal.SIGSTOP)
    # A run with people in it is not run twice.
    ended = until(lambda: over(shop, trial))
    assert ended.state is JobState.FAILED
    assert ended.problem is not None
    assert "cannot be resumed" in ended.problem["detail"]
    frozen.signal(signal.SIGCONT)
    # The program of this one does not exist, whoever runs it.
    assert until(lambda: over(shop, run)).state is JobState.FAILED
    done = [shop.order() for _ in range(6)]
    for id in done:
        assert until(partial(over, shop, id)).state is JobState.SUCCEEDED
    assert jobs.get(shop.data_folder, trial) == ended


def over(shop: Shop, id: str) -> jobs.Job | None:
    found = jobs.get(shop.data_folder, id)
    return found if found.state.is_finished else None


def test_a_cancel_reaches_the_host_that_runs_the_job(shop: Shop) -> None:
    for host in shop.hosts:
        host.start()
    trial = shop.order(JobKind.TRIAL, inputs={}, seed=0, pace=1.0)
    shop.host_of(trial)
    jobs.cancel(shop.data_folder, trial)
    assert until(lambda: over(shop, trial)).state is JobState.CANCELLED


def test_a_server_that_goes_away_stops_nobody(new_server: ServerMaker, tmp_path: Path) -> None:
    server: Server = new_server()
    shop = made_shop(server.url, tmp_path)
    [host, _] = shop.hosts
    host.start()
    try:
        trial = shop.order(JobKind.TRIAL, inputs={}, seed=0, pace=1.0)
        shop.host_of(trial)
        before = jobs.get(shop.data_folder, trial)
        server.stop("immediate")
        until(lambda: "the database does not answer" in host.said())
        server.start()
        run = shop.order()
        assert until(lambda: over(shop, run)).state is JobState.SUCCEEDED
        now = jobs.get(shop.data_folder, trial)
        assert (now.state, now.attempt) == (JobState.RUNNING, before.attempt)
    finally:
        host.kill()
        shop.data_folder.database.close()


def test_the_name_of_a_runner_is_that_of_its_folder(shop: Shop, tmp_path: Path) -> None:
    one = open_data_folder(tmp_path / "one", database=shop.url)
    assert runner.own_name(one) == runner.own_name(one)
    assert runner.own_name(one) != runner.own_name(shop.data_folder)
    assert runner.own_name(open_data_folder(tmp_path / "file")) == ""
    one.database.close()
