"""Data folder of the service; paths consist of ids only, never of names given by users."""

from dataclasses import dataclass
from pathlib import Path

from service.errors import NotFound, Unavailable
from service.ids import is_id
from service.knowledge.place import named_place
from service.storage.database import Database

PRIVATE = 0o700

DATABASE = "service.db"


@dataclass(frozen=True, slots=True, kw_only=True)
class DataFolder:
    """Data folder of the service, with its database."""

    root: Path
    database: Database
    knowledge: str
    """Location of the knowledge base."""

    def program_file(self, id: str) -> Path:
        """Path of an uploaded program.

        Raises
        ------
        NotFound
            When the id has no valid form.
        """
        _require_id("program", id)
        return self.root / "programs" / f"{id}.stpnc"

    def job_folder(self, id: str) -> Path:
        """Folder of a job's results; raises the same errors as :meth:`program_file`."""
        _require_id("job", id)
        return self.root / "jobs" / id


def open_data_folder(root: Path, *, knowledge: str = "") -> DataFolder:
    """Open the data folder; create it if it does not exist.

    Parameters
    ----------
    root : Path
    knowledge : str
        Location of the knowledge base; empty: from the environment, else in the folder.

    Raises
    ------
    Unavailable
        When the folder cannot be created, or its database cannot be opened.
    """
    try:
        root.mkdir(mode=PRIVATE, parents=True, exist_ok=True)
        for name in ("programs", "files", "jobs", "machines", "materials"):
            (root / name).mkdir(mode=PRIVATE, exist_ok=True)
    except OSError as error:
        raise Unavailable(f"{root}: {error.strerror or error}") from error
    return _data_folder(root.resolve(), knowledge)


def known_data_folder(root: Path, *, knowledge: str) -> DataFolder:
    """Open an existing data folder; one that was moved away is not created again.

    Raises
    ------
    Unavailable
        When the folder does not exist, or its database cannot be opened.
    """
    if not (root / DATABASE).is_file():
        raise Unavailable(f"{DATABASE}: not found in the data folder")
    return _data_folder(root.resolve(), knowledge)


def _data_folder(root: Path, knowledge: str) -> DataFolder:
    return DataFolder(
        root=root,
        database=Database(root / DATABASE),
        knowledge=named_place(knowledge) or str(root / "knowledge.db"),
    )


def _require_id(thing: str, id: str) -> None:
    if not is_id(id):
        raise NotFound(thing, id)
