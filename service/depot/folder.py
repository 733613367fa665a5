"""The data folder: where everything lies, by id only, so that no name of a user is a path."""

from dataclasses import dataclass
from pathlib import Path

from service.depot.database import Database
from service.depot.ids import is_id
from service.errors import NotFound, Unavailable
from service.knowledge.place import named_place

PRIVATE = 0o700

DATABASE = "service.db"


@dataclass(frozen=True, slots=True, kw_only=True)
class Depot:
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
        """What a job leaves; errors as :meth:`program_file`."""
        _require_id("job", id)
        return self.root / "jobs" / id


def open_depot(root: Path, *, knowledge: str = "") -> Depot:
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
    return _depot(root.resolve(), knowledge)


def known_depot(root: Path, *, knowledge: str) -> Depot:
    """A data folder that exists: one that was moved away is not made anew, and empty.

    Raises
    ------
    Unavailable
        When there is none, or its database cannot be opened.
    """
    if not (root / DATABASE).is_file():
        raise Unavailable(f"{DATABASE}: there is none in the data folder")
    return _depot(root.resolve(), knowledge)


def _depot(root: Path, knowledge: str) -> Depot:
    return Depot(
        root=root,
        database=Database(root / DATABASE),
        knowledge=named_place(knowledge) or str(root / "knowledge.db"),
    )


def _require_id(thing: str, id: str) -> None:
    if not is_id(id):
        raise NotFound(thing, id)
