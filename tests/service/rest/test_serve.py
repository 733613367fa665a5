"""The service as it is run: several processes, restarts, crashes, certificates, bounds."""

import os
import shutil
import signal
import ssl
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from subprocess import DEVNULL, run
from threading import Timer

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families as parsed

from kbe.store import open_store
from service.errors import Forbidden
from service.jobs.runner import locked
from service.rest.serve import ServerOptions, serve
from service.rest.settings import Settings
from service.storage.folder import open_data_folder
from stepnc_model.errors import StepNcError
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import Server, create_key, is_problem, made, over
from tests.service.shop import outcomes
from tests.service.waiting import children, ended, is_alive, until

DATA = SAMPLE.read_bytes()


def runs(client: httpx.Client, id: str) -> bool:
    """Whether a job runs."""
    return bool(client.get(f"/v1/jobs/{id}").json()["state"] == "running")


def runner_of(server: Server) -> int:
    """The process that runs jobs."""
    with open_data_folder(server.data).database.reading() as connection:
        return int(connection.execute("SELECT pid FROM runner").fetchone()["pid"])


def test_two_web_processes_and_a_restart_lose_nothing(tmp_path: Path) -> None:
    server = Server(tmp_path, "--workers", "2")
    headers = {"idempotency-key": "once"}
    with server:
        word = create_key(server, "Anna", "planner")
        with server.client() as client:
            programs = {
                made(client.post("/v1/programs", content=DATA, headers=headers), 201)
                for _ in range(6)
            }
            assert len(programs) == 1
            [program] = programs
            advice = made(client.post(f"/v1/programs/{program}/advice", json={}))
            result = client.get(over(client, advice)["result"]).content
            path = {"program_id": program, "pace": 30.0}
            running = made(client.post("/v1/simulations", json=path))
            until(partial(runs, client, running))
            waiting = made(client.post("/v1/evaluations", json={}))
            samples = [
                sample
                for family in parsed(client.get("/metrics").text)
                for sample in family.samples
                if sample.name == "stepnc_requests_total"
                and sample.labels.get("route") == "/v1/programs"
            ]
            assert sum(sample.value for sample in samples) == 6
        assert server.stop() == 0
        server.start()
        with server.client(word) as client:
            assert made(client.post("/v1/programs", content=DATA, headers=headers), 201) == (
                program
            )
            assert client.get(f"/v1/programs/{program}/file").content == DATA
            assert client.get(f"/v1/advice/{advice}").content == result
            again = over(client, running)
            assert (again["state"], again["attempt"]) == ("succeeded", 2)
            assert over(client, waiting)["state"] == "succeeded"
        assert create_key(server, "Bert")
    assert server.faults() == ""
    assert '"event":"request"' in server.log.read_text(encoding="utf-8")


def test_a_killed_web_process_or_runner_is_replaced(tmp_path: Path) -> None:
    with Server(tmp_path) as server, server.client() as client:
        first = runner_of(server)
        program = made(client.post("/v1/programs", content=DATA), 201)
        id = made(client.post("/v1/simulations", json={"program_id": program, "pace": 40.0}))
        until(lambda: client.get(f"/v1/jobs/{id}").json()["state"] == "running")
        os.kill(first, signal.SIGKILL)
        until(lambda: runner_of(server) != first)
        job = over(client, id)
        assert (job["state"], job["attempt"]) == ("succeeded", 2)
        assert client.get("/readyz").status_code == 200


def signalled(server: Server, number: signal.Signals) -> int:
    """Exit code of the process that was started, which alone is told to end."""
    os.kill(server.pid, number)
    assert server._process is not None
    code = ended(server._process)
    server._process = None
    return code


def test_a_stop_frees_the_folder_at_once_and_a_kill_ends_everything(tmp_path: Path) -> None:
    server = Server(tmp_path, "--workers", "2")
    with server:
        with pytest.raises(StepNcError, match="another server is using this folder"):
            serve(ServerOptions(settings=Settings(data=str(server.data)), workers=1, jobs=1))
        assert signalled(server, signal.SIGTERM) == 0
        with locked(server.data):
            """a service manager may start the next one"""
        server.start()
        below = children(server.pid)
        assert signalled(server, signal.SIGKILL) == -signal.SIGKILL
        until(lambda: not any(map(is_alive, below)))
        server.start()


@pytest.fixture
def certificate(tmp_path: Path) -> tuple[Path, Path]:
    """Of 127.0.0.1, signed by itself."""
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("openssl is not installed: no certificate can be made")
    certificate, key = tmp_path / "shop.crt", tmp_path / "shop.key"
    words = [
        openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
        "-nodes", "-days", "2", "-subj", "/CN=localhost",
        "-addext", "subjectAltName=IP:127.0.0.1,DNS:localhost",
        "-keyout", str(key), "-out", str(certificate),
    ]  # fmt: skip
    run(words, check=True, stdout=DEVNULL, stderr=DEVNULL)
    return certificate, key


def test_https_is_served_with_a_certificate(
    tmp_path: Path, certificate: tuple[Path, Path]
) -> None:
    trusted = ssl.create_default_context(cafile=str(certificate[0]))
    words = ("--tls-cert", str(certificate[0]), "--tls-key", str(certificate[1]))
    server = Server(tmp_path / "tls", *words, scheme="https", verify=trusted)
    with server, server.client() as client:
        assert client.get("/v1/about").status_code == 200
        with pytest.raises(httpx.TransportError):
            httpx.get(f"http://127.0.0.1:{server.port}/healthz", trust_env=False)
        with pytest.raises(httpx.ConnectError):
            httpx.get(f"{server.url}/healthz", trust_env=False)


@pytest.fixture
def limited(tmp_path: Path) -> Iterator[Server]:
    with Server(tmp_path, "--rate", "5") as server:
        yield server


def test_too_many_requests_are_told_when_to_come_again(limited: Server) -> None:
    with limited.client() as client:
        answers = [client.get("/v1/about") for _ in range(200)]
        refused = [answer for answer in answers if answer.status_code == 429]
        assert 20 < len(refused) < 150
        for answer in refused:
            found = is_problem(answer, 429, "too-many")
            assert found["wait"] > 0.0
            assert int(answer.headers["retry-after"]) >= found["wait"]
            assert answer.headers["x-content-type-options"] == "nosniff"
        until(lambda: client.get("/v1/about").status_code == 200)


def test_a_host_that_others_reach_needs_a_key_before_it_starts(tmp_path: Path) -> None:
    settings = Settings(data=str(tmp_path), host="0.0.0.0", needs_keys=True)
    with pytest.raises(Forbidden, match="stepnc keys create"):
        serve(ServerOptions(settings=settings, workers=1, jobs=1))
    missing = ServerOptions(
        settings=Settings(data=str(tmp_path)), workers=1, jobs=1,
        certificate=tmp_path / "none.crt", key=tmp_path / "none.key",
    )  # fmt: skip
    with pytest.raises(StepNcError, match="no such file"):
        serve(missing)


@dataclass(kw_only=True)
class Said:
    """What the server has answered. Running state."""

    decisions: dict[int, str] = field(default_factory=dict)
    """who decided last, by the number of the correction"""
    programs: list[str] = field(default_factory=list)
    asked: tuple[int, str] = (0, "")
    """the decision whose answer may never have come"""


def decide_until_it_breaks(
    client: httpx.Client, said: Said, *, numbers: list[int], when: Callable[[], None]
) -> None:
    """Accept, withdraw and upload; something is done after some of it."""
    for count in range(10_000):
        number = numbers[count % len(numbers)]
        verb = ("accept", "withdraw")[count % 2]
        said.asked = number, f"{verb} {len(said.programs)}"
        path, body = f"/v1/corrections/{number}/{verb}", {"by": said.asked[1]}
        try:
            assert client.post(path, json=body).status_code == 200
            said.decisions[number] = said.asked[1]
            said.programs.append(made(client.post("/v1/programs", content=DATA), 201))
        except httpx.TransportError:
            return
        if count == 10:
            when()
    raise AssertionError("it never broke")


def test_nothing_that_was_answered_is_lost_when_all_is_killed(tmp_path: Path) -> None:
    server, said = Server(tmp_path), Said()
    server.data.mkdir(parents=True)
    with open_store(str(server.data / "knowledge.db")) as store:
        store.add(list(outcomes(300)))
    with server:
        with server.client() as client:
            over(client, made(client.post("/v1/reviews", json={})))
            found = client.get("/v1/corrections").json()["corrections"]
            program = made(client.post("/v1/programs", content=DATA), 201)
        for _ in range(2):
            killer = Timer(0.2, server.kill)
            with server.client() as client:
                asked = {"program_id": program, "pace": 40.0}
                running = made(client.post("/v1/simulations", json=asked))
                until(partial(runs, client, running))
                numbers = [each["id"] for each in found]
                decide_until_it_breaks(client, said, numbers=numbers, when=killer.start)
            killer.join(120.0)
            server.start()
            with server.client() as client:
                found = client.get("/v1/corrections").json()["corrections"]
                by = {each["id"]: each["decided_by"] for each in found}
                for number, words in said.decisions.items():
                    assert by[number] == words or (number, by[number]) == said.asked
                for id in said.programs:
                    assert client.get(f"/v1/programs/{id}/file").content == DATA
                assert over(client, running)["state"] == "succeeded"
