"""Storage of uploaded programs: their unchanged bytes, and their names."""

import hashlib
import time
from dataclasses import dataclass

from service.errors import Conflict, NotFound
from service.files import write_atomically
from service.ids import new_id
from service.inputs.program_kind import ProgramKind
from service.storage.connection import StoredRow
from service.storage.folder import DataFolder
from service.storage.idempotency import IdempotencyKey, made_before, remember
from service.storage.pages import Page, PageCursor, page_of
from stepnc_model.errors import StepNcError

LONGEST_NAME = 120

FILE = "file of program"
"""Name of the resource in the error when the bytes of a program are missing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredProgram:
    """Uploaded program."""

    id: str
    name: str
    """Name given by the owner; never part of a path."""
    size: int
    """Size of the file, in bytes."""
    sha256: str
    owner: str
    created: float
    """Time of upload, in s since 1970."""
    kind: ProgramKind = ProgramKind.STEP_NC


def add(
    data_folder: DataFolder,
    data: bytes,
    *,
    name: str,
    owner: str,
    kind: ProgramKind = ProgramKind.STEP_NC,
    idempotency: IdempotencyKey | None = None,
) -> StoredProgram:
    """Store a program; its bytes are written before it appears in lists."""
    program = StoredProgram(
        id=new_id(),
        name=shown_name(name),
        size=len(data),
        sha256=hashlib.sha256(data).hexdigest(),
        owner=owner,
        created=time.time(),
        kind=kind,
    )
    place = data_folder.program_file(program.id)
    write_atomically(place, data)
    kept = ""
    try:
        data_folder.publish(place)
        with data_folder.database.writing() as connection:
            known = made_before(connection, idempotency)
            if known is None:
                connection.execute(
                    "INSERT INTO programs (id, name, size, sha256, owner, created, kind) "
                    "VALUES (?, ?, ?, ?, ?, ?, ?)",
                    (
                        program.id, program.name, program.size, program.sha256,
                        program.owner, program.created, program.kind.value,
                    ),
                )  # fmt: skip
                remember(connection, idempotency, program.id)
        kept = known or program.id
    finally:
        if kept != program.id:
            data_folder.discard(place)
    return program if kept == program.id else get(data_folder, kept)


def get(data_folder: DataFolder, id: str) -> StoredProgram:
    """Return a program by its id.

    Raises
    ------
    NotFound
        When the program does not exist.
    """
    with data_folder.database.reading() as connection:
        row = connection.execute("SELECT * FROM programs WHERE id = ?", (id,)).fetchone()
    if row is None:
        raise NotFound("program", id)
    return _program(row)


def require_kind(data_folder: DataFolder, id: str, kind: ProgramKind) -> StoredProgram:
    """Return a program of a kind.

    Raises
    ------
    NotFound, StepNcError
        When the program does not exist, or is of another kind.
    """
    program = get(data_folder, id)
    if program.kind is not kind:
        raise StepNcError(
            f"program '{program.name}' is {program.kind.words}; this needs {kind.words}"
        )
    return program


def require_file(data_folder: DataFolder, id: str) -> None:
    """Refuse a program whose bytes are missing.

    Raises
    ------
    NotFound
        When the bytes or the program do not exist.
    """
    get(data_folder, id)
    if not data_folder.fetched(data_folder.program_file(id)).is_file():
        raise NotFound(FILE, id)


def listed(data_folder: DataFolder, place: PageCursor) -> Page[StoredProgram]:
    """List programs page by page, newest first."""
    with data_folder.database.reading() as connection:
        rows = connection.execute(
            "SELECT * FROM programs WHERE id < ? ORDER BY id DESC LIMIT ?",
            (place.before, place.limit + 1),
        ).fetchall()
    return page_of(
        [_program(row) for row in rows], [row["id"] for row in rows], limit=place.limit
    )


def remove(data_folder: DataFolder, id: str) -> None:
    """Delete a program; results made from it are kept.

    Raises
    ------
    NotFound, Conflict
        When the program does not exist, or a job still uses it.
    """
    with data_folder.database.writing() as connection:
        # No job may be queued meanwhile.
        connection.lock(f"program {id}")
        busy = connection.execute(
            "SELECT id FROM jobs WHERE program = ? AND state IN ('queued', 'running')", (id,)
        ).fetchone()
        if busy is not None:
            raise Conflict(f"job '{busy['id']}' uses program '{id}': cancel it first")
        gone = connection.execute("DELETE FROM programs WHERE id = ?", (id,)).rowcount
        if not gone:
            raise NotFound("program", id)
    data_folder.discard(data_folder.program_file(id))


def shown_name(name: str) -> str:
    """Return a name in one line without folders; ``program.stpnc`` if nothing is left."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    clean = "".join(letter for letter in last if letter.isprintable()).strip()[:LONGEST_NAME]
    return clean.strip(". ") or "program.stpnc"


def _program(row: StoredRow) -> StoredProgram:
    values = dict(row)
    return StoredProgram(**{**values, "kind": ProgramKind(values["kind"])})
