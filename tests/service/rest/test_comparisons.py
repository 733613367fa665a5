"""Advice on one program side by side over REST."""

import httpx
import pytest

from tests.service.rest.conftest import Done
from tests.service.rest.server import made, over


def test_two_plans_of_a_program_are_compared(client: httpx.Client, done: Done) -> None:
    path = f"/v1/programs/{done.program}/advice"
    other = made(client.post(path, json={"machine": "vmc15", "free": ["feed"]}))
    assert over(client, other)["state"] == "succeeded"
    answer = client.get("/v1/comparisons", params={"advice": [done.advice, other]})
    assert answer.status_code == 200
    found = answer.json()
    advised = client.get(f"/v1/advice/{done.advice}").json()
    assert found["plans"][0]["time_s"] == pytest.approx(advised["total_time_s"]["after"])
    assert len(found["workingsteps"]) == 2 * len(advised["workingsteps"])
    assert found["differences"]


def test_one_plan_or_an_unknown_one_is_refused(client: httpx.Client, done: Done) -> None:
    one = client.get("/v1/comparisons", params={"advice": [done.advice]})
    assert one.status_code == 422
    unknown = "0" * len(done.advice)
    answer = client.get("/v1/comparisons", params={"advice": [done.advice, unknown]})
    assert answer.status_code == 404
