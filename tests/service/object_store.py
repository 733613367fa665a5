"""A server of objects (S3) on loopback, behind a gate that cuts it off from its clients."""

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Lock, Thread

import httpx

from tests.service.waiting import ended, until

BUCKET = "shop"


def listening() -> socket.socket:
    return socket.create_server(("127.0.0.1", 0))


class Gate:
    """Passes connections on to a port; closed, it ends them and refuses new ones.

    Running state.
    """

    def __init__(self, target: int) -> None:
        self._target = target
        self._door: socket.socket | None = listening()
        self.port: int = self._door.getsockname()[1]
        self._open: set[socket.socket] = set()
        self._lock = Lock()
        self.passed = Event()
        self._serve(self._door)

    def _serve(self, door: socket.socket) -> None:
        Thread(target=self._accept, args=(door,), daemon=True).start()

    def _accept(self, door: socket.socket) -> None:
        with suppress(OSError):
            while True:
                client, _ = door.accept()
                server = socket.create_connection(("127.0.0.1", self._target))
                with self._lock:
                    self._open |= {client, server}
                for one, other in ((client, server), (server, client)):
                    Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(1 << 16):
                other.sendall(data)
                self.passed.set()
        self._end({one, other})

    def _end(self, ended: set[socket.socket]) -> None:
        with self._lock:
            self._open -= ended
        for each in ended:
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    def close(self) -> None:
        """Cut all off, in the middle of what they send."""
        door, self._door = self._door, None
        if door is not None:
            with suppress(OSError):
                door.shutdown(socket.SHUT_RDWR)
            door.close()
        with self._lock:
            opened = set(self._open)
        self._end(opened)

    def open(self) -> None:
        """Let all in again, at the same port."""
        self._door = socket.create_server(("127.0.0.1", self.port))
        self._serve(self._door)


@contextmanager
def object_store(folder: Path) -> Iterator[Gate]:
    """A server with an empty bucket, ended by its own id."""
    with listening() as probe:
        port = probe.getsockname()[1]
    with (folder / "store.log").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)],
            stdin=subprocess.DEVNULL, stdout=log, stderr=log, cwd=folder,
        )  # fmt: skip
    url = f"http://127.0.0.1:{port}/{BUCKET}"

    def is_made() -> bool:
        assert process.poll() is None, (folder / "store.log").read_text("utf-8")
        with suppress(httpx.TransportError):
            return httpx.put(url, trust_env=False, timeout=120.0).is_success
        return False

    try:
        until(is_made, within=90.0)
        gate = Gate(port)
        try:
            yield gate
        finally:
            gate.close()
    finally:
        process.kill()
        ended(process)
