"""A data folder for each test."""

from pathlib import Path

import pytest

from service.depot.folder import Depot, open_depot


@pytest.fixture
def depot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Depot:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    return open_depot(tmp_path / "data")
