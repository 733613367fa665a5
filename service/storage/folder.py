"""The data folder: where everything lies, by id only, so that no name of a user is a path."""

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
    """A data folder and its database."""

    root: Path
    database: Database
    knowledge: str
    """place of the knowledge base"""

    def program_file(self, id: str) -> Path:
        """The bytes of a program, as they came.

        Raises
        ------
        NotFound
            When this is no id.
        """
        _require_id("program", id)
        return self.root / "programs" / f"{id}.stpnc"

    def job_folder(self, id: str) -> Path:
        """Folder of a job's results; errors as :meth:`program_file`."""
        _require_id("job", id)
        return self.root / "jobs" / id


def open_data_folder(root: Path, *, knowledge: str = "") -> DataFolder:
    """The data folder, made when it does not exist.

    Parameters
    ----------
    root : Path
    knowledge : str
        Place of the knowledge base; that of the environment, else a file in the folder.

    Raises
    ------
    Unavailable
        When it cannot be made, or its database not be opened.
    """
    try:
        root.mkdir(mode=PRIVATE, parents=True, exist_ok=True)
        for name in ("programs", "jobs", "machines", "materials"):
            (root / name).mkdir(mode=PRIVATE, exist_ok=True)
    except OSError as error:
        raise Unavailable(f"{root}: {error.strerror or error}") from error
    return _data_folder(root.resolve(), knowledge)


def known_data_folder(root: Path, *, knowledge: str) -> DataFolder:
    """A data folder that exists: one that was moved away is not made anew, and empty.

    Raises
    ------
    Unavailable
        When there is none, or its database cannot be opened.
    """
    if not (root / DATABASE).is_file():
        raise Unavailable(f"{DATABASE}: there is none in the data folder")
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
