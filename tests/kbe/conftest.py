"""Outcomes made by hand, and stores in SQLite and in a private PostgreSQL server."""

import os
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from itertools import count
from pathlib import Path
from typing import Protocol

import psycopg
import pytest

from kbe.store import Store, open_store
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    LearnedCorrection,
    ProcessOutcome,
)
from tests.postgres import new_server, postgres_url

__all__ = ["new_server", "postgres_url"]

NOON = datetime(2026, 3, 5, 12, 0, tzinfo=UTC)

POCKET = ProcessOutcome(
    context=Context(machine="vmc15", material="C45", tool="endmill 16"),
    program="part.stpnc",
    workingstep="WS ROUGH POCKET",
    feature=FeatureFacts(id="POCKET1", kind="closed_pocket", length=80.0, width=50.0),
    is_finishing=False,
    mode="TC",
    specific_force=1700.0,
    cutting_speed=3000.0,
    step_depth=EvaluatedQuantity(predicted=4.0, measured=4.0),
    feed_per_tooth=EvaluatedQuantity(predicted=0.1, measured=0.08),
    immersion=FaceMillingImmersion.FULL_IMMERSION,
    strategy="contour_parallel",
    roughness=EvaluatedQuantity(predicted=0.0016),
    time=EvaluatedQuantity(predicted=50.0, measured=55.0),
    force=EvaluatedQuantity(predicted=800.0, measured=900.0),
    feed=EvaluatedQuantity(predicted=16.0, measured=14.0),
    force_bound=950.0,
    force_ratio=ForceRatio(log_mean=0.12, log_deviation=0.05, readings=2200),
    trace="run-1.parquet",
    run="run-1",
    recorded_at=NOON,
    recorded_by="virtual machine",
)

PROPOSAL = LearnedCorrection(
    context=POCKET.context,
    log_centre=0.12,
    log_scale=0.03,
    degrees=7.5,
    outcomes=8,
    confidence=0.97,
    proposed_at=NOON,
)


class OutcomeMaker(Protocol):
    """Makes so many outcomes of one run, a minute apart; each has a workingstep of its own."""

    def __call__(self, number: int, *, run: str = "run-1") -> list[ProcessOutcome]: ...


def made(number: int, *, run: str = "run-1") -> list[ProcessOutcome]:
    return [
        replace(
            POCKET,
            run=run,
            workingstep=f"{run} WS{index}",
            recorded_at=NOON + timedelta(minutes=index),
        )
        for index in range(number)
    ]


@pytest.fixture(scope="session")
def outcome() -> ProcessOutcome:
    return POCKET


@pytest.fixture(scope="session")
def proposal() -> LearnedCorrection:
    return PROPOSAL


@pytest.fixture(scope="session")
def outcomes() -> OutcomeMaker:
    return made


SCHEMAS = count()


class UrlMaker(Protocol):
    """Names a place where no store is yet."""

    def __call__(self) -> str: ...


@pytest.fixture
def postgres_place(postgres_url: str) -> Iterator[UrlMaker]:
    schemas: list[str] = []

    def place() -> str:
        schema = f"test_{os.getpid()}_{next(SCHEMAS)}"
        with psycopg.connect(postgres_url, autocommit=True) as connection:
            connection.execute(f"CREATE SCHEMA {schema}")
        schemas.append(schema)
        joint = "&" if "?" in postgres_url else "?"
        return f"{postgres_url}{joint}options=-csearch_path%3D{schema}"

    yield place
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        for schema in schemas:
            connection.execute(f"DROP SCHEMA {schema} CASCADE")


@pytest.fixture
def sqlite_place(tmp_path: Path) -> UrlMaker:
    numbers = count()
    return lambda: str(tmp_path / f"store-{next(numbers)}.db")


@pytest.fixture(params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest) -> UrlMaker:
    """Names new places: once in SQLite, once in PostgreSQL."""
    kind = "sqlite_place" if request.param == "sqlite" else "postgres_place"
    made: UrlMaker = request.getfixturevalue(kind)
    return made


@pytest.fixture
def url(place: UrlMaker) -> str:
    return place()


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    """A new store: once in SQLite, once in PostgreSQL."""
    with open_store(url) as opened:
        yield opened
