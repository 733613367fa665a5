"""A data folder for each test."""

from pathlib import Path

import pytest

from service.storage.folder import DataFolder, open_data_folder


@pytest.fixture
def data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> DataFolder:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    return open_data_folder(tmp_path / "data")
