"""``stepnc serve --database``: two hosts, one service; and a server that goes away."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import httpx
import pytest

from service.cli.main import main
from service.rest.serve import ServerOptions, serve
from service.rest.settings import Settings
from service.storage import keys
from service.storage.folder import open_data_folder
from service.storage.keys import Role
from stepnc_model.errors import StepNcError
from tests.postgres import Server as Postgres
from tests.postgres import ServerMaker, new_server
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import Server, is_problem, made, over
from tests.service.waiting import until

__all__ = ["new_server"]

DATA = SAMPLE.read_bytes()


@pytest.fixture
def postgres(new_server: ServerMaker) -> Postgres:
    return new_server()


@pytest.fixture
def hosts(postgres: Postgres, tmp_path: Path) -> Iterator[tuple[Server, Server]]:
    words = ("--database", postgres.url, "--files", str(tmp_path / "files"), "--keys")
    shared = open_data_folder(
        tmp_path / "keys", database=postgres.url, files=str(tmp_path / "files")
    )
    keys.create(shared, name="Zoe", roles=frozenset())
    shared.database.close()
    with Server(tmp_path / "a", *words) as first, Server(tmp_path / "b", *words) as second:
        yield first, second


def test_two_hosts_are_one_service_and_outlive_their_database(
    hosts: tuple[Server, Server], postgres: Postgres, tmp_path: Path
) -> None:
    first, second = hosts
    shared = open_data_folder(
        tmp_path / "keys", database=postgres.url, files=str(tmp_path / "files")
    )
    word = keys.create(shared, name="Anna", roles=frozenset({Role.PLANNER, Role.OPERATOR}))
    once = {"idempotency-key": "once"}
    with first.client(word) as one, second.client(word) as other:
        program = made(one.post("/v1/programs", content=DATA, headers=once), 201)
        assert made(other.post("/v1/programs", content=DATA, headers=once), 201) == program
        advice = made(one.post(f"/v1/programs/{program}/advice", json={}))
        result = one.get(over(one, advice)["result"])
        assert other.get(f"/v1/advice/{advice}").content == result.content
        assert other.get(f"/v1/programs/{program}/file").content == DATA
        # Orders and cancels reach the host that runs the trial, whichever it is.
        trial = made(one.post("/v1/trials", json={}))
        for client in (one, other):
            until(partial(is_running, client, trial))
        change = {"inputs": {"axial_depth_mm": 3.5}}
        until(lambda: other.post(f"/v1/trials/{trial}/changes", json=change).is_success)
        until(lambda: depth(one, trial) == 3.5, within=30.0)
        assert other.post(f"/v1/jobs/{trial}/cancel").status_code == 200
        assert over(one, trial)["state"] == "cancelled"
        postgres.stop("immediate")
        for client in (one, other):
            refused = client.get(f"/v1/programs/{program}")
            found = is_problem(refused, 503, "unavailable")
            assert int(refused.headers["retry-after"]) > 0
            assert "stepnc-pg" not in str(found)
            assert client.get("/healthz").status_code == 200
        postgres.start()
        for client in (one, other):
            until(partial(is_ready, client), within=30.0)
            assert client.get(f"/v1/programs/{program}").status_code == 200
        assert over(one, made(other.post("/v1/reviews", json={})))["state"] == "succeeded"
    shared.database.close()


def depth(client: httpx.Client, trial: str) -> float:
    """Axial depth of a running trial; 0 before it has shown anything."""
    found = client.get(f"/v1/trials/{trial}/status").json()
    return float(found["inputs"]["axial_depth_mm"]) if found else 0.0


def is_running(client: httpx.Client, id: str) -> bool:
    return bool(client.get(f"/v1/jobs/{id}").json()["state"] == "running")


def is_ready(client: httpx.Client) -> bool:
    return client.get("/readyz").status_code == 200


def test_a_host_without_the_shared_files_is_refused(postgres: Postgres, tmp_path: Path) -> None:
    def start(name: str) -> None:
        settings = Settings(data=str(tmp_path / name), database=postgres.url, needs_keys=True)
        serve(ServerOptions(settings=settings, workers=1, jobs=1))

    # The first one only lacks a key.
    with pytest.raises(StepNcError, match="requires keys, but none exists"):
        start("a")
    with pytest.raises(StepNcError, match="name the folder that they share with --files"):
        start("b")


def test_keys_are_those_of_the_database(
    postgres: Postgres, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    def run(*words: str) -> object:
        with pytest.raises(SystemExit) as stopped:
            main(["keys", *words, "--data", str(tmp_path / words[0])])
        return stopped.value.code

    assert run("create", "--for", "Anna", "--database", postgres.url) == 0
    capsys.readouterr()
    monkeypatch.setenv("STEPNC_DATABASE", postgres.url)
    assert run("list") == 0
    assert "Anna" in capsys.readouterr().out
    assert run("list", "--database", "postgresql://u:sesame@127.0.0.1:1/d") not in {0, None}
    told = capsys.readouterr().err
    assert "cannot connect to the server" in told
    assert "sesame" not in told
