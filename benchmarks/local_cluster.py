"""Dask clusters of this machine: a scheduler and workers as processes of their own."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

STARTS_WITHIN = 60.0
"""Time, s, in which a process of the cluster must answer."""


class LocalCluster:
    """Scheduler and workers. Running state."""

    def __init__(self, folder: Path, options: tuple[str, ...] = ()) -> None:
        self._folder = folder
        self._options = options
        self._port = free_port()
        self._scheduler: subprocess.Popen[bytes] | None = None
        self._workers: list[subprocess.Popen[bytes]] = []
        self._started = 0

    @property
    def address(self) -> str:
        """Address of the scheduler."""
        scheme = "tls" if self._options else "tcp"
        return f"{scheme}://127.0.0.1:{self._port}"

    def start_scheduler(self) -> None:
        """Start the scheduler, at the same address each time."""
        self._scheduler = self._start(
            "scheduler", "--host", self.address.rpartition(":")[0], "--port", str(self._port)
        )

    def start_worker(self) -> None:
        """Start one more worker."""
        self._started += 1
        self._workers.append(
            self._start(
                "worker", self.address, "--nthreads", "1", "--no-nanny", "--name",
                f"worker-{self._started}", "--local-directory", str(self._folder),
            )
        )  # fmt: skip

    def wait(self, workers: int) -> None:
        """Wait until workers are there."""
        from distributed import Client  # noqa: PLC0415 (Dask takes a second)

        with Client(self.address, timeout=STARTS_WITHIN, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=STARTS_WITHIN)

    def kill_worker(self, index: int = 0) -> None:
        """Kill a worker, oldest first, without a word."""
        end(self._workers.pop(index))

    def kill_scheduler(self) -> None:
        """Kill the scheduler without a word."""
        if self._scheduler is not None:
            end(self._scheduler)

    def close(self) -> None:
        """End everything."""
        for each in self._workers:
            end(each)
        self.kill_scheduler()

    def _start(self, *arguments: str) -> "subprocess.Popen[bytes]":
        with (self._folder / "cluster.log").open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments, "--no-dashboard", *self._options],
                stdout=log, stderr=log, cwd=self._folder,
                env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
            )  # fmt: skip


def end(process: "subprocess.Popen[bytes]") -> None:
    """Kill a process and wait for its end."""
    process.kill()
    process.wait()


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@contextmanager
def running_cluster(folder: Path, workers: int) -> Iterator[LocalCluster]:
    """A cluster whose workers are there."""
    made = LocalCluster(folder)
    try:
        made.start_scheduler()
        for _ in range(workers):
            made.start_worker()
        made.wait(workers)
        yield made
    finally:
        made.close()
