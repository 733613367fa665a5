"""The data folder: private, and addressed by ids alone."""

import stat
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import NotFound, Unavailable
from service.ids import is_id, new_id
from service.storage.folder import (
    DataFolder,
    FolderAddress,
    known_data_folder,
    open_data_folder,
)


def test_a_new_folder_is_its_owners_alone(data_folder: DataFolder) -> None:
    folders = [
        data_folder.root,
        *(each for each in data_folder.root.iterdir() if each.is_dir()),
    ]
    wanted = {"programs", "files", "jobs", "machines", "materials"}
    assert {each.name for each in folders[1:]} == wanted
    assert {stat.S_IMODE(each.stat().st_mode) for each in folders} == {0o700}


def test_what_others_made_becomes_private_too(tmp_path: Path) -> None:
    root = tmp_path / "shop"
    open_data_folder(root).database.close()
    for folder in (root, root / "programs"):
        folder.chmod(0o775)
    made = [root / "programs" / "x.stpnc", root / "service.db", root / "knowledge.db"]
    other = root / "notes.txt"
    for file in (*made, other):
        file.touch()
        file.chmod(0o664)
    open_data_folder(root).database.close()
    assert {stat.S_IMODE(each.stat().st_mode) for each in made} == {0o600}
    for folder in (root, root / "programs"):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    # What the service does not keep there is not its business.
    assert stat.S_IMODE(other.stat().st_mode) == 0o664


def test_what_is_of_an_id_lies_in_the_folder(data_folder: DataFolder) -> None:
    id = new_id()
    assert data_folder.program_file(id) == data_folder.root / "programs" / f"{id}.stpnc"
    assert data_folder.job_folder(id) == data_folder.root / "jobs" / id


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.one_of(st.text(), st.sampled_from(["..", "../x", "/etc/passwd", "a\0b", "." * 26])))
def test_nothing_but_an_id_becomes_a_path(data_folder: DataFolder, word: str) -> None:
    if not is_id(word):
        with pytest.raises(NotFound):
            data_folder.program_file(word)
        with pytest.raises(NotFound):
            data_folder.job_folder(word)


def test_a_link_is_followed_once_so_that_paths_are_told_alike(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    assert open_data_folder(tmp_path / "link").root == (tmp_path / "real").resolve()


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(Unavailable, match="file"):
        open_data_folder(tmp_path / "file" / "data")


def test_a_folder_that_is_gone_is_not_made_anew(tmp_path: Path) -> None:
    root = tmp_path / "data"
    made = open_data_folder(root)
    assert (
        known_data_folder(FolderAddress(root=str(root), knowledge=made.knowledge)).root
        == made.root
    )
    root.rename(tmp_path / "moved")
    with pytest.raises(Unavailable, match=r"service\.db"):
        known_data_folder(FolderAddress(root=str(root)))
    assert not root.exists()
    root.mkdir()
    with pytest.raises(Unavailable, match=r"service\.db"):
        known_data_folder(FolderAddress(root=str(root)))
    assert not list(root.iterdir())


def test_the_knowledge_base_is_what_is_named_else_the_environments_else_the_folders(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    root = tmp_path / "data"
    assert open_data_folder(root).knowledge == str(root.resolve() / "knowledge.db")
    monkeypatch.setenv("STEPNC_KB", "of-environment.db")
    assert open_data_folder(root).knowledge == "of-environment.db"
    assert open_data_folder(root, knowledge="named.db").knowledge == "named.db"
