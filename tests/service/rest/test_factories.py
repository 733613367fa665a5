"""``/v1/factories`` and ``/v1/shops``: shops that run live or with replications."""

import csv
import io
import re
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from tests.every_case import every_case
from tests.extras.factory.shops import TIMED
from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem, made, over
from tests.service.waiting import until

SHOP: dict[str, Any] = {
    "title": "Two mills",
    "hours": 3,
    "machine": [
        {"name": "saw", "idle_power_w": 200},
        {"name": "mill", "count": 2, "idle_power_w": 500},
    ],
    "buffer": [{"name": "WIP", "capacity": 2}],
    "product": [
        {
            "name": "plate",
            "batch": 2,
            "step": [
                {"machines": ["saw"], "time_s": 60, "power_w": 1000, "into": "WIP"},
                {
                    "machines": ["mill"],
                    "time_s": {"kind": "uniform", "low": 200, "high": 300},
                    "power_w": 2000,
                },
            ],
        }
    ],
}


def shop(**words: Any) -> dict[str, Any]:
    return {**SHOP, **words}


@pytest.fixture
def live(client: httpx.Client) -> Iterator[str]:
    """A shop that runs at a pace until the test is over."""
    body = {"shop": shop(hours=1000), "pace": 200.0}
    id = made(client.post("/v1/factories", json=body))
    until(lambda: client.get(f"/v1/factories/{id}/status").json() is not None)
    yield id
    client.post(f"/v1/factories/{id}/cancel")
    over(client, id)


def machine(client: httpx.Client, id: str, name: str) -> dict[str, Any]:
    rows = client.get(f"/v1/factories/{id}/status").json()["machines"]
    found: dict[str, Any] = next(row for row in rows if row["name"] == name)
    return found


def test_a_live_shop_obeys_and_its_failure_counts(client: httpx.Client, live: str) -> None:
    path = f"/v1/factories/{live}"
    failure = {"failure": {"machine": "saw", "repair_min": 5.0}, "pace": 150.0}
    assert client.post(f"{path}/changes", json=failure).status_code == 202
    until(lambda: machine(client, live, "saw")["state"] == "repair")
    assert client.get(f"{path}/status").json()["pace"] == 150.0
    until(lambda: machine(client, live, "saw")["state"] != "repair")
    kinds = [event["kind"] for event in client.get(f"{path}/log").json()["events"]]
    assert kinds[:4] == ["order", "failed", "repair", "repaired"]
    series = client.get(f"{path}/series", params={"signals": "power_kw,power_w:saw"}).json()
    assert series["is_growing"]
    assert max(series["signals"]["power_w:saw"]["high"]) == pytest.approx(1000.0)
    states = client.get(f"{path}/states").json()
    saw = states["machines"][0]
    assert saw["name"] == "saw"
    assert "repair" in saw["state"]
    assert saw["begin_s"][1:] == saw["end_s"][:-1]
    is_problem(client.get(path), 409)
    assert client.post(f"{path}/changes", json={"is_ended": True}).status_code == 202
    assert over(client, live)["state"] == "succeeded"
    result = client.get(path).json()
    (repair,) = [row for row in result["states"] if row["state"] == "repair"]
    assert repair["machine"] == "saw"
    assert repair["hours"] == pytest.approx(5.0 / 60.0, rel=1e-6)
    is_problem(client.post(f"{path}/changes", json={"pace": 1.0}), 409, "conflict")


def test_an_impossible_order_is_refused(client: httpx.Client, live: str) -> None:
    path = f"/v1/factories/{live}/changes"
    for body in (
        {"failure": {"machine": "lathe", "repair_min": 5.0}},
        {"failure": {"machine": "saw", "repair_min": 0.0}},
        {"failure": {"machine": "saw", "repair_min": 1e9}},
        {"failure": {"machine": "saw"}},
        {"pace": 0.0},
        {"pace": 1e9},
        {"surprise": 1},
    ):
        is_problem(client.post(path, json=body), 422)
    before = len(client.get(f"/v1/factories/{live}/log").json()["events"])
    failure = {"failure": {"machine": "mill-1", "repair_min": 5000.0}}
    for _ in range(2):
        assert client.post(path, json=failure).status_code == 202

    def refused() -> bool:
        events = client.get(f"/v1/factories/{live}/log").json()["events"][before:]
        return any("cannot fail now" in event["text"] for event in events)

    until(refused)


def test_status_and_rows_are_streamed(client: httpx.Client, live: str) -> None:
    names = set()
    with client.stream("GET", f"/v1/factories/{live}/events") as answer:
        for line in answer.iter_lines():
            if line.startswith("event: "):
                names.add(line.removeprefix("event: "))
            if {"job", "status", "rows"} <= names:
                break
    assert {"job", "status", "rows"} <= names


@pytest.fixture(scope="module")
def finished(service: Any) -> str:
    """A shop that was run with replications and a sweep."""
    with service.client() as client:
        body = {
            "shop": SHOP, "replications": 3, "seed": 5, "warm_up_hours": 0.5,
            "sweep": ["product[1].batch=1,4"],
        }  # fmt: skip
        id = made(client.post("/v1/factories", json=body))
        job = over(client, id)
        assert job["state"] == "succeeded", job
    return id


def test_replications_and_a_sweep_give_intervals(client: httpx.Client, finished: str) -> None:
    result = client.get(f"/v1/factories/{finished}").json()
    assert (result["replications"], len(result["sweep"])) == (3, 2)
    good = next(
        each
        for each in result["measures"]
        if (each["level"], each["quantity"]) == ("line", "good parts/h")
    )
    assert good["count"] == 3
    assert good["half_width"] > 0.0
    assert finished in {job["id"] for job in client.get("/v1/factories").json()["items"]}
    is_problem(client.post(f"/v1/factories/{finished}/changes", json={"pace": 1.0}), 409)


def test_tables_report_and_states_are_downloaded(client: httpx.Client, finished: str) -> None:
    path = f"/v1/factories/{finished}"
    assert client.get(f"{path}/report").text.startswith("<!DOCTYPE html>")
    assert client.get(f"{path}/samples").content.startswith(b"PAR1")
    figures = list(csv.DictReader(io.StringIO(client.get(f"{path}/figures").text)))
    assert {row["level"] for row in figures} >= {"line", "machine", "process", "buffer"}
    parts = list(csv.DictReader(io.StringIO(client.get(f"{path}/parts/mill-1").text)))
    assert parts[0]["machiningpower_w"] == "2000"
    for name in ("lathe", "%2e%2e", "%2e%2e%2ffigures", "states.parquet"):
        assert client.get(f"{path}/parts/{name}").status_code == 404
    assert client.get(f"{path}/status").json() is None
    is_problem(client.get(f"{path}/states"), 409)


def test_a_shop_file_is_taken_as_text(client: httpx.Client) -> None:
    id = made(client.post("/v1/factories", json={"shop": TIMED.format(hours=1)}))
    assert over(client, id)["state"] == "succeeded"
    assert client.get(f"/v1/factories/{id}").json()["shop"] == "Sawing, then milling"


def test_an_uploaded_program_is_run_by_its_id(client: httpx.Client, done: Done) -> None:
    steps = [{"machines": ["mill"], "program": done.program}]
    body = {
        "shop": {
            "hours": 2,
            "machine": [{"name": "mill", "machine": "vmc15"}],
            "product": [{"name": "part", "step": steps}],
        },
        "pace": 1000.0,
    }
    id = made(client.post("/v1/factories", json=body))
    job = over(client, id)
    assert job["state"] == "succeeded", job
    assert machine(client, id, "mill")["program"] == "part.stpnc"


def test_sample_shops_are_listed_and_run(client: httpx.Client) -> None:
    shops = {each["name"]: each for each in client.get("/v1/shops").json()}
    assert shops["line"]["title"] == "Turning, then milling"
    assert "[[machine]]" in shops["line"]["text"]
    id = made(client.post("/v1/factories", json={"sample": "line", "hours": 2, "pace": 1000}))
    job = over(client, id)
    assert job["state"] == "succeeded", job
    assert client.get(f"/v1/factories/{id}").json()["warm_up_hours"] == 0.0


MACHINES = [{"name": "m", "count": 10_000}, {"name": "n", "count": 10_000}]
STEP = {"machines": ["saw"], "time_s": 1}


@every_case(
    ("body", "text"),
    [
        ({}, "either a shop or a sample"),
        ({"shop": SHOP, "sample": "line"}, "either a shop or a sample"),
        ({"shop": "machine = 1"}, "machine"),
        ({"shop": "[[["}, "not valid TOML"),
        ({"shop": shop(surprise=1)}, "surprise"),
        ({"shop": shop(machine=MACHINES)}, "exceed 10000"),
        ({"shop": shop(machine=[{"name": "saw", "count": 300}])}, "unknown 'mill'"),
        (
            {"shop": {**SHOP, "machine": [*SHOP["machine"], {"name": "x", "count": 300}]}},
            "at most 200",
        ),
        ({"shop": shop(hours=500_000)}, "simulated hours"),
        ({"shop": SHOP, "hours": 100_000, "replications": 3}, "of all runs"),
        ({"shop": SHOP, "replications": 501}, "equal to 500"),
        ({"shop": SHOP, "pace": 5000}, "pace"),
        ({"shop": SHOP, "pace": 10, "replications": 2}, "no replications"),
        ({"shop": SHOP, "sweep": ["x=1"]}, None),
        (
            {"shop": shop(product=[{"name": "p", "batch": 1e6, "step": [STEP]}])},
            "parts of a batch",
        ),
        (
            {"shop": shop(product=[{"name": "p", "arrival_min": 1e-9, "step": [STEP]}])},
            "that arrive",
        ),
        (
            {"shop": shop(product=[{"name": "p", "step": [STEP] * 101}])},
            "101 steps",
        ),
        (
            {
                "shop": shop(
                    machine=[
                        *SHOP["machine"],
                        {"name": "x", "failure": [{"every_h": 1e-9, "repair_min": 0}]},
                    ]
                )
            },
            "between failures",
        ),
        (
            {"shop": shop(machine=[*SHOP["machine"], {"name": "x", "machine": "/etc/passwd"}])},
            "unknown machine '/etc/passwd'",
        ),
        ({"shop": "x = '" + "a" * 70_000 + "'"}, None),
    ],
)  # fmt: skip
def test_hostile_shops_are_refused(
    client: httpx.Client, body: dict[str, Any], text: str | None
) -> None:
    answer = client.post("/v1/factories", json=body)
    if text is None:
        # Refused at once or when the job begins, but not run.
        assert answer.status_code in {202, 413, 422}
        if answer.status_code == 202:
            assert over(client, answer.json()["id"])["state"] == "failed"
        return
    problem = is_problem(answer, 400 if text.startswith("either") else 422)
    assert re.search(text, problem["detail"]), problem["detail"]


def test_no_file_of_the_server_is_named_by_a_client(client: httpx.Client) -> None:
    for word in ("/etc/passwd", "../../../../etc/passwd", "nothing.stpnc", "0" * 26):
        steps = [{"machines": ["mill"], "program": word}]
        body = {
            "shop": {
                "machine": [{"name": "mill", "machine": "vmc15"}],
                "product": [{"name": "p", "step": steps}],
            }
        }
        is_problem(client.post("/v1/factories", json=body), 404)
    is_problem(client.post("/v1/factories", json={"sample": "../line"}), 404)


def test_a_run_in_which_no_time_passes_ends(client: httpx.Client) -> None:
    steps = [{"machines": ["saw"], "time_s": 0}]
    body = {"shop": shop(product=[{"name": "p", "batches": 1e9, "step": steps}])}
    job = over(client, made(client.post("/v1/factories", json=body)))
    assert job["state"] == "failed"
    assert "no time passes: 20000 parts are made at once" in job["problem"]["detail"]


def test_a_run_with_replications_is_cancelled(client: httpx.Client) -> None:
    body = {"shop": shop(hours=2000), "replications": 60}
    id = made(client.post("/v1/factories", json=body))
    until(lambda: client.get(f"/v1/jobs/{id}").json()["state"] == "running")
    until(lambda: client.get(f"/v1/jobs/{id}").json()["share"] > 0.0)
    assert client.post(f"/v1/factories/{id}/cancel").status_code == 200
    assert over(client, id)["state"] == "cancelled"
