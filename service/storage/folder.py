"""Data folder of the service; paths consist of ids only, never of names given by users.

With a database on a server, several hosts share one folder of files. Each attempt of a job then
writes into a folder of its own, and the job's folder is a link to the current one: a host that
was taken for dead, and goes on, changes nothing that anybody reads. Instead of a folder they
may share a store of files: attempts are then copied to it before their end is recorded, and
the database alone says which one counts.
"""

import os
import shutil
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from stat import S_IMODE, S_ISLNK

from service.errors import NotFound, Unavailable
from service.files import write_atomically
from service.ids import is_id, new_id
from service.knowledge.place import named_place
from service.live.journal import storing
from service.optional_packages import how_to_install
from service.storage.connection import Database
from service.storage.database import FileDatabase
from service.storage.file_store import FileStore, is_store

OTHERS = 0o077
"""Rights of other users."""

PRIVATE = 0o700
PRIVATE_FILE = 0o600

FOLDERS = ("programs", "files", "jobs", "machines", "materials")
"""Folders below the folder of files."""

MARK = ".stepnc-files"
"""Name of the file with the identity of the folder of files."""

DATABASE = "service.db"


@dataclass(frozen=True, slots=True, kw_only=True)
class FolderAddress:
    """Names by which a process opens a data folder."""

    root: str
    """Path of the folder."""
    files: str = ""
    """Folder of files, or URL of a store of files; empty: the data folder."""
    database: str = ""
    """Address of a server; empty: a file in the folder."""
    knowledge: str = ""
    """Location of the knowledge base; empty: from the environment, else in the database of the
    server or in the folder."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DataFolder:
    """Data folder of the service, with its database."""

    root: Path
    """Folder of this host."""
    files: Path
    """Folder of programs, results and library; shared by all hosts of a database, or copies
    of what they share in a store."""
    store: FileStore | None = None
    """Store of files that the hosts share instead of a folder."""
    database: Database
    knowledge: str
    """Location of the knowledge base."""
    address: FolderAddress

    def program_file(self, id: str) -> Path:
        """Path of an uploaded program.

        Raises
        ------
        NotFound
            When the id has no valid form.
        """
        _require_id("program", id)
        return self.files / "programs" / f"{id}.stpnc"

    def job_folder(self, id: str) -> Path:
        """Folder of a job's results; raises the same errors as :meth:`program_file`."""
        _require_id("job", id)
        if self.store is None:
            return self.files / "jobs" / id
        with self.database.reading() as connection:
            row = connection.execute("SELECT attempt FROM jobs WHERE id = ?", (id,)).fetchone()
        if row is None:
            raise NotFound("job", id)
        return self.attempt_folder(id, row["attempt"])

    def run_folder(self, id: str, attempt: int) -> Path:
        """Folder of a job whose current attempt is known, which saves asking for it."""
        return self.job_folder(id) if self.store is None else self.attempt_folder(id, attempt)

    def attempt_folder(self, id: str, attempt: int) -> Path:
        """Folder into which an attempt of a job writes."""
        _require_id("job", id)
        folder = self.files / "jobs" / id
        return folder.with_name(f"{id}.{attempt}") if self.database.is_shared else folder

    def fetched(self, path: Path) -> Path:
        """Return a path below the folder of files; a file in a store is copied there.

        Raises
        ------
        Unavailable
            When the store does not answer.
        """
        if self.store is not None:
            self.store.fetch(path)
        return path

    def publish(self, path: Path) -> None:
        """Show a file to the other hosts; in a folder that they share, they see it anyway.

        Raises
        ------
        Unavailable
            When the store does not answer.
        """
        if self.store is not None:
            self.store.publish(path)

    def discard(self, path: Path) -> None:
        """Delete a file here and in the store; failures are ignored."""
        with suppress(OSError):
            path.unlink(missing_ok=True)
        if self.store is not None:
            with suppress(Unavailable):
                self.store.remove(path)


def open_data_folder(
    root: Path, *, knowledge: str = "", database: str = "", files: str = ""
) -> DataFolder:
    """Open the data folder; create it if it does not exist. Names as in the address.

    Raises
    ------
    Unavailable
        When the folder cannot be created, or its database cannot be opened.
    """
    address = FolderAddress(root=str(root), files=files, database=database, knowledge=knowledge)
    # Nothing is made for a server that does not answer.
    made = _data_folder(address) if database else None
    root, place = _folders(address)
    for folder, named in ((root, root), *((place / name, place) for name in FOLDERS)):
        try:
            folder.mkdir(mode=PRIVATE, parents=True, exist_ok=True)
        except OSError as error:
            raise Unavailable(f"{named}: {error.strerror or error}") from error
    found = made or _data_folder(address)
    for folder in {root, place}:
        _make_private(folder)
    return found


def _make_private(root: Path) -> None:
    """Take the rights of others off a data folder and what the service keeps in it.

    What belongs to another user is left alone: only that user may change it.
    """
    _restrict(root, PRIVATE)
    for path in root.glob(f"{DATABASE}*"), root.glob("knowledge.db*"), root.glob(MARK):
        for file in path:
            _restrict(file, PRIVATE_FILE)
    for name in FOLDERS:
        for folder, _, files in os.walk(root / name):
            _restrict(Path(folder), PRIVATE)
            for file_name in files:
                _restrict(Path(folder, file_name), PRIVATE_FILE)


def _restrict(path: Path, mode: int) -> None:
    """Take rights off a file or folder; links, and what others own, stay as they are."""
    with suppress(OSError):
        found = path.lstat().st_mode
        if found & OTHERS and not S_ISLNK(found):
            path.chmod(S_IMODE(found) & mode)


def known_data_folder(address: FolderAddress) -> DataFolder:
    """Open an existing data folder; one that was moved away is not created again.

    Raises
    ------
    Unavailable
        When the folder does not exist, or its database cannot be opened.
    """
    root, files = _folders(address)
    if address.database:
        for folder in (root, *(files / name for name in FOLDERS)):
            if not folder.is_dir():
                raise Unavailable(f"{folder.name}: not found in the data folder")
    elif not (root / DATABASE).is_file():
        raise Unavailable(f"{DATABASE}: not found in the data folder")
    return _data_folder(address)


def _folders(address: FolderAddress) -> tuple[Path, Path]:
    files = address.root if is_store(address.files) else address.files
    return Path(address.root), Path(files or address.root)


def _data_folder(address: FolderAddress) -> DataFolder:
    root, files = (folder.resolve() for folder in _folders(address))
    url = address.database
    store = FileStore(address.files, files) if is_store(address.files) else None
    if store is not None and not url:
        raise Unavailable(f"--files {store.protocol}://… needs --database: it names the files")
    known = named_place(address.knowledge) or url or str(root / "knowledge.db")
    return DataFolder(
        root=root,
        files=files,
        store=store,
        database=_server(url) if url else FileDatabase(root / DATABASE),
        knowledge=known,
        address=replace(
            address,
            root=str(root),
            files=str(files) if store is None else address.files,
            knowledge=known,
        ),
    )


def _server(url: str) -> Database:
    """Connect to the database on a server; its driver is an option of the installation."""
    try:
        from service.storage.server_database import ServerDatabase  # noqa: PLC0415
    except ImportError as error:
        raise Unavailable(
            f"--database needs the package psycopg: {how_to_install('psycopg')}"
        ) from error
    return ServerDatabase(url)


def require_shared_files(data_folder: DataFolder) -> None:
    """Refuse files that are not those of the other hosts.

    Raises
    ------
    Unavailable
        With what to do.
    """
    if not data_folder.database.is_shared:
        return
    store = data_folder.store
    if store is not None and store.is_private:
        raise Unavailable(
            f"--files {store.protocol}://…: only one process sees these files; "
            "name a folder or a store that all hosts share"
        )
    with data_folder.database.writing() as connection, storing(MARK):
        connection.lock("folder")
        row = connection.execute("SELECT id FROM folder").fetchone()
        here = _mark(data_folder)
        if row is None:
            here = here or new_id()
            write_atomically(data_folder.files / MARK, f"{here}\n".encode())
            data_folder.publish(data_folder.files / MARK)
            connection.execute("INSERT INTO folder VALUES (?)", (here,))
        elif row["id"] != here:
            place = data_folder.files if store is None else f"--files {store.protocol}://…"
            raise Unavailable(
                f"{place}: the hosts of this database keep their files in another "
                "folder; name the folder that they share with --files"
            )


def _mark(data_folder: DataFolder) -> str:
    """Return the identity of the files; empty if they have none."""
    if data_folder.store is not None:
        return (data_folder.store.read(MARK) or b"").decode("ascii", "replace").strip()
    mark = data_folder.files / MARK
    return mark.read_text("ascii").strip() if mark.is_file() else ""


def show_attempt(data_folder: DataFolder, id: str, attempt: int) -> None:
    """Make an attempt's folder the folder of the job, and delete those of earlier attempts.

    Raises
    ------
    OSError
        When the disk refuses.
    """
    folder, own = data_folder.job_folder(id), data_folder.attempt_folder(id, attempt)
    if own == folder:
        # The only attempt that counts, or the one that the database names.
        own.mkdir(mode=PRIVATE, exist_ok=True)
        return
    if folder.is_dir() and not folder.is_symlink():
        # Orders to a run may come before it has begun.
        folder.rename(own)
    own.mkdir(mode=PRIVATE, exist_ok=True)
    _link(folder, own)
    for earlier in range(1, attempt):
        shutil.rmtree(data_folder.attempt_folder(id, earlier), ignore_errors=True)


def show_again(data_folder: DataFolder, id: str, attempt: int) -> None:
    """Make an attempt's folder that of the job, should that of an earlier one be shown.

    Raises
    ------
    OSError
        When the disk refuses.
    """
    folder, own = data_folder.job_folder(id), data_folder.attempt_folder(id, attempt)
    if own != folder and own.is_dir() and folder.resolve() != own.resolve():
        _link(folder, own)


def _link(folder: Path, own: Path) -> None:
    """Replace the link that the folder of a job is."""
    link = folder.with_name(f"{own.name}.link")
    link.unlink(missing_ok=True)
    link.symlink_to(own.name)
    os.replace(link, folder)


def remove_results(data_folder: DataFolder, id: str, *, attempts: int) -> None:
    """Delete the folders of all attempts of a job; failures are ignored."""
    _require_id("job", id)
    folder = data_folder.files / "jobs" / id
    if folder.is_symlink():
        with suppress(OSError):
            folder.unlink()
    for each in (folder, *folder.parent.glob(f"{id}.*")):
        shutil.rmtree(each, ignore_errors=True)
    if data_folder.store is not None:
        for attempt in range(1, attempts + 1):
            with suppress(Unavailable):
                data_folder.store.remove(data_folder.attempt_folder(id, attempt))


def _require_id(thing: str, id: str) -> None:
    if not is_id(id):
        raise NotFound(thing, id)
