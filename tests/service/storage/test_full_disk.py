"""A service whose disk is full can be read, and goes on when there is room."""

from pathlib import Path

import pytest

from service.errors import Unavailable
from service.jobs.runner import beat, is_alive
from service.knowledge.verbs import require_usable
from service.live.journal import has_room
from service.storage import jobs
from service.storage.folder import open_data_folder
from tests.full_disk import files_of_at_most


def test_a_data_folder_on_a_full_disk_is_opened_and_read(tmp_path: Path) -> None:
    first = open_data_folder(tmp_path)
    beat(first)
    require_usable(first.knowledge)
    first.database.close()
    with files_of_at_most(0):
        opened = open_data_folder(tmp_path)
        assert is_alive(opened)
        assert not jobs.counts(opened)
        assert "the disk is full" in require_usable(opened.knowledge)
        assert not has_room(tmp_path)
        with pytest.raises(Unavailable):
            beat(opened)
    beat(opened)
    assert is_alive(opened)
    assert not require_usable(opened.knowledge)
    assert has_room(tmp_path)
    opened.database.close()


def test_a_folder_that_is_new_needs_room(tmp_path: Path) -> None:
    with files_of_at_most(0), pytest.raises(Unavailable):
        open_data_folder(tmp_path)
