"""Signs of life."""

import asyncio
import time
from pathlib import Path

import httpx
import pytest

from service.jobs.runner import BEAT, beat
from service.rest.app import application
from service.rest.settings import Settings


def test_a_server_that_works_says_so(client: httpx.Client) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    ready = client.get("/readyz")
    assert (ready.status_code, ready.json()) == (
        200,
        {"database": True, "runner": True, "room": True},
    )
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

    assert ready() == (503, {"database": True, "runner": False, "room": True})
    beat(data_folder)
    assert ready() == (200, {"database": True, "runner": True, "room": True})
    with data_folder.database.writing() as connection:
        old = time.time() - 6.0 * BEAT
        connection.execute("UPDATE runner SET seen = ?", (old,))
    assert ready() == (503, {"database": True, "runner": False, "room": True})
    beat(data_folder)
    data_folder.root.rename(tmp_path / "moved")
    assert ready() == (503, {"database": False, "runner": False, "room": False})
    assert not data_folder.root.exists()
    (tmp_path / "moved").rename(data_folder.root)
    assert ready() == (200, {"database": True, "runner": True, "room": True})
    with data_folder.database.writing() as connection:
        connection.execute("DROP TABLE runner")
    assert ready() == (503, {"database": False, "runner": False, "room": True})
