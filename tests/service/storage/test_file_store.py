"""Hosts that share a store of files instead of a folder: what one has written, others read."""

import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from service.errors import Conflict, NotFound, PreconditionFailed, Unavailable
from service.rest.results import live_folder
from service.storage import file_store, files, jobs, library, programs
from service.storage.file_store import FileStore
from service.storage.files import FileKind, FileUpload, StoredFile
from service.storage.folder import DataFolder, open_data_folder, require_shared_files
from service.storage.jobs import JobKind, JobRequest, JobState
from service.storage.library import LibrarySection
from simulator.library import DATA
from tests.service.waiting import environment

MACHINES = LibrarySection.MACHINES
MACHINE = (DATA / "machines" / "vmc15.toml").read_bytes()
OTHER = MACHINE + b"\n# changed\n"
ORDER = JobRequest(kind=JobKind.REVIEW, request={}, owner="anna")

Hosts = tuple[DataFolder, DataFolder]


@pytest.fixture
def hosts(
    new_database: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Hosts]:
    monkeypatch.setattr(file_store, "FRESH", 0.0)
    first, second = (
        open_data_folder(
            tmp_path / name, database=new_database, files=f"file://{tmp_path}/store"
        )
        for name in ("a", "b")
    )
    for each in (first, second):
        require_shared_files(each)
    yield first, second
    for each in (first, second):
        each.database.close()


def stored(folder: Path) -> list[str]:
    """Files in the store, without the mark."""
    found = [path for path in (folder / "store").rglob("*") if path.is_file()]
    return sorted(path.name for path in found if not path.name.startswith("."))


def test_a_program_is_read_by_the_other_host_and_deleted_for_both(
    hosts: Hosts, tmp_path: Path
) -> None:
    first, second = hosts
    made = programs.add(first, b"ISO-10303-21;", name="part.stpnc", owner="anna")
    assert stored(tmp_path) == [f"{made.id}.stpnc"]
    programs.require_file(second, made.id)
    assert second.program_file(made.id).read_bytes() == b"ISO-10303-21;"
    assert second.program_file(made.id) != first.program_file(made.id)
    programs.remove(second, made.id)
    assert stored(tmp_path) == []
    with pytest.raises(NotFound):
        programs.require_file(first, made.id)


def kept(data_folder: DataFolder, content: bytes) -> StoredFile:
    with FileUpload(data_folder, FileKind.LOG, "run.csv") as upload:
        upload.write(content)
        upload.close()
        return upload.keep(owner="anna")


def test_an_upload_is_read_by_the_other_host_and_deleted_for_both(
    hosts: Hosts, tmp_path: Path
) -> None:
    first, second = hosts
    made = kept(first, b"a,b")
    assert files.require_file(second, made.id, FileKind.LOG).read_bytes() == b"a,b"
    files.remove(first, made.id)
    assert stored(tmp_path) == []
    with pytest.raises(NotFound):
        files.require_file(second, made.id, FileKind.LOG)


def test_a_machine_of_the_shop_is_the_same_on_all_hosts(hosts: Hosts) -> None:
    first, second = hosts
    library.put(first, MACHINES, "own", MACHINE)
    assert library.one(second, MACHINES, "own").text == MACHINE
    assert Path(library.machine_word(second, "own")).read_bytes() == MACHINE
    library.put(second, MACHINES, "own", OTHER, condition=lambda text: text == MACHINE)
    with pytest.raises(PreconditionFailed):
        library.put(first, MACHINES, "own", MACHINE, condition=lambda text: text == MACHINE)
    assert library.one(first, MACHINES, "own").text == OTHER
    library.remove(first, MACHINES, "own")
    assert "own" not in {each.name for each in library.entries_of(second, MACHINES)}
    with pytest.raises(NotFound):
        library.one(second, MACHINES, "own")


def test_the_attempt_that_the_database_names_is_read_whoever_wrote_last(
    hosts: Hosts, tmp_path: Path
) -> None:
    first, second = hosts
    id = jobs.add(first, ORDER).id
    old = jobs.claim(first, runner="a")
    assert old is not None
    assert jobs.begin(first, old)
    write(first, old, "old")
    jobs.recover(second, [old])
    new = jobs.claim(second, runner="b")
    assert new is not None
    assert jobs.begin(second, new)
    write(second, new, "new")
    jobs.finish(second, new, JobState.SUCCEEDED)
    # The first host goes on, and ends too late.
    write(first, old, "old")
    jobs.finish(first, old, JobState.SUCCEEDED)
    for host in hosts:
        found = host.fetched(host.job_folder(id) / "result.json")
        assert found.read_text("utf-8") == "new"
    assert stored(tmp_path) == ["result.json", "result.json"]
    jobs.remove(first, id)
    assert stored(tmp_path) == []
    with pytest.raises(NotFound):
        second.job_folder(id)


def write(data_folder: DataFolder, job: jobs.Job, text: str) -> None:
    folder = data_folder.attempt_folder(job.id, job.attempt)
    (folder / "result.json").write_text(text, "utf-8")
    assert data_folder.store is not None
    data_folder.store.publish_folder(folder)


def test_a_run_is_followed_where_it_runs_and_everywhere_once_it_has_ended(
    hosts: Hosts,
) -> None:
    first, second = hosts
    id = jobs.add(first, ORDER).id
    job = jobs.claim(first, runner="a")
    assert job is not None
    assert jobs.begin(first, job)
    live_folder(first, job).write_status({"time_s": 1.0})
    with pytest.raises(Conflict, match=f"'{id}' runs on another host"):
        live_folder(second, job)
    write(first, job, "{}")
    jobs.finish(first, job, JobState.SUCCEEDED)
    assert live_folder(second, jobs.get(second, id)).read_status() == {"time_s": 1.0}


class Broken(BytesIO):
    """Breaks off after some bytes."""

    def read(self, size: int | None = -1) -> bytes:
        if self.tell():
            raise OSError("broken")
        return super().read(3)


def test_what_breaks_off_leaves_the_store_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    path = tmp_path / "here" / "x"
    store = FileStore(f"file://{tmp_path}/store", tmp_path / "here")
    path.write_bytes(b"whole")
    store.publish(path)
    with monkeypatch.context() as patched:
        patched.setattr(Path, "open", lambda *_: Broken(b"other"))
        with pytest.raises(Unavailable, match="the store of files does not answer"):
            store.publish(path)
    assert store.read("x") == b"whole"
    assert store.read("y") is None
    path.unlink()
    store.fetch(path)
    assert path.read_bytes() == b"whole"
    store.fetch(tmp_path / "here" / "y")
    assert [each.name for each in (tmp_path / "here").iterdir()] == ["x"]


def test_a_store_that_refuses_keeps_no_half_of_a_program(hosts: Hosts, tmp_path: Path) -> None:
    first, _ = hosts
    shutil.rmtree(tmp_path / "store")
    (tmp_path / "store").write_text("in the way", "utf-8")
    with pytest.raises(Unavailable, match="the store of files does not answer") as refused:
        programs.add(first, b"x", name="x", owner="anna")
    assert str(tmp_path) not in str(refused.value)
    assert list((first.files / "programs").iterdir()) == []
    with first.database.reading() as connection:
        assert connection.execute("SELECT id FROM programs").fetchall() == []


def test_the_memory_of_a_process_behaves_like_other_stores(tmp_path: Path) -> None:
    store = FileStore("memory://bench/x", tmp_path)
    (tmp_path / "jobs").mkdir()
    (tmp_path / "jobs" / "a").write_bytes(b"1")
    (tmp_path / "jobs" / ".partial").write_bytes(b"1")
    store.publish_folder(tmp_path / "jobs")
    (tmp_path / "jobs" / "a").unlink()
    store.mirror(tmp_path / "jobs")
    assert sorted(path.name for path in (tmp_path / "jobs").iterdir()) == [".partial", "a"]
    store.remove(tmp_path / "jobs")
    store.remove(tmp_path / "jobs")
    store.mirror(tmp_path / "jobs", at_once=True)
    assert [path.name for path in (tmp_path / "jobs").iterdir()] == [".partial"]


def test_other_stores_than_those_of_the_other_hosts_are_refused(
    hosts: Hosts, tmp_path: Path
) -> None:
    url = hosts[0].address.database
    for files_, told in (
        (f"file://{tmp_path}/other", "name the folder that they share with --files"),
        ("memory://x", "only one process sees these files"),
    ):
        other = open_data_folder(tmp_path / "c", database=url, files=files_)
        with pytest.raises(Unavailable, match=told):
            require_shared_files(other)
        other.database.close()
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"files": "file:///x"}, "--files file://… needs --database"),
        ({"files": "nonsense://u:sesame@x", "database": "postgresql://h/d"},
         "--files nonsense://…: Protocol not known"),
    ],
)  # fmt: skip
def test_a_location_that_is_none_is_told(
    words: dict[str, Any], told: str, tmp_path: Path
) -> None:
    with pytest.raises(Unavailable, match=told) as refused:
        open_data_folder(tmp_path / "data", **words)
    assert "sesame" not in str(refused.value)
    assert "service.db" not in str(list(tmp_path.rglob("*")))


WITHOUT = """
import sys
sys.modules["fsspec"] = None
from service.cli.main import main
main(["keys", "list", "--data", sys.argv[1], "--database", "postgresql://u@h/d",
      "--files", "s3://x"])
"""


def test_a_package_that_is_not_installed_is_named(tmp_path: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT, str(tmp_path)],
        capture_output=True, text=True, timeout=120.0, check=False,
    )  # fmt: skip
    assert ended.returncode == 3
    assert "pip install 'stepnc-optimiser[files]'" in ended.stderr
    assert "Traceback" not in ended.stderr


SILENT = """
import sys
from pathlib import Path
from service.errors import Unavailable
from service.storage import file_store
file_store.S3["read_timeout"] = 0.2
store = file_store.FileStore("s3://shop/stepnc", Path(sys.argv[1]))
try:
    store.read("mark")
except Unavailable as error:
    print(error)
"""


def test_a_bucket_that_falls_silent_is_told_in_time(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        found = subprocess.run(
            [sys.executable, "-c", SILENT, str(tmp_path)],
            env={
                **environment(tmp_path),
                "AWS_ENDPOINT_URL": f"http://127.0.0.1:{silent.getsockname()[1]}",
                "AWS_ACCESS_KEY_ID": "test",
                "AWS_SECRET_ACCESS_KEY": "test",
                "AWS_DEFAULT_REGION": "us-east-1",
            },
            capture_output=True, text=True, timeout=120.0, check=True,
        )  # fmt: skip
    assert found.stdout == "the store of files does not answer: ReadTimeoutError\n"


class ClientFault(Exception):
    """Error of a store's own client, which is no ``OSError``."""


def test_whatever_the_client_of_a_store_raises_is_told_but_not_our_own_faults(
    tmp_path: Path,
) -> None:
    store = FileStore(f"file://{tmp_path}/store", tmp_path)
    with pytest.raises(Unavailable, match="does not answer: ClientFault"), store._answering():
        raise ClientFault
    with pytest.raises(TypeError), store._answering():
        raise TypeError
