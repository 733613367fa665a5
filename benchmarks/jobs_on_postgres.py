"""Jobs of two hosts on one PostgreSQL database, while hosts are killed at random moments.

Each host is ``stepnc serve`` in a process group and data folder of its own; the folder of
files is shared. A client sends small jobs to either host and repeats what was not answered. A
trigger of the database counts how often each job has ended. The database's own cost of a claim,
and of a rate limit that all processes share, is measured beside it. With ``--queue``, the
runners of two hosts empty a queue of jobs that take no time instead: what is measured and
killed then is only the claiming and ending.
"""

import argparse
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from random import Random
from statistics import median, quantiles
from uuid import UUID

import psycopg

from kbe.store import open_store
from service.jobs import verb_job
from service.jobs.task import RunningJob
from service.requests.advice import AdviceRequest
from service.requests.fields import dumped
from service.storage import jobs, programs, rates
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import JobKind, JobRequest
from stepnc_model.post.dialect import Dialect
from tests.postgres import AUDIT, started_server
from tests.service.rest.samples import PARTS, SAMPLE
from tests.service.shop import outcomes

ROOT = Path(__file__).parents[1]

OUTCOMES, BATCH, ADVICES = 20_000, 1000, 9

QUICK = """
import os, sys, time
from service.jobs import runner
from service.storage import jobs, rates
from service.storage.folder import FolderAddress

class Quick(runner.Runner):
    def _start(self, context, job):
        jobs.finish(self.data_folder, job, jobs.JobState.SUCCEEDED)
        return time.monotonic() - self._beaten_at < runner.BEAT

runner.Runner = Quick
folder = FolderAddress(root=sys.argv[1], files=sys.argv[2], database=sys.argv[3])
runner.main(folder, 2, os.getppid())
"""
"""a runner whose jobs have ended when they begin"""

ANSWER = 5.0
"""s that the client waits for an answer before it asks the other host"""


@dataclass(kw_only=True)
class Host:
    """A server with its runner and jobs, in a process group of its own. Running state."""

    data: Path
    words: list[str]
    port: int = 0
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, without waiting."""
        self.data.mkdir(exist_ok=True)
        command = [sys.executable, "-c", *self._words()]
        with (self.data / "log").open("ab") as log:
            self.process = subprocess.Popen(
                command, cwd=ROOT, stdout=log, stderr=log, start_new_session=True,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
            )  # fmt: skip

    def _words(self) -> list[str]:
        if not self.port:
            return [QUICK, str(self.data), *self.words]
        return [
            "from service.cli.main import main; main()", "serve", "--data", str(self.data),
            "--port", str(self.port), "--log-level", "warning", *self.words,
        ]  # fmt: skip

    def kill(self) -> None:
        """Kill all of its processes at once."""
        assert self.process is not None
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(20.0)


@dataclass(kw_only=True)
class Client:
    """Sends jobs until each is accepted. Running state."""

    ports: list[int]
    random: Random
    accepted: list[str] = field(default_factory=list)
    repeated: int = 0

    def send_all(self, count: int) -> None:
        """Send so many jobs, one after the other."""
        for number in range(count):
            self.send(number)

    def send(self, number: int) -> None:
        """One job, under one idempotency key, to either host until one accepts it."""
        for count in range(100_000):
            port = self.random.choice(self.ports)
            headers = {
                "content-type": "application/json", "idempotency-key": str(UUID(int=number)),
            }  # fmt: skip
            request = urllib.request.Request(
                f"http://127.0.0.1:{port}/v1/reviews", b"{}", headers, method="POST"
            )
            try:
                with urllib.request.urlopen(request, timeout=ANSWER) as answer:
                    self.accepted.append(json.loads(answer.read())["id"])
                    self.repeated += count > 0
                    return
            except urllib.error.HTTPError as error:
                if error.code not in {429, 503}:
                    raise
                # The queue is full: to ask again at once would only take its time.
                time.sleep(0.5)
            except OSError:
                """the host is gone, or ended before its answer came"""
            time.sleep(0.05)


def main(arguments: list[str] | None = None) -> None:
    """Print what was accepted, lost and repeated, and what a claim costs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=1000)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=18)
    parser.add_argument("--queue", type=int, default=0, help="jobs that take no time")
    options = parser.parse_args(arguments)
    if not list(Path("/usr/lib/postgresql").glob("*/bin/initdb")):
        print("left out: PostgreSQL is not installed (apt-get install postgresql)")
        return
    server = started_server()
    try:
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            files = str(place / "files")
            data_folder = open_data_folder(place / "c", database=server.url, files=files)
            if options.queue:
                _queue(place, data_folder, options)
            else:
                _claims(data_folder)
                _limit(data_folder)
                _advices(data_folder)
                _hosts(place, server.url, options)
                # At the end: reviews of so many are no small jobs.
                _outcomes(server.url)
            data_folder.database.close()
    finally:
        server.stop("fast")
        shutil.rmtree(server.folder)


def _hosts(folder: Path, url: str, options: argparse.Namespace) -> None:
    with psycopg.connect(url, autocommit=True) as connection:
        connection.execute("TRUNCATE stepnc_service.jobs")
        connection.execute(AUDIT)
    words = ["--database", url, "--files", str(folder / "files"), "--jobs", "2"]
    hosts = [Host(data=folder / name, words=words, port=_free_port()) for name in ("a", "b")]
    for host in hosts:
        host.start()
    random = Random(options.seed)
    client = Client(ports=[host.port for host in hosts], random=Random(options.seed))
    sender = threading.Thread(target=client.send_all, args=(options.jobs,), daemon=True)
    begin = time.monotonic()
    sender.start()
    kills = 0
    # Spread over all jobs, however many there are.
    apart = max(options.jobs / 1000.0, 1.0)
    try:
        while sender.is_alive() or _waiting(url) or kills < options.kills:
            time.sleep(random.uniform(0.5, 4.0) * (apart if kills < options.kills else 1.0))
            if kills < options.kills:
                host = random.choice(hosts)
                host.kill()
                # Now and then for longer than the lease, so that the other one takes over.
                time.sleep(12.0 if kills % 10 == 9 else 0.0)
                host.start()
                kills += 1
        elapsed = time.monotonic() - begin
    finally:
        for host in hosts:
            host.kill()
    _print(url, client, elapsed=elapsed, kills=kills)


def _queue(folder: Path, data_folder: DataFolder, options: argparse.Namespace) -> None:
    """Let two runners empty a long queue while either is killed now and then."""
    url, files = data_folder.address.database, data_folder.address.files
    with psycopg.connect(url, autocommit=True) as connection:
        connection.execute(AUDIT)
        connection.execute(
            "INSERT INTO stepnc_service.jobs "
            "(id, kind, state, request, program, source, owner, created) "
            "SELECT lpad(i::TEXT, 26, '0'), 'review', 'queued', '{}', '', '', 'local', 0 "
            "FROM generate_series(1, %s) AS i",
            (options.queue,),
        )
    hosts = [Host(data=folder / name, words=[files, url]) for name in ("a", "b")]
    for host in hosts:
        host.start()
    random, kills = Random(options.seed), 0
    while _ended(url) < 1:
        time.sleep(0.1)
    begin = time.monotonic()
    try:
        while _waiting(url):
            time.sleep(random.uniform(0.5, 10.0))
            if kills < options.kills:
                host = random.choice(hosts)
                host.kill()
                time.sleep(12.0 if kills % 10 == 9 else 0.0)
                host.start()
                kills += 1
    finally:
        for host in hosts:
            host.kill()
    elapsed = time.monotonic() - begin
    with psycopg.connect(url) as connection:
        row = connection.execute(
            "SELECT count(*), count(DISTINCT id), count(*) FILTER (WHERE state = 'succeeded'), "
            "count(*) FILTER (WHERE attempt > 1) FROM stepnc_service.ends"
        ).fetchone()
    assert row is not None
    print(f"jobs queued: {options.queue}; runners killed: {kills} times in {elapsed:.0f} s; "
          f"{options.queue / elapsed:.0f} jobs/s")  # fmt: skip
    print(f"never ended: {options.queue - row[1]}; ended more than once: {row[0] - row[1]}; "
          f"succeeded: {row[2]}; claimed again after a kill: {row[3]}")  # fmt: skip
    print(f"{_size(url, 'stepnc_service.jobs') / options.queue:.0f} bytes of the database for "
          "each job, with indexes")  # fmt: skip


def _ended(url: str) -> int:
    with psycopg.connect(url) as connection:
        row = connection.execute("SELECT count(*) FROM stepnc_service.ends").fetchone()
    return 0 if row is None else int(row[0])


def _print(url: str, client: Client, *, elapsed: float, kills: int) -> None:
    with psycopg.connect(url) as connection:
        ends = connection.execute(
            "SELECT id, state, attempt FROM stepnc_service.ends"
        ).fetchall()
    ids = [row[0] for row in ends]
    accepted = set(client.accepted)
    print(
        f"jobs accepted: {len(accepted)}, of these after a repeated request: {client.repeated}"
    )
    print(f"hosts killed: {kills} times in {elapsed:.0f} s; {len(ids) / elapsed:.1f} jobs/s")
    print(f"accepted but never ended: {len(accepted - set(ids))}")
    print(f"ended more than once: {len(ids) - len(set(ids))}")
    print(f"not accepted but run: {len(set(ids) - accepted)}")
    size = _size(url, "stepnc_service.jobs")
    print(f"{size / max(len(ids), 1):.0f} bytes of the database for each job, with indexes")
    print(f"succeeded: {sum(row[1] == 'succeeded' for row in ends)}; "
          f"given up after {jobs.MOST_ATTEMPTS_SHARED} lost attempts: "
          f"{sum(row[1] == 'failed' for row in ends)}; "
          f"run again after a kill: {sum(row[2] > 1 for row in ends)}")  # fmt: skip


def _claims(data_folder: DataFolder) -> None:
    """Cost of a job in the database alone: queue, claim and end it."""
    asked = JobRequest(kind=JobKind.REVIEW, request={}, owner=jobs.LOCAL)
    add = _timed(lambda: jobs.add(data_folder, asked), 500)
    seconds: list[float] = []
    ends: list[float] = []
    for _ in range(500):
        begin = time.perf_counter()
        job = jobs.claim(data_folder, runner="bench")
        seconds.append(time.perf_counter() - begin)
        assert job is not None
        begin = time.perf_counter()
        jobs.finish(data_folder, job, jobs.JobState.SUCCEEDED)
        ends.append(time.perf_counter() - begin)
    print(f"{'in the database alone':28}{'p50 ms':>10}{'p99 ms':>10}")
    for name, times in (("queue a job", add), ("claim a job", seconds), ("end a job", ends)):
        print(f"{name:28}{_quantile(times, 50):10.2f}{_quantile(times, 99):10.2f}")


def _limit(data_folder: DataFolder) -> None:
    """Cost of fetching a tenth of a burst out of the bucket that all hosts share."""
    fetch = partial(
        rates.take, data_folder.database, "bench", most=10, rate=1e6, burst=100
    )  # fmt: skip
    times = _timed(fetch, 1000)
    print(f"{'ten requests of the rate':28}{_quantile(times, 50):10.2f}"
          f"{_quantile(times, 99):10.2f}")  # fmt: skip


def _outcomes(url: str) -> None:
    """Rate and size of outcomes in the knowledge base of the same database."""
    rows = list(outcomes(OUTCOMES))
    with open_store(url) as store:
        begin = time.perf_counter()
        for first in range(0, OUTCOMES, BATCH):
            store.add(rows[first : first + BATCH])
        elapsed = time.perf_counter() - begin
    size = _size(url, "outcome")
    print(f"outcomes: {OUTCOMES / elapsed:.0f} per s in batches of {BATCH}; "
          f"{size / OUTCOMES:.0f} bytes each with indexes")  # fmt: skip


def _advices(data_folder: DataFolder) -> None:
    """Processor time and bytes of an advice for two programs, without its process."""
    with open_store(data_folder.knowledge):
        """made when it is new"""
    for file in (SAMPLE, PARTS / "bracket.stpnc"):
        seconds, size = _advised(data_folder, file)
        print(f"an advice for {file.stem}: {median(seconds):.2f} s of a core; "
              f"{size / 1e6:.2f} MB of files with the program")  # fmt: skip


def _advised(data_folder: DataFolder, file: Path) -> tuple[list[float], int]:
    """Times of some advices, in s of a core, and bytes of one with its program."""
    program = programs.add(data_folder, file.read_bytes(), name=file.name, owner="bench")
    request = dumped(AdviceRequest(machine="vmc15", nc_control=Dialect.LINUXCNC))
    asked = JobRequest(
        kind=JobKind.ADVICE, request=request, program=program.id, owner=jobs.LOCAL
    )
    seconds: list[float] = []
    for _ in range(ADVICES):
        jobs.add(data_folder, asked)
        job = jobs.claim(data_folder, kinds=[JobKind.ADVICE], runner="bench")
        assert job is not None
        task = RunningJob(data_folder=data_folder, job=job)
        begin = time.process_time()
        task.make_folder()
        verb_job.run(task)
        jobs.finish(data_folder, job, jobs.JobState.SUCCEEDED)
        seconds.append(time.process_time() - begin)
    return seconds, program.size + sum(each.stat().st_size for each in task.folder.iterdir())


def _size(url: str, table: str) -> int:
    with psycopg.connect(url) as connection:
        row = connection.execute("SELECT pg_total_relation_size(%s)", (table,)).fetchone()
    return 0 if row is None else int(row[0])


def _timed(call: Callable[[], object], count: int) -> list[float]:
    found: list[float] = []
    for _ in range(count):
        begin = time.perf_counter()
        call()
        found.append(time.perf_counter() - begin)
    return found


def _quantile(seconds: list[float], percent: int) -> float:
    return 1000.0 * quantiles(seconds, n=100)[percent - 1]


def _waiting(url: str) -> bool:
    with psycopg.connect(url) as connection:
        row = connection.execute(
            "SELECT 1 FROM stepnc_service.jobs WHERE state IN ('queued', 'running') LIMIT 1"
        ).fetchone()
    return row is not None


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    main()
