"""Monitors over REST: a real server, and a real agent that is ended and started again."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.monitor.source import source_of
from service.rest.serve import ServerOptions, serve
from service.rest.settings import Settings
from service.rest.views import (
    ComparisonView,
    MonitorStatusView,
    MonitorView,
    SeriesView,
)
from stepnc_model.errors import StepNcError
from tests.extras.agent.test_run import PARTS
from tests.service.monitor.played import PlayedAgent, looped
from tests.service.rest.server import Server, create_key, is_problem, made, over
from tests.service.waiting import until

PART = PARTS / "paper003_case1.stpnc"
ONE = "/v1/monitors/paper003"


@pytest.fixture(scope="module")
def agent() -> Iterator[PlayedAgent]:
    with PlayedAgent(*looped()) as found:
        yield found


@pytest.fixture(scope="module")
def server(agent: PlayedAgent, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("monitors")
    with Server(folder, "--agent", f"paper003={agent.url}") as found:
        yield found
        assert found.faults() == ""


@pytest.fixture
def client(server: Server) -> Iterator[httpx.Client]:
    with server.client() as found:
        yield found


def status(client: httpx.Client) -> dict[str, Any]:
    """Status of the monitor, as the document describes it."""
    answer = client.get(ONE)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    assert MonitorStatusView.model_validate(found).model_dump(mode="json") == found
    return found


def is_(client: httpx.Client, freshness: str) -> bool:
    return bool(status(client)["freshness"] == freshness)


def test_a_monitored_machine_is_listed_and_shown(
    client: httpx.Client, agent: PlayedAgent
) -> None:
    until(lambda: is_(client, "fresh"))
    [found] = client.get("/v1/monitors").json()
    assert MonitorView.model_validate(found).model_dump(mode="json") == found
    assert (found["name"], found["url"], found["state"]) == ("paper003", agent.url, "connected")
    assert found["age_s"] < 2.0
    assert found["availability"] == "AVAILABLE"
    shown = status(client)
    assert shown["program"] == shown["run"]["program"] == "paper003_case1.stpnc"
    assert shown["latest"]["total_power_w"] > 300.0
    assert shown["time_zero"].endswith("+00:00")


def test_recent_rows_have_the_form_of_a_run(client: httpx.Client) -> None:
    until(lambda: status(client)["rows"] > 20)
    answer = client.get(f"{ONE}/rows?signals=x_mm,total_power_w&points=5")
    found = answer.json()
    SeriesView.model_validate(found)
    assert answer.headers["etag"]
    assert list(found["signals"]) == ["x_mm", "total_power_w"]
    assert len(found["begin_s"]) == 5
    assert found["is_growing"]
    every = client.get(f"{ONE}/rows").json()
    assert {"feed_actual_mm_min", "spindle_power_w", "workingstep"} <= set(every["signals"])
    is_problem(client.get(f"{ONE}/rows?signals=nothing"), 404)
    is_problem(client.get(f"{ONE}/rows?begin_s=5&end_s=1"), 400)


def test_what_is_not_monitored_is_not_found(client: httpx.Client) -> None:
    for path in ("", "/rows", "/events", f"/comparison?simulation={'0' * 26}"):
        is_problem(client.get(f"/v1/monitors/vmc15{path}"), 404)
    is_problem(client.get(f"{ONE}/comparison?simulation={'0' * 26}"), 404)
    is_problem(client.get(f"{ONE}/comparison?simulation=x"), 422)
    is_problem(client.get(f"{ONE}/comparison"), 422)


def test_events_tell_rows_and_status(client: httpx.Client) -> None:
    names: set[str] = set()
    with client.stream("GET", f"{ONE}/events") as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        name = ""
        for line in answer.iter_lines():
            if line.startswith("event: "):
                name = line.removeprefix("event: ")
            elif line.startswith("data: "):
                content = json.loads(line.removeprefix("data: "))
                names.add(name)
                if name == "status":
                    MonitorStatusView.model_validate(content)
                else:
                    assert content["columns"]["time_s"][-1] > 0.0
            if names == {"status", "rows"}:
                break


def test_a_machine_is_compared_with_a_simulation(client: httpx.Client) -> None:
    program = made(
        client.post("/v1/programs?name=paper003_case1.stpnc", content=PART.read_bytes()), 201
    )
    asked = {"program_id": program, "machine": "paper003"}
    simulation = made(client.post("/v1/simulations", json=asked))
    over(client, simulation)
    found = client.get(f"{ONE}/comparison?simulation={simulation}").json()
    assert ComparisonView.model_validate(found).model_dump(mode="json") == found
    assert found["machine"] == "paper003"
    assert found["program"] == found["measured_program"]
    result = client.get(f"/v1/simulations/{simulation}").json()["workingsteps"]
    steps = {step["id"]: step for step in found["workingsteps"]}
    assert list(steps) == [row["id"] or "" for row in result]
    for row in result:
        step = steps[row["id"] or ""]
        assert step["predicted_time_s"] == pytest.approx(row["time_s"], abs=1e-6)
        if step["state"] == "done":
            assert step["time_ratio"] == pytest.approx(1.0, abs=0.05)
    if status(client)["run"]["begin_s"] is not None:
        assert found["parts"][0]["begin_s"] == 0.0


def test_data_get_old_when_the_agent_ends_and_fresh_when_it_is_back(
    client: httpx.Client, agent: PlayedAgent
) -> None:
    until(lambda: is_(client, "fresh"))
    agent.stop()
    try:
        until(lambda: status(client)["state"] == "lost")
        found = status(client)
        assert found["freshness"] == "stale"
        assert found["problem"]
        assert found["latest"]["total_power_w"] > 0.0
        until(lambda: status(client)["age_s"] > 1.5)
    finally:
        agent.start()
    until(lambda: is_(client, "fresh"))
    assert status(client)["problem"] is None


def test_a_viewer_may_watch_and_nobody_else(agent: PlayedAgent, tmp_path: Path) -> None:
    words = ("--keys", "--workers", "2", "--agent", f"paper003={agent.url}")
    (tmp_path / "data").mkdir()
    server = Server(tmp_path, *words)
    key = create_key(server, "Anna", "viewer")
    with server, server.client(key) as client:
        until(lambda: client.get(ONE).json()["state"] == "connected")
        assert httpx.get(f"{server.url}{ONE}", trust_env=False).status_code == 401
    assert server.faults() == ""


def test_an_agent_needs_a_machine_of_the_library_or_the_shop(tmp_path: Path) -> None:
    settings = Settings(data=str(tmp_path), agents=(source_of("mill9=http://127.0.0.1:9"),))
    with pytest.raises(StepNcError, match=r"--agent mill9=.*: unknown machine 'mill9'; known"):
        serve(ServerOptions(settings=settings, workers=1, jobs=1))
