"""Counts and times of requests for Prometheus; of several processes together."""

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
"""environment variable of prometheus-client: where several processes count together"""

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
STREAMS = Gauge("stepnc_streams", "Clients that watch a run now", multiprocess_mode="livesum")
JOBS = Gauge("stepnc_jobs", "Jobs by state", ("state",), multiprocess_mode="mostrecent")

TYPE = CONTENT_TYPE_LATEST


@lru_cache(maxsize=4096)
def _counters(method: str, route: str, status: int) -> tuple[Counter, Histogram]:
    """Looked up once: the library's own look-up takes longer than counting."""
    return REQUESTS.labels(method, route, status), SECONDS.labels(route)


def count(method: str, route: str, status: int, seconds: float) -> None:
    """One request more."""
    requests, times = _counters(method, route, status)
    requests.inc()
    times.observe(seconds)


def exposition() -> bytes:
    """All of it as text."""
    if SHARED not in os.environ:
        return generate_latest(REGISTRY)
    registry = CollectorRegistry()
    MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
    return generate_latest(registry)
