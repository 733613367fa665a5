"""``stepnc serve`` in processes of its own, as clients meet it."""

import json
import os
import signal
import socket
import ssl
import sys
from contextlib import suppress
from pathlib import Path
from subprocess import DEVNULL, Popen
from typing import Any

import httpx

from service.storage import keys
from service.storage.folder import open_data_folder
from service.storage.keys import Role
from tests.service.waiting import children, ended, environment, is_alive, until

STEPNC = Path(sys.executable).with_name("stepnc")

PATIENCE = 90.0
"""s for an answer"""

FAULTS = ('"event":"fault"', "Traceback", '"level":"error"')
"""What a line of the log has when the program is at fault."""

TRUSTING_NOBODY = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
"""for clients without TLS: httpx reads the certificates of the world for each otherwise"""


def free_port() -> int:
    """A port that nobody has just now."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Server:
    """One server on a folder of its own. Running state; use it with ``with``."""

    def __init__(
        self,
        folder: Path,
        *words: str,
        scheme: str = "http",
        verify: ssl.SSLContext = TRUSTING_NOBODY,
    ):
        self.folder = folder
        self.data = folder / "data"
        self.port = free_port()
        self.url = f"{scheme}://127.0.0.1:{self.port}"
        self.log = folder / "log"
        self._words, self._verify = words, verify
        self._process: Popen[bytes] | None = None

    def __enter__(self) -> "Server":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def pid(self) -> int:
        """Of the process that was started."""
        assert self._process is not None
        return self._process.pid

    def start(self) -> None:
        """Start, and wait until requests and jobs are served."""
        self.folder.mkdir(exist_ok=True)
        words = ["serve", "--data", str(self.data), "--port", str(self.port), *self._words]
        with self.log.open("ab") as log:
            self._process = Popen(
                [str(STEPNC), *words],
                env=environment(self.folder),
                cwd=self.folder,
                stdin=DEVNULL,
                stdout=DEVNULL,
                stderr=log,
            )
        with self.client() as client:
            until(lambda: self._is_ready(client), within=300.0)

    def _is_ready(self, client: httpx.Client) -> bool:
        assert self._process is not None
        assert self._process.poll() is None, self.log.read_text()[-2000:]
        with suppress(httpx.TransportError):
            return client.get("/readyz").status_code == 200
        return False

    def stop(self) -> int:
        """End it as a service manager does; its exit code."""
        if self._process is None:
            return 0
        below = children(self.pid)
        self._process.send_signal(signal.SIGTERM)
        code = ended(self._process)
        self._process = None
        until(lambda: not any(map(is_alive, below)))
        return code

    def kill(self) -> None:
        """All of its processes at once, as when the power fails."""
        assert self._process is not None
        below = children(self.pid)
        self._process.kill()
        for pid in below:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        ended(self._process)
        self._process = None
        until(lambda: not any(map(is_alive, below)))

    def client(self, key: str = "", **more: Any) -> httpx.Client:
        """A client of it; nothing of the environment's proxies."""
        headers = {"authorization": f"Bearer {key}"} if key else {}
        return httpx.Client(
            base_url=self.url,
            headers=headers,
            verify=self._verify,
            trust_env=False,
            timeout=PATIENCE,
            **more,
        )

    def faults(self) -> str:
        """What the log says from the first fault of the program on; empty if it has none."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        for number, line in enumerate(lines):
            if any(word in line for word in FAULTS):
                return "\n".join(lines[max(0, number - 2) : number + 60])
        return ""


def over(client: httpx.Client, id: str, *, within: float = 300.0) -> dict[str, Any]:
    """A job once it is over."""

    def look() -> dict[str, Any] | None:
        found: dict[str, Any] = client.get(f"/v1/jobs/{id}").json()
        return None if found["state"] in {"queued", "running"} else found

    return until(look, within=within)


def made(answer: httpx.Response, status: int = 202) -> str:
    """Id of what a request has made."""
    assert answer.status_code == status, answer.text
    return str(answer.json()["id"])


def is_problem(answer: httpx.Response, status: int, kind: str = "") -> dict[str, Any]:
    """The problem of an answer that is one, as RFC 9457 wants it."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    found: dict[str, Any] = json.loads(answer.content)
    assert found["status"] == status
    assert found["type"].startswith("urn:stepnc:problem:")
    assert found["title"]
    assert found["detail"]
    assert not kind or found["type"] == f"urn:stepnc:problem:{kind}"
    return found


def create_key(server: Server, name: str, *roles: str) -> str:
    """A key, as the command line gives it."""
    data_folder = open_data_folder(server.data)
    return keys.create(data_folder, name=name, roles=frozenset(map(Role, roles)))
