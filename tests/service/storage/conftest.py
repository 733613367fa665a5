"""A data folder for each test: once with a file, once with a database on a server."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.storage.folder import DataFolder, open_data_folder
from tests.postgres import new_database, new_server, postgres_url

__all__ = ["new_database", "new_server", "postgres_url"]


@pytest.fixture(params=["sqlite", "postgresql"])
def data_folder(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[DataFolder]:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    database = "" if request.param == "sqlite" else request.getfixturevalue("new_database")
    made = open_data_folder(tmp_path / "data", database=database)
    yield made
    made.database.close()
