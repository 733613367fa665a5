"""Location of the knowledge base: from the user, the environment, or the default file.

Imports no database library, which commands without a knowledge base do not need.
"""

import os
from pathlib import Path

from service.files import is_same
from stepnc_model.errors import StepNcError, WriteError

VARIABLE = "STEPNC_KB"
"""Environment variable that names the knowledge base."""

FOLDER, FILE = "stepnc", "knowledge.db"


def named_place(option: str) -> str | None:
    """Location named by ``--kb`` or the environment; None: neither names one.

    Parameters
    ----------
    option : str
        Value of ``--kb``; empty: not given.
    """
    return option or os.environ.get(VARIABLE) or None


def usual_place(option: str) -> str:
    """Location named by ``--kb`` or the environment, else the default file of this user.

    Raises
    ------
    StepNcError
        When no location is named and the user has no home folder.
    """
    return named_place(option) or str(usual_file())


def usual_file() -> Path:
    """Default file ``$XDG_DATA_HOME/stepnc/knowledge.db``, or below ``~/.local/share``.

    Raises
    ------
    StepNcError
        When the user has no home folder.
    """
    named = os.environ.get("XDG_DATA_HOME", "")
    # The XDG Base Directory Specification requires relative paths to be ignored.
    if os.path.isabs(named):
        return Path(named) / FOLDER / FILE
    try:
        return Path.home() / ".local" / "share" / FOLDER / FILE
    except RuntimeError as error:
        raise StepNcError(
            f"no home folder for a knowledge base; name one with --kb FILE, or {VARIABLE}"
        ) from error


def is_usual(place: str) -> bool:
    """True if a location is the default file."""
    try:
        return place == str(usual_file())
    except StepNcError:
        return False


def make_folder(place: str) -> None:
    """Create the folder of the default file; users create other folders themselves.

    Raises
    ------
    WriteError
        When the folder cannot be created.
    """
    if not is_usual(place):
        return
    folder = Path(place).parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise WriteError(f"{reason}; name another file with --kb", path=str(folder)) from error


def require_apart(place: str | None, *outputs: Path | None) -> None:
    """Refuse an output file that is the knowledge base or one of its auxiliary files.

    Raises
    ------
    WriteError
        When an output would overwrite the knowledge base; nothing was written.
    """
    name = (place or "").removeprefix("sqlite:///")
    if not name or "://" in name:
        return
    for output in outputs:
        for ending in ("", "-wal", "-shm", "-journal"):
            if output is not None and is_same(Path(name + ending), output):
                raise WriteError("is the knowledge base; name another file", path=str(output))
