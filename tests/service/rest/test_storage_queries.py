"""A database that falls silent: who needs it is told so in time, and nobody else waits."""

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from service.rest.app import application
from service.rest.rate import SharedRateLimit
from service.rest.settings import Settings
from service.storage import server_database
from tests.postgres import Server, ServerMaker, new_server
from tests.service.rest.server import is_problem
from tests.service.waiting import children

__all__ = ["new_server"]

ASKED = 20
"""Requests that need the database: more than there are threads for it."""


def signalled(server: Server, number: signal.Signals) -> None:
    """Send a signal to all processes of a server."""
    first = int((server.folder / "data" / "postmaster.pid").read_text("ascii").split()[0])
    for pid in (first, *children(first)):
        # Its processes come and go.
        with suppress(ProcessLookupError):
            os.kill(pid, number)


def be_patient(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    """How long the service waits for its database."""
    monkeypatch.setattr(server_database, "WAIT", seconds)
    monkeypatch.setattr(server_database.Raw, "patience", seconds)
    monkeypatch.setattr(server_database, "PAUSE", 0.1)
    monkeypatch.setattr(server_database, "CONNECT_TIMEOUT", 2)


def within(app: FastAPI, act: Callable[[httpx.AsyncClient], Awaitable[None]]) -> None:
    async def run() -> None:
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as to:
            await act(to)

    asyncio.run(run())


def test_a_database_that_falls_silent_holds_up_nobody_else(
    new_server: ServerMaker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    be_patient(monkeypatch, 300.0)
    server = new_server()
    app = application(Settings(data=str(tmp_path / "data"), database=server.url))

    async def act(to: httpx.AsyncClient) -> None:
        assert (await to.get("/v1/programs")).status_code == 200
        signalled(server, signal.SIGSTOP)
        try:
            waiting = [asyncio.create_task(to.get("/v1/programs")) for _ in range(ASKED)]
            # They run until they wait for the database.
            await asyncio.sleep(0)
            for _ in range(10):
                assert (await to.get("/healthz")).status_code == 200
            assert not [task for task in waiting if task.done()]
        finally:
            signalled(server, signal.SIGCONT)
        assert {each.status_code for each in await asyncio.gather(*waiting)} == {200}
        be_patient(monkeypatch, 1.0)
        signalled(server, signal.SIGSTOP)
        try:
            waiting = [asyncio.create_task(to.get("/v1/programs")) for _ in range(ASKED)]
            for answer in await asyncio.gather(*waiting):
                is_problem(answer, 503, "unavailable")
                assert int(answer.headers["retry-after"]) > 0
            assert (await to.get("/readyz")).status_code == 503
        finally:
            signalled(server, signal.SIGCONT)
        async with asyncio.timeout(30.0):
            while (await to.get("/v1/programs")).status_code != 200:
                await asyncio.sleep(0)

    within(app, act)
    app.state.data_folder.database.close()


def test_a_rate_limit_without_its_database_is_one_of_the_process(
    new_server: ServerMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    be_patient(monkeypatch, 1.0)
    monkeypatch.setattr("service.rest.rate.PATIENCE", 0.1)
    server = new_server()
    database = server_database.ServerDatabase(server.url)
    limit = SharedRateLimit(database, 1.0, burst=5)
    signalled(server, signal.SIGSTOP)
    try:
        asyncio.run(limit.take("anna"))
    finally:
        signalled(server, signal.SIGCONT)
    database.close()
