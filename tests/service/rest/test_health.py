"""Signs of life."""

import asyncio
import threading
import time
from pathlib import Path

import anyio
import httpx
import pytest
from starlette.concurrency import run_in_threadpool

from service.jobs.runner import BEAT, beat
from service.rest import health
from service.rest.app import application
from service.rest.settings import Settings

READY = {"database": True, "runner": True, "room": True, "threads": True}


def test_a_server_that_works_says_so(client: httpx.Client) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    ready = client.get("/readyz")
    assert (ready.status_code, ready.json()) == (200, READY)
    about = client.get("/v1/about").json()
    assert (about["owner"], about["needs_keys"]) == ("local", False)
    assert "paper002" in about["samples"]


def test_without_a_runner_or_a_database_nothing_is_ready(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    app = application(Settings(data=str(tmp_path / "data")))
    data_folder = app.state.data_folder

    def ready() -> tuple[int, dict[str, bool]]:
        async def ask() -> httpx.Response:
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(
                transport=transport, base_url="http://localhost"
            ) as to:
                return await to.get("/readyz")

        found = asyncio.run(ask())
        return found.status_code, found.json()

    assert ready() == (503, {**READY, "runner": False})
    beat(data_folder)
    assert ready() == (200, READY)
    with data_folder.database.writing() as connection:
        old = time.time() - 6.0 * BEAT
        connection.execute("UPDATE runner SET seen = ?", (old,))
    assert ready() == (503, {**READY, "runner": False})
    beat(data_folder)
    data_folder.root.rename(tmp_path / "moved")
    assert ready() == (503, {**READY, "database": False, "runner": False, "room": False})
    assert not data_folder.root.exists()
    (tmp_path / "moved").rename(data_folder.root)
    assert ready() == (200, READY)
    with data_folder.database.writing() as connection:
        connection.execute("DROP TABLE runner")
    assert ready() == (503, {**READY, "database": False, "runner": False})


def test_without_a_free_thread_nothing_is_ready(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever hangs in all threads of a process leaves its event loop answering."""
    monkeypatch.delenv("STEPNC_KB", raising=False)
    app = application(Settings(data=str(tmp_path / "data")))
    beat(app.state.data_folder)
    is_over = threading.Event()

    async def ask() -> list[tuple[int, bool]]:
        found = []
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as to:
            for seconds in (0.05, 60.0):
                monkeypatch.setattr(health, "READY", seconds)
                answer = await to.get("/readyz")
                found.append((answer.status_code, answer.json()["threads"]))
                is_over.set()
            assert (await to.get("/healthz")).status_code == 200
        return found

    async def hung() -> list[tuple[int, bool]]:
        limit = int(anyio.to_thread.current_default_thread_limiter().total_tokens)
        waiting = [asyncio.create_task(run_in_threadpool(is_over.wait)) for _ in range(limit)]
        await asyncio.sleep(0)
        try:
            return await ask()
        finally:
            is_over.set()
            await asyncio.gather(*waiting)

    assert asyncio.run(hung()) == [(503, False), (200, True)]
