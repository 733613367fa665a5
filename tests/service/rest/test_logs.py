"""Logs: a line of JSON for everything, and no secret in any of them."""

import json

import httpx

from tests.service.rest.server import Server, create_key
from tests.service.waiting import until


def test_every_line_is_json_and_every_request_has_one(
    service: Server, client: httpx.Client
) -> None:
    client.get("/healthz", headers={"x-request-id": "looked-for"})
    until(lambda: '"looked-for"' in service.log.read_text(encoding="utf-8"))
    lines = [json.loads(line) for line in service.log.read_text(encoding="utf-8").splitlines()]
    [line] = [line for line in lines if line.get("request") == "looked-for"]
    assert (line["event"], line["method"], line["path"]) == ("request", "GET", "/healthz")
    assert (line["status"], line["who"], line["level"]) == (200, "local", "info")
    assert line["seconds"] >= 0.0
    assert line["timestamp"]


def test_a_line_cannot_be_forged(service: Server, client: httpx.Client) -> None:
    client.get("/x%0a%7b%22event%22:%22forged%22%7d", headers={"x-request-id": "forged-1"})
    until(lambda: '"forged-1"' in service.log.read_text(encoding="utf-8"))
    for line in service.log.read_text(encoding="utf-8").splitlines():
        assert json.loads(line)["event"] != "forged"


def test_no_secret_is_logged(service: Server, client: httpx.Client) -> None:
    word = create_key(service, "Anna")
    headers = {"authorization": f"Bearer {word}", "x-request-id": "secret-1"}
    client.get("/healthz", headers=headers)
    until(lambda: '"secret-1"' in service.log.read_text(encoding="utf-8"))
    assert word.rsplit("_", 1)[1] not in service.log.read_text(encoding="utf-8")
