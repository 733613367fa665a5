"""``stepnc serve --database``: two hosts, one service; and a server that goes away."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import psycopg
import pytest
from sqlalchemy.engine import make_url

from service.cli.main import main
from service.rest.serve import ServerOptions, serve
from service.rest.settings import Settings
from service.storage import keys
from service.storage.folder import open_data_folder
from service.storage.keys import Role
from service.storage.server_database import ServerDatabase
from simulator.library import DATA as LIBRARY
from stepnc_model.errors import StepNcError
from tests.extras.factory.shops import TIMED
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.postgres import Server as Postgres
from tests.postgres import ServerMaker, new_server
from tests.service.rest.samples import SAMPLE, SLOT
from tests.service.rest.server import Server, is_problem, made, over
from tests.service.waiting import until

__all__ = ["new_server"]

DATA = SAMPLE.read_bytes()


@pytest.fixture
def postgres(new_server: ServerMaker) -> Postgres:
    return new_server()


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Two hosts on one database, and a key that opens both."""

    first: Server
    second: Server
    word: str


@contextmanager
def pair(postgres: Postgres, folder: Path, files: str) -> Iterator[Pair]:
    words = ("--database", postgres.url, "--files", files, "--keys")
    shared = open_data_folder(folder / "keys", database=postgres.url, files=files)
    word = keys.create(shared, name="Anna", roles=frozenset({Role.PLANNER, Role.OPERATOR}))
    shared.database.close()
    with Server(folder / "a", *words) as first, Server(folder / "b", *words) as second:
        yield Pair(first=first, second=second, word=word)
        assert first.faults() + second.faults() == ""


def test_two_hosts_are_one_service_and_outlive_their_database(
    postgres: Postgres, tmp_path: Path
) -> None:
    log = slot_log(tmp_path / "run.parquet", lower=0.1).read_bytes()
    with pair(postgres, tmp_path, str(tmp_path / "files")) as hosts:
        require_each_kind(hosts, log)
        require_one_service(hosts, postgres)


def require_one_service(hosts: Pair, postgres: Postgres) -> None:
    first, second, word = hosts.first, hosts.second, hosts.word
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
        until(lambda: depth(one, trial) == 3.5)
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
            until(partial(is_ready, client))
            assert client.get(f"/v1/programs/{program}").status_code == 200
        assert over(one, made(other.post("/v1/reviews", json={})))["state"] == "succeeded"


def test_hosts_with_a_store_of_files_are_one_service(
    postgres: Postgres, tmp_path: Path
) -> None:
    log = slot_log(tmp_path / "run.parquet", lower=0.1).read_bytes()
    with pair(postgres, tmp_path, f"file://{tmp_path}/store") as hosts:
        require_each_kind(hosts, log)
        require_one_place(hosts)


def require_each_kind(hosts: Pair, log: bytes) -> None:
    """Each kind of work is ordered on one host and read from the other."""
    with hosts.first.client(hosts.word) as one, hosts.second.client(hosts.word) as other:
        slot = SLOT.read_bytes()
        program = made(one.post("/v1/programs?name=slot.stpnc", content=slot), 201)
        file = made(other.post("/v1/files?name=run.parquet", content=log), 201)
        machine = (LIBRARY / "machines" / f"{SLOT_MACHINE}.toml").read_bytes()
        assert one.put("/v1/machines/own", content=machine).status_code == 200
        assert until(lambda: other.get("/v1/machines/own").is_success)
        logged = {"program_id": program, "log_id": file, "machine": "own"}
        shop = {"shop": TIMED.format(hours=1)}
        asked: dict[str, tuple[httpx.Client, str, dict[str, Any], tuple[str, ...]]] = {
            "advice": (one, f"/v1/programs/{program}/advice", {"machine": "own"},
                       ("", "/file", "/report")),
            "verifications": (other, "/v1/verifications", {**logged, "cell_mm": 0.5},
                              ("", "/map", "/places", "/report")),
            "cycle-times": (one, "/v1/cycle-times", logged, ("", "/report")),
            "factories": (other, "/v1/factories", {**shop, "replications": 2},
                          ("", "/figures", "/report", "/samples")),
            "simulations": (one, "/v1/simulations", {"program_id": program, "machine": "own"},
                            ("", "/path", "/series", "/samples", "/report")),
            "reviews": (other, "/v1/reviews", {}, ("",)),
            "evaluations": (one, "/v1/evaluations", {}, ("", "/table", "/report")),
        }  # fmt: skip
        ids = {
            name: made(client.post(path, json=body))
            for name, (client, path, body, _) in asked.items()
        }
        live = made(one.post("/v1/factories", json={**shop, "pace": 1000.0}))
        for name, (client, _, _, parts) in asked.items():
            job = over(client, ids[name])
            assert job["state"] == "succeeded", job
            for part in parts:
                path = f"/v1/{name}/{ids[name]}{part}"
                answers = [each.get(path) for each in (one, other)]
                assert [each.status_code for each in answers] == [200, 200], path
                assert answers[0].content == answers[1].content, path
        assert over(one, live)["state"] == "succeeded"
        for part in ("", "/status", "/log", "/states", "/series", "/parts/mill-1"):
            answers = [each.get(f"/v1/factories/{live}{part}") for each in (one, other)]
            assert [each.status_code for each in answers] == [200, 200], answers[0].text
            assert answers[0].content == answers[1].content, part


def require_one_place(hosts: Pair) -> None:
    """Without a shared folder, a run that goes on is told about by the host that runs it."""
    with hosts.first.client(hosts.word) as one, hosts.second.client(hosts.word) as other:
        trial = made(one.post("/v1/trials", json={}))
        clients = (one, other)
        until(lambda: is_running(one, trial))
        until(lambda: any(is_shown(each, trial) for each in clients))
        said = sorted(each.get(f"/v1/trials/{trial}/status").status_code for each in clients)
        assert said == [200, 409]
        change = {"inputs": {"axial_depth_mm": 3.5}}
        said = sorted(
            each.post(f"/v1/trials/{trial}/changes", json=change).status_code
            for each in clients
        )
        assert said == [202, 409]
        assert other.post(f"/v1/jobs/{trial}/cancel").status_code == 200
        assert over(one, trial)["state"] == "cancelled"


def depth(client: httpx.Client, trial: str) -> float:
    """Axial depth of a running trial; 0 before it has shown anything."""
    found = client.get(f"/v1/trials/{trial}/status").json()
    return float(found["inputs"]["axial_depth_mm"]) if found else 0.0


def is_shown(client: httpx.Client, trial: str) -> bool:
    found = client.get(f"/v1/trials/{trial}/status")
    return found.status_code == 200 and found.json() is not None


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


@pytest.mark.parametrize(
    ("url", "told"),
    [
        ("shop.db", "--database a file name: write postgresql://USER@HOST/DATABASE"),
        ("mysql://shop:sesame@h/d", "--database mysql://…: write postgresql://"),
        ("postgresql://shop:sesame@127.0.0.1:1/shop", "cannot connect to the server"),
        ("wrong password", "password authentication failed"),
        ("newer", "of version 99; this program supports up to"),
    ],
)
def test_a_database_that_cannot_be_used_is_one_line_and_nothing_is_made(
    postgres: Postgres, tmp_path: Path, capsys: pytest.CaptureFixture[str], url: str, told: str
) -> None:
    if url == "newer":
        with ServerDatabase(postgres.url).writing() as connection:
            connection.execute("INSERT INTO version VALUES (99)")
        url = postgres.url
    if url == "wrong password":
        url = with_password(postgres, "sesame")
    words = ["serve", "--data", str(tmp_path / "data"), "--port", "0", "--database", url]
    with pytest.raises(SystemExit) as stopped:
        main(words)
    said = capsys.readouterr().err
    assert stopped.value.code == 3
    assert told in said
    assert len(said.strip().splitlines()) == 1
    assert "sesame" not in said
    assert not (tmp_path / "data").exists()


def with_password(postgres: Postgres, wrong: str) -> str:
    """Address with a password that the server refuses."""
    with psycopg.connect(postgres.url, autocommit=True) as connection:
        connection.execute("CREATE ROLE shop LOGIN PASSWORD 'right'")
    rules = postgres.folder / "data" / "pg_hba.conf"
    rules.write_text(f"local all shop scram-sha-256\n{rules.read_text('utf-8')}", "utf-8")
    postgres.run("pg_ctl", "reload")
    place = make_url(postgres.url).set(username="shop", password=wrong)
    return place.render_as_string(hide_password=False)
