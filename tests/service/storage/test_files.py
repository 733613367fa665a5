"""Files: written in pieces, under an id; a name is words of which only the suffix counts."""

import hashlib

import pytest

from extras.agent.replay import DOCUMENTS, LINES
from service.errors import Conflict, NotFound, Unavailable, Unreadable
from service.files import LOGS
from service.ids import new_id
from service.recording.table import TABLES
from service.storage import files, jobs
from service.storage.files import FileKind, FileUpload, StoredFile
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from service.storage.pages import PageCursor
from tests.every_case import every_case


def kept(
    data_folder: DataFolder, *parts: bytes, name: str = "run.csv", kind: FileKind = FileKind.LOG
) -> StoredFile:
    with FileUpload(data_folder, kind, name) as upload:
        for part in parts:
            upload.write(part)
        upload.close()
        return upload.keep(owner="anna")


def left(data_folder: DataFolder) -> list[str]:
    return [path.name for path in (data_folder.root / "files").iterdir()]


def test_a_file_is_kept_byte_for_byte(data_folder: DataFolder) -> None:
    made = kept(data_folder, b"one\n", b"two\n", name="../../Run 1.CSV")
    path = files.require_file(data_folder, made.id, FileKind.LOG)
    assert path.read_bytes() == b"one\ntwo\n"
    assert path.name == f"{made.id}.csv"
    assert made == files.get(data_folder, made.id)
    assert (made.name, made.size, made.owner) == ("Run 1.CSV", 8, "anna")
    assert made.sha256 == hashlib.sha256(b"one\ntwo\n").hexdigest()


def test_what_is_not_kept_leaves_nothing(data_folder: DataFolder) -> None:
    with FileUpload(data_folder, FileKind.LOG, "run.csv") as upload:
        upload.write(b"one")
        assert len(left(data_folder)) == 1
    assert left(data_folder) == []
    assert files.listed(data_folder, PageCursor()).items == ()


def test_what_could_not_be_listed_leaves_no_file(data_folder: DataFolder) -> None:
    with data_folder.database.writing() as connection:
        connection.execute("DROP TABLE files")
    with pytest.raises(Unavailable):
        kept(data_folder, b"x")
    assert left(data_folder) == []


@every_case(
    ("kind", "name"),
    [
        (FileKind.LOG, "run"), (FileKind.LOG, "run.toml"), (FileKind.LOG, "../.csv/"),
        (FileKind.TOOLS, "tools.xlsx"), (FileKind.REQUIRED_PART, "part.obj"),
    ],
)  # fmt: skip
def test_a_suffix_of_another_kind_is_refused(
    data_folder: DataFolder, kind: FileKind, name: str
) -> None:
    with pytest.raises(Unreadable, match=f"the name of a {kind.words} ends in "):
        FileUpload(data_folder, kind, name)


def test_logs_are_what_is_read_as_logs() -> None:
    assert LOGS == TABLES | DOCUMENTS | LINES


def test_files_are_listed_by_kind_page_by_page(data_folder: DataFolder) -> None:
    logs = [kept(data_folder, b"x").id for _ in range(3)]
    part = kept(data_folder, b"x", name="part.stl", kind=FileKind.REQUIRED_PART).id
    first = files.listed(data_folder, PageCursor(limit=2), kind=FileKind.LOG)
    rest = files.listed(
        data_folder, PageCursor(limit=2, cursor=first.cursor), kind=FileKind.LOG
    )
    assert [each.id for page in (first, rest) for each in page.items] == logs[::-1]
    assert rest.cursor is None
    assert files.listed(data_folder, PageCursor()).items[0].id == part
    with pytest.raises(NotFound, match=f"there is no log '{part}'"):
        files.get(data_folder, part, FileKind.LOG)


def test_a_file_that_a_job_uses_stays(data_folder: DataFolder) -> None:
    made = kept(data_folder, b"x")
    request = {"log_id": made.id}
    job = jobs.add(
        data_folder, JobRequest(kind=JobKind.VERIFICATION, request=request, owner="anna")
    )
    with pytest.raises(Conflict, match=f"job '{job.id}' uses log"):
        files.remove(data_folder, made.id)
    jobs.cancel(data_folder, job.id)
    files.remove(data_folder, made.id)
    assert left(data_folder) == []
    with pytest.raises(NotFound):
        files.remove(data_folder, made.id)


def test_content_that_is_gone_is_told(data_folder: DataFolder) -> None:
    made = kept(data_folder, b"x")
    files.file_of(data_folder, made).unlink()
    with pytest.raises(NotFound, match="no content of log"):
        files.require_file(data_folder, made.id, FileKind.LOG)
    with pytest.raises(NotFound, match="no tool table"):
        files.require_file(data_folder, new_id(), FileKind.TOOLS)
