"""A folder of outputs that appears whole: written elsewhere, and moved when all is there.

A run that is killed leaves a hidden folder, which the next one into the same place removes. A
run that fails or is interrupted leaves what it has, as files do
(:mod:`service.outputs.run_file`).
"""

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from service.progress import Tell
from stepnc_model.errors import WriteError


@contextmanager
def staged_folder(folder: Path, *, tell: Tell) -> Iterator[Path]:
    """Folder to write into, whose content gets the place of another at the end.

    Parameters
    ----------
    folder : Path
        A new folder appears as a whole. Into one that exists, the files are moved one after
        the other; those of other names stay, and are told.

    Raises
    ------
    WriteError
        When the disk refuses.
    """
    is_new = not os.path.lexists(folder)
    beside = folder.parent if is_new else folder
    prefix = f".{folder.resolve().name}.stage-"
    try:
        beside.mkdir(parents=True, exist_ok=True)
        _remove_stale(beside, prefix, tell)
        stage = Path(tempfile.mkdtemp(prefix=prefix, dir=beside))
        with _locked(stage):
            try:
                yield stage
            finally:
                _move(stage, folder, is_new=is_new, tell=tell)
    except OSError as error:
        raise WriteError(error.strerror or str(error), path=str(folder)) from error


@contextmanager
def _locked(stage: Path) -> Iterator[None]:
    """Lock a folder while this process lives, which says that it is not stale."""
    handle = os.open(stage, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _remove_stale(place: Path, prefix: str, tell: Tell) -> None:
    """Remove what killed runs have left."""
    for each in sorted(place.iterdir()):
        if not each.name.startswith(prefix) or not each.is_dir():
            continue
        with suppress(BlockingIOError):
            handle = os.open(each, os.O_RDONLY)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(each)
                tell(f"{each}: removed, a run that was broken off has left it")
            finally:
                os.close(handle)


def _move(stage: Path, folder: Path, *, is_new: bool, tell: Tell) -> None:
    """Give the content of a stage its place; nothing appears of an empty one."""
    written = sorted(stage.iterdir())
    if not written:
        stage.rmdir()
        return
    if is_new and not os.path.lexists(folder):
        umask = os.umask(0)
        os.umask(umask)
        stage.chmod(0o777 & ~umask)
        stage.rename(folder)
        return
    for each in written:
        place = folder / each.name
        if place.is_dir() and not place.is_symlink():
            shutil.rmtree(place)
        each.replace(place)
        # The file is whole now: what a broken-off run has left of it is of no use.
        place.with_suffix(f".partial{place.suffix}").unlink(missing_ok=True)
    stage.rmdir()
    names = {each.name for each in written}
    others = sorted(each.name for each in folder.iterdir() if each.name not in names)
    if others:
        shown = ", ".join(others[:8]) + (f" and {len(others) - 8} more" if others[8:] else "")
        tell(f"{folder}: holds files that this run has not written: {shown}")
