"""Storage of uploaded files other than programs: logs, tool tables, required parts and stocks.

Files are written in pieces to a temporary one, so that an upload of any size needs little
memory; a file gets its place, and an entry in lists, once its content was checked.
"""

import hashlib
import os
import tempfile
import time
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import BinaryIO

from service.errors import Conflict, NotFound, Unreadable
from service.files import LOGS
from service.ids import new_id
from service.live.journal import storing
from service.storage.connection import StoredRow
from service.storage.folder import DataFolder
from service.storage.idempotency import IdempotencyKey, made_before, remember
from service.storage.pages import Page, PageCursor, page_of
from service.storage.programs import shown_name

TOOL_TABLES = frozenset({".toml", ".csv", ".tbl", ".json", ".tools", ".hsmlib"})
"""Suffixes of tool tables; the content tells the format."""


PARTS = frozenset({".stl", ".step", ".stp"})
"""Suffixes of required and raw parts; the content tells the format."""


class FileKind(StrEnum):
    """Kind of an uploaded file."""

    LOG = "log"
    """Positions of a run, as a machine logged them."""
    TOOLS = "tools"
    """Tool table: TOML, CSV, LinuxCNC's, or a library of Fusion or HSMWorks."""
    REQUIRED_PART = "required-part"
    """Required part: an STL file, or solids of a STEP file."""
    STOCK = "stock"
    """Raw part: an STL file, or solids of a STEP file."""

    @property
    def suffixes(self) -> frozenset[str]:
        """Suffixes of file names, which tell how the content is read."""
        if self is FileKind.LOG:
            return LOGS
        return TOOL_TABLES if self is FileKind.TOOLS else PARTS

    @property
    def words(self) -> str:
        """Name of the kind in messages."""
        return {"tools": "tool table", "required-part": "required part"}.get(self, self.value)


FIELDS = {
    FileKind.LOG: "log_id", FileKind.TOOLS: "tools_id", FileKind.REQUIRED_PART: "required_id",
    FileKind.STOCK: "stock_id",
}  # fmt: skip
"""Field of a job's request that names a file of each kind."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredFile:
    """Uploaded file."""

    id: str
    kind: FileKind
    name: str
    """Name given by the owner; only its suffix, one of a few, is part of a path."""
    size: int
    """Size of the file, in bytes."""
    sha256: str
    owner: str
    created: float
    """Time of upload, in s since 1970."""

    @property
    def suffix(self) -> str:
        """Suffix of the file."""
        return Path(self.name).suffix.lower()


class FileUpload:
    """File that arrives in pieces. Running state; use it with ``with``.

    Parameters
    ----------
    name : str
        Name given by the owner.

    Raises
    ------
    Unreadable
        When the suffix of the name is none of the kind.
    """

    def __init__(self, data_folder: DataFolder, kind: FileKind, name: str) -> None:
        self.kind, self.name = kind, shown_name(name)
        self.size = 0
        self._data_folder, self._hash = data_folder, hashlib.sha256()
        suffix = Path(self.name).suffix.lower()
        if suffix not in kind.suffixes:
            known = ", ".join(sorted(kind.suffixes))
            raise Unreadable(f"name '{self.name}': the name of a {kind.words} ends in {known}")
        self._suffix = suffix
        self._file: BinaryIO | None = None
        self.path = Path()
        """Temporary file."""

    def __enter__(self) -> "FileUpload":
        with storing(self.name):
            folder = self._data_folder.files / "files"
            descriptor, name = tempfile.mkstemp(prefix=".", suffix=self._suffix, dir=folder)
        self._file, self.path = os.fdopen(descriptor, "wb"), Path(name)
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()
        self.path.unlink(missing_ok=True)

    @property
    def sha256(self) -> str:
        """Hash of the content so far."""
        return self._hash.hexdigest()

    def write(self, part: bytes) -> None:
        """Append a piece.

        Raises
        ------
        StorageFull, Unavailable
            When the disk refuses.
        """
        assert self._file is not None
        with storing(self.name):
            self._file.write(part)
        self._hash.update(part)
        self.size += len(part)

    def close(self) -> None:
        """End the content, so that it can be checked."""
        assert self._file is not None
        with storing(self.name):
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()

    def keep(self, *, owner: str, idempotency: IdempotencyKey | None = None) -> StoredFile:
        """Store the closed file.

        Raises
        ------
        StorageFull, Unavailable
            When the disk or the database refuses.
        """
        stored = StoredFile(
            id=new_id(),
            kind=self.kind,
            name=self.name,
            size=self.size,
            sha256=self.sha256,
            owner=owner,
            created=time.time(),
        )
        place = file_of(self._data_folder, stored)
        with storing(self.name):
            self.path.replace(place)
        kept = ""
        try:
            self._data_folder.publish(place)
            with self._data_folder.database.writing() as connection:
                known = made_before(connection, idempotency)
                if known is None:
                    connection.execute(
                        "INSERT INTO files VALUES (?, ?, ?, ?, ?, ?, ?)",
                        (
                            stored.id, stored.kind.value, stored.name, stored.size,
                            stored.sha256, stored.owner, stored.created,
                        ),
                    )  # fmt: skip
                    remember(connection, idempotency, stored.id)
            kept = known or stored.id
        finally:
            if kept != stored.id:
                self._data_folder.discard(place)
        return stored if kept == stored.id else get(self._data_folder, kept)


def file_of(data_folder: DataFolder, stored: StoredFile) -> Path:
    """Path of a stored file."""
    return data_folder.files / "files" / f"{stored.id}{stored.suffix}"


def get(data_folder: DataFolder, id: str, kind: FileKind | None = None) -> StoredFile:
    """Return a file by its id, and of a given kind if one is named.

    Raises
    ------
    NotFound
        When the file does not exist.
    """
    with data_folder.database.reading() as connection:
        row = connection.execute("SELECT * FROM files WHERE id = ?", (id,)).fetchone()
    if row is None or (kind is not None and row["kind"] != kind.value):
        raise NotFound("file" if kind is None else kind.words, id)
    return _stored(row)


def require_file(data_folder: DataFolder, id: str, kind: FileKind) -> Path:
    """Return the path of a file of a kind.

    Raises
    ------
    NotFound
        When the file or its content does not exist.
    """
    path = data_folder.fetched(file_of(data_folder, get(data_folder, id, kind)))
    if not path.is_file():
        raise NotFound(f"content of {kind.words}", id)
    return path


def listed(
    data_folder: DataFolder, place: PageCursor, *, kind: FileKind | None = None
) -> Page[StoredFile]:
    """List files page by page, newest first."""
    where, values = "id < ?", [place.before]
    if kind is not None:
        where, values = f"{where} AND kind = ?", [*values, kind.value]
    with data_folder.database.reading() as connection:
        rows = connection.execute(
            f"SELECT * FROM files WHERE {where} ORDER BY id DESC LIMIT ?",
            (*values, place.limit + 1),
        ).fetchall()
    return page_of(
        [_stored(row) for row in rows], [row["id"] for row in rows], limit=place.limit
    )


def remove(data_folder: DataFolder, id: str) -> None:
    """Delete a file; results made from it are kept.

    Raises
    ------
    NotFound, Conflict
        When the file does not exist, or a job still uses it.
    """
    stored = get(data_folder, id)
    with data_folder.database.writing() as connection:
        # No job may be queued meanwhile.
        connection.lock(f"file {id}")
        busy = connection.execute(
            "SELECT id FROM jobs WHERE state IN ('queued', 'running') "
            f"AND json_extract(request, '$.{FIELDS[stored.kind]}') = ?",
            (id,),
        ).fetchone()
        if busy is not None:
            words = stored.kind.words
            raise Conflict(f"job '{busy['id']}' uses {words} '{id}': cancel it first")
        if not connection.execute("DELETE FROM files WHERE id = ?", (id,)).rowcount:
            raise NotFound("file", id)
    data_folder.discard(file_of(data_folder, stored))


def _stored(row: StoredRow) -> StoredFile:
    columns = dict(row)
    return StoredFile(**{**columns, "kind": FileKind(columns["kind"])})
