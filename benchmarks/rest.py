"""Look-ups of an advised feed over REST, beside a bare FastAPI route with the same bytes.

Both servers stand side by side, each one process under uvicorn, and are asked in turn by wrk
while a simulation is run as a job and a trial is watched by a client. Ratios are pair by pair.
"""

import argparse
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).parents[1]
CONNECTIONS = 16
PATIENCE = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """Result of wrk."""

    rate: float
    """requests a second"""
    p50: float
    """ms"""
    p99: float
    """ms"""


def main(arguments: list[str] | None = None) -> None:
    """Print requests a second and latencies of both, and the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--seconds", type=int, default=4)
    parser.add_argument(
        "--database", default="", help="postgresql://…, without tables so far; else a file"
    )
    parser.add_argument("--quiet", action="store_true", help="without a job and a stream")
    options = parser.parse_args(arguments)
    if shutil.which("wrk") is None:
        print("left out: wrk is not installed (apt-get install wrk)")
        return
    with (
        tempfile.TemporaryDirectory() as folder,
        _service(Path(folder), options.database) as service,
    ):
        path = _advised(service)
        body = Path(folder) / "body.json"
        body.write_bytes(_get(service + path))
        with _peer(body) as peer:
            if not options.quiet:
                _work(service)
            pairs = []
            for number in range(options.pairs + 1):
                if not options.quiet:
                    _simulate(service)
                pair = tuple(_load(base + path, options.seconds) for base in (service, peer))
                if number:  # the first warms both up
                    pairs.append(pair)
    print(f"{'server':28}{'requests/s':>12}{'p50 ms':>10}{'p99 ms':>10}")
    for place, name in enumerate(("advice look-up", "bare FastAPI route")):
        loads = [pair[place] for pair in pairs]
        rate, p50, p99 = (
            median(getattr(load, what) for load in loads) for what in ("rate", "p50", "p99")
        )
        print(f"{name:28}{rate:12.0f}{p50:10.2f}{p99:10.2f}")
    slower = median(peer.rate / ours.rate for ours, peer in pairs)
    later = median(ours.p99 / peer.p99 for ours, peer in pairs)
    print(f"bare over ours, requests/s: {slower:.2f}; ours over bare, p99: {later:.2f}")


@contextmanager
def _service(folder: Path, database: str) -> Iterator[str]:
    port = _free_port()
    command = [
        str(Path(sys.executable).with_name("stepnc")), "serve", "--data", str(folder / "data"),
        "--port", str(port), *(("--database", database) if database else ()),
    ]  # fmt: skip
    with _running(
        command, folder / "service.log", f"http://127.0.0.1:{port}", "/readyz"
    ) as base:
        yield base


@contextmanager
def _peer(body: Path) -> Iterator[str]:
    port = _free_port()
    command = [
        sys.executable, "-m", "uvicorn", "benchmarks.rest_peer:app", "--port", str(port),
        "--no-access-log", "--log-level", "warning",
    ]  # fmt: skip
    path = "/v1/advice/a/workingsteps/b"
    environment = {**os.environ, "STEPNC_BENCH_BODY": str(body)}
    log = body.with_name("peer.log")
    with _running(command, log, f"http://127.0.0.1:{port}", path, environment) as base:
        yield base


@contextmanager
def _running(
    command: list[str],
    log: Path,
    base: str,
    path: str,
    environment: dict[str, str] | None = None,
) -> Iterator[str]:
    """A server, once it answers; ended by its own id."""
    with log.open("wb") as out:
        process = subprocess.Popen(command, cwd=ROOT, stdout=out, stderr=out, env=environment)
    try:
        until = time.monotonic() + PATIENCE
        while True:
            try:
                _get(base + path)
                break
            except OSError:
                if time.monotonic() > until or process.poll() is not None:
                    raise
                time.sleep(0.1)
        yield base
    finally:
        process.terminate()
        process.wait(20.0)


def _advised(base: str) -> str:
    """Path of one workingstep of an advice for the bracket."""
    program = _post(f"{base}/v1/programs?example=bracket")["id"]
    job = _post(f"{base}/v1/programs/{program}/advice", {"machine": "vmc15"})["id"]
    until = time.monotonic() + PATIENCE
    while json.loads(_get(f"{base}/v1/jobs/{job}"))["state"] != "succeeded":
        if time.monotonic() > until:
            raise TimeoutError(f"no advice after {PATIENCE} s")
        time.sleep(0.2)
    return f"/v1/advice/{job}/workingsteps/16"


def _work(base: str) -> None:
    """A trial, and somebody who watches it."""
    trial = _post(f"{base}/v1/trials", {})["id"]
    watcher = ["curl", "-sN", "--max-time", "600", f"{base}/v1/trials/{trial}/events"]
    subprocess.Popen(watcher, stdout=subprocess.DEVNULL)


def _simulate(base: str) -> None:
    """One more simulation in the queue, if none runs."""
    if not json.loads(_get(f"{base}/v1/jobs?state=running&kind=simulation"))["items"]:
        program = json.loads(_get(f"{base}/v1/programs"))["items"][0]["id"]
        _post(f"{base}/v1/simulations", {"program_id": program, "rate_hz": 100.0})


def _load(url: str, seconds: int) -> Load:
    command = ["wrk", "-t1", f"-c{CONNECTIONS}", f"-d{seconds}s", "--latency", url]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    if "Non-2xx" in text:
        raise RuntimeError(text)
    rate = re.search(r"Requests/sec:\s+([\d.]+)", text)
    quantiles = dict(re.findall(r"^\s+(\d+)%\s+([\d.]+[mu]?s)$", text, re.MULTILINE))
    if rate is None:
        raise RuntimeError(text)
    return Load(rate=float(rate[1]), p50=_ms(quantiles["50"]), p99=_ms(quantiles["99"]))


def _ms(text: str) -> float:
    number = float(text.rstrip("mus"))
    return number * {"us": 1e-3, "ms": 1.0}.get(text[-2:], 1000.0)


def _get(url: str) -> bytes:
    with urllib.request.urlopen(url, timeout=30.0) as answer:
        body: bytes = answer.read()
    return body


def _post(url: str, body: object = None) -> dict[str, Any]:
    data = b"" if body is None else json.dumps(body).encode()
    headers = {"content-type": "application/json"}
    request = urllib.request.Request(url, data=data, headers=headers, method="POST")
    with urllib.request.urlopen(request, timeout=30.0) as answer:
        found: dict[str, Any] = json.loads(answer.read())
    return found


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    main()
