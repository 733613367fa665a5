"""Location of the knowledge base: from the user, the environment, or the default file.

Knows no database, so that who has none does not load one.
"""

import os
from pathlib import Path

from service.files import is_same
from stepnc_model.errors import StepNcError, WriteError

VARIABLE = "STEPNC_KB"
"""environment variable that names the knowledge base"""

FOLDER, FILE = "stepnc", "knowledge.db"


def named_place(option: str) -> str | None:
    """Location named by ``--kb`` or the environment; None: neither names one.

    Parameters
    ----------
    option : str
        What was given as ``--kb``; empty: nothing.
    """
    return option or os.environ.get(VARIABLE) or None


def usual_place(option: str) -> str:
    """The same, else the usual file of this user.

    Raises
    ------
    StepNcError
        When nothing is named and the user has no home.
    """
    return named_place(option) or str(usual_file())


def usual_file() -> Path:
    """``$XDG_DATA_HOME/stepnc/knowledge.db``, else below ``~/.local/share``.

    Raises
    ------
    StepNcError
        When the user has no home.
    """
    named = os.environ.get("XDG_DATA_HOME", "")
    # The XDG Base Directory Specification wants relative names ignored.
    if os.path.isabs(named):
        return Path(named) / FOLDER / FILE
    try:
        return Path.home() / ".local" / "share" / FOLDER / FILE
    except RuntimeError as error:
        raise StepNcError(
            f"no home folder to keep a knowledge base in; name one: --kb FILE, or {VARIABLE}"
        ) from error


def is_usual(place: str) -> bool:
    """Whether this is the default file."""
    try:
        return place == str(usual_file())
    except StepNcError:
        return False


def make_folder(place: str) -> None:
    """Make the folder of the usual file; a folder that the user named is the user's to make.

    Raises
    ------
    WriteError
        When it cannot be made.
    """
    if not is_usual(place):
        return
    folder = Path(place).parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise WriteError(f"{reason}; name another place with --kb", path=str(folder)) from error


def require_apart(place: str | None, *outputs: Path | None) -> None:
    """Refuse an output that is the knowledge base itself, or one of the files beside it.

    Raises
    ------
    WriteError
        Nothing was written.
    """
    name = (place or "").removeprefix("sqlite:///")
    if not name or "://" in name:
        return
    for output in outputs:
        for ending in ("", "-wal", "-shm", "-journal"):
            if output is not None and is_same(Path(name + ending), output):
                raise WriteError("is the knowledge base; name another file", path=str(output))
