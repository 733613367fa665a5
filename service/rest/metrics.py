"""Prometheus metrics of requests, jobs and streams, also shared by several processes."""

import os
from functools import lru_cache

from prometheus_client import (
    CONTENT_TYPE_LATEST,
    REGISTRY,
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    generate_latest,
)
from prometheus_client.multiprocess import MultiProcessCollector

SHARED = "PROMETHEUS_MULTIPROC_DIR"
"""Environment variable of prometheus-client with the folder that several processes share."""

REQUESTS = Counter(
    "stepnc_requests_total",
    "Requests by method, route and status",
    ("method", "route", "status"),
)
SECONDS = Histogram(
    "stepnc_request_seconds",
    "Time to answer, s",
    ("route",),
    buckets=(0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0),
)
STREAMS = Gauge("stepnc_streams", "Clients watching a run", multiprocess_mode="livesum")
JOBS = Gauge("stepnc_jobs", "Jobs by state", ("state",), multiprocess_mode="mostrecent")

TYPE = CONTENT_TYPE_LATEST


@lru_cache(maxsize=4096)
def _counters(method: str, route: str, status: int) -> tuple[Counter, Histogram]:
    """Return the metrics of a route from a cache, which is faster than the library."""
    return REQUESTS.labels(method, route, status), SECONDS.labels(route)


def count(method: str, route: str, status: int, seconds: float) -> None:
    """Count a request and record its duration, in s."""
    requests, times = _counters(method, route, status)
    requests.inc()
    times.observe(seconds)


def exposition() -> bytes:
    """Return all metrics in the Prometheus text format."""
    if SHARED not in os.environ:
        return generate_latest(REGISTRY)
    registry = CollectorRegistry()
    MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
    return generate_latest(registry)
