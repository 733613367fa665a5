"""Routes of the repository of runs, over real HTTP."""

import asyncio
import threading
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import uvicorn

from extras.agent.model.http import application
from extras.agent.play import begun, play
from extras.agent.run import listening
from extras.agent.run_routes import with_runs
from extras.agent.runs import RunKeeper, RunRepository
from tests.extras.agent.model.conftest import header, observations, require_valid
from tests.extras.agent.test_run import run_of


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """An agent whose small buffer has forgotten most of its only run."""
    _, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    repository = RunRepository(tmp_path_factory.mktemp("runs"))
    listener = listening("127.0.0.1", 0)
    servers: list[uvicorn.Server] = []

    async def work() -> None:
        agent = begun(run, speed=0.0, size=1000)
        keeper = RunKeeper(agent, repository)
        await play(agent, run, speed=0.0, is_looped=False)
        keeper.close()
        app = with_runs(application(agent), repository)
        config = uvicorn.Config(app, log_config=None, lifespan="off", ws="none")
        servers.append(uvicorn.Server(config))
        await servers[0].serve(sockets=[listener])

    thread = threading.Thread(target=asyncio.run, args=(work(),))
    thread.start()
    host, port = listener.getsockname()
    try:
        httpx.get(f"http://{host}:{port}/probe", timeout=120.0)
        yield f"http://{host}:{port}"
    finally:
        servers[0].should_exit = True
        thread.join(120.0)


@pytest.fixture
def run(url: str) -> dict[str, Any]:
    (run,) = httpx.get(f"{url}/runs").json()["runs"]
    return dict(run)


def test_what_the_buffer_has_forgotten_is_in_the_repository(
    url: str, run: dict[str, Any]
) -> None:
    live = header(require_valid(httpx.get(f"{url}/sample").content, "2.7"))
    assert int(live["firstSequence"]) > 1000
    place, at, seen = f"{url}/runs/{run['id']}", 1, 0
    while True:
        page = require_valid(httpx.get(f"{place}/sample?from={at}&count=3000").content, "2.7")
        found = observations(page)
        if not found:
            break
        seen += len(found)
        at = int(header(page)["nextSequence"])
    assert seen == int(header(page)["lastSequence"])
    assert require_valid(httpx.get(f"{place}/probe").content, "2.7") is not None
    state = require_valid(httpx.get(f"{place}/current").content, "2.7")
    words = [each.text for each in observations(state)]
    assert "PROGRAM_COMPLETED" in words


def test_a_workingstep_is_a_part_of_a_run(url: str, run: dict[str, Any]) -> None:
    (step,) = run["workingsteps"]
    answer = httpx.get(
        f"{url}/runs/{run['id']}/sample",
        params={"workingstep": step["id"], "count": 100_000, "path": "//Linear"},
    )
    assert answer.status_code == 400
    answer = httpx.get(
        f"{url}/runs/{run['id']}/sample",
        params={"workingstep": step["id"], "count": 1000, "path": "//ProcessOccurrence"},
    )
    found = observations(require_valid(answer.content, "2.7"))
    assert found[0].text == step["id"]
    assert int(found[0].get("sequence")) == step["first"]


@pytest.mark.parametrize(
    ("query", "count"),
    [
        ("machine=paper003", 1), ("machine=other", 0), ("part=paper003_case1.stpnc", 1),
        ("part=other", 0), ("workingstep=MILL SLOT", 1), ("workingstep=other", 0),
        ("from=2020-01-01T00:00:00Z", 1), ("to=2020-01-01T00:00:00", 0),
        ("from=2999-01-01T00:00:00Z", 0),
    ],
)  # fmt: skip
def test_runs_are_found_by_machine_part_workingstep_and_time(
    url: str, query: str, count: int
) -> None:
    assert len(httpx.get(f"{url}/runs?{query}").json()["runs"]) == count


@pytest.mark.parametrize(
    ("path", "status", "word"),
    [
        ("/runs?smell=1", 400, "unknown parameter 'smell'; known: from, machine"),
        ("/runs?from=now", 400, "ISO 8601"),
        ("/runs/none", 404, "no run 'none'"),
        ("/runs/none/sample", 404, "no run 'none'"),
    ],
)
def test_a_request_that_cannot_be_answered_says_why(
    url: str, path: str, status: int, word: str
) -> None:
    answer = httpx.get(f"{url}{path}")
    assert answer.status_code == status
    assert word in answer.json()["error"]


def test_runs_are_read_only(url: str, run: dict[str, Any]) -> None:
    assert httpx.post(f"{url}/runs").status_code == 405
    assert httpx.get(f"{url}/runs/{run['id']}").json() == run
    assert httpx.get(f"{url}/runs/{run['id']}/smell").status_code == 404
