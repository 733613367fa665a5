"""Counts that Prometheus reads, of one process or of several."""

import httpx
from prometheus_client.parser import text_string_to_metric_families as parsed

from service.rest.metrics import TYPE, exposition


def test_the_exposition_is_readable() -> None:
    names = {family.name for family in parsed(exposition().decode())}
    assert {"stepnc_requests", "stepnc_request_seconds", "stepnc_streams"} <= names
    assert TYPE.startswith("text/plain")


def test_requests_are_counted_by_route_and_not_by_path(client: httpx.Client) -> None:
    for number in range(3):
        client.get(f"/v1/jobs/{number:026d}")
        client.get(f"/no/such/path/{number}")
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain; version=")
    samples = [sample for family in parsed(answer.text) for sample in family.samples]
    routes = {sample.labels["route"] for sample in samples if "route" in sample.labels}
    assert {"/v1/jobs/{id}", "unknown"} <= routes
    assert not any("no/such" in route or "000" in route for route in routes)
    found = [
        sample.value
        for sample in samples
        if sample.name == "stepnc_requests_total"
        and sample.labels == {"method": "GET", "route": "/v1/jobs/{id}", "status": "404"}
    ]
    assert len(found) == 1
    assert found[0] >= 3
    states = {sample.labels["state"] for sample in samples if sample.name == "stepnc_jobs"}
    assert states == {"queued", "running", "succeeded", "failed", "cancelled"}
