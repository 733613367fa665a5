"""Machines and materials of the shop, in addition to the built-in library; a file for each.

Names from clients are only looked up; they are never used as paths.
"""

import fcntl
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory

from service.errors import Conflict, NotFound, PreconditionFailed, TooLarge, Unreadable
from service.files import write_atomically
from service.live.journal import storing
from service.programs.machine_choice import load_material_named
from service.storage.folder import DataFolder
from simulator.errors import LibraryError, UnknownMachine
from simulator.library import (
    load_machine,
    load_material,
    machine_names,
    material_names,
)
from simulator.spec import Machine, WorkMaterial
from stepnc_model.errors import StepNcError

LOCK = ".lock"
"""Name of the lock file in the folder; it is never deleted."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Acquire the lock of a folder, waiting if necessary, and hold it."""
    with (folder / LOCK).open("wb") as file:
        # Freed when the file is closed, also when the process dies.
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


NAME = "^[a-z0-9][a-z0-9_-]{0,63}$"
"""Regular expression of names of machines and materials of the shop."""

_NAME = re.compile(NAME)

LONGEST = 200
"""Largest number of characters in a material name."""

LARGEST = 1 << 16
"""Largest file, in bytes; parsing time may grow with the square of the size."""


class LibrarySection(StrEnum):
    """Section of the library."""

    MACHINES = "machines"
    MATERIALS = "materials"

    @property
    def one(self) -> str:
        """Singular of the section name."""
        return self.value.removesuffix("s")

    @property
    def suffixes(self) -> tuple[str, ...]:
        """File extensions, the preferred one first; a name should have only one file."""
        return (".toml", ".xml") if self is LibrarySection.MACHINES else (".toml",)


@dataclass(frozen=True, slots=True, kw_only=True)
class LibraryEntry:
    """Machine or material of the library, with its data."""

    name: str
    is_own: bool
    """Whether the entry belongs to the shop, not to the built-in library."""
    entry: Machine | WorkMaterial
    text: bytes
    """Content of the shop's file; empty for an entry of the built-in library."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LibraryListing:
    """Machine or material as shown in lists."""

    name: str
    is_own: bool
    title: str
    problem: str
    """Why the file cannot be read; empty if it can."""


Condition = Callable[[bytes | None], bool]
"""Condition on the current content of a file (None: no file) for changing it."""


def always(_text: bytes | None) -> bool:
    """Accept any content."""
    return True


def machine_word(data_folder: DataFolder, name: str) -> str:
    """Return the argument for :func:`simulator.library.load_machine`; empty stays empty.

    Raises
    ------
    UnknownMachine
        When neither the shop nor the built-in library has the machine.
    """
    if not name or name in machine_names():
        return name
    file = _own_file(data_folder, LibrarySection.MACHINES, name)
    if file is None:
        raise UnknownMachine(name, tuple(_names(data_folder, LibrarySection.MACHINES)))
    return str(file)


def material_word(data_folder: DataFolder, name: str) -> str:
    """Return the argument of ``load_material_named``; empty stays empty.

    Raises
    ------
    Unreadable
        When the name is a path instead of a material name.
    """
    file = _own_file(data_folder, LibrarySection.MATERIALS, name)
    if file is not None:
        return str(file)
    # Material numbers have one point, followed by four digits: 1.0503.
    is_number = re.fullmatch(r"\d\.\d{4}", name) is not None
    if not is_number and (set(name) & set("/\\.") or len(name) > LONGEST):
        raise Unreadable(f"'{name[:LONGEST]}' is not a valid material name")
    return name


def require(data_folder: DataFolder, *, machine: str, material: str) -> None:
    """Refuse a machine or material that a job could not load; empty names are accepted.

    Raises
    ------
    UnknownMachine, UnknownMaterial, Unreadable, LibraryError
        When the job would raise the same error.
    """
    if machine:
        machine_word(data_folder, machine)
        one(data_folder, LibrarySection.MACHINES, machine)
    if _own_file(data_folder, LibrarySection.MATERIALS, material) is not None:
        one(data_folder, LibrarySection.MATERIALS, material)
    elif material:
        material_of(data_folder, material)


def entries_of(data_folder: DataFolder, section: LibrarySection) -> tuple[LibraryListing, ...]:
    """List all entries of a section, those of the shop last; unreadable ones say why."""
    found = (_listed(data_folder, section, name) for name in _names(data_folder, section))
    return tuple(each for each in found if each is not None)


def _listed(
    data_folder: DataFolder, section: LibrarySection, name: str
) -> LibraryListing | None:
    """Return the listing of an entry; None if it was deleted meanwhile."""
    try:
        found = one(data_folder, section, name)
    except NotFound:
        return None
    except StepNcError as error:
        return LibraryListing(name=name, is_own=True, title=name, problem=str(error))
    return LibraryListing(name=name, is_own=found.is_own, title=found.entry.title, problem="")


def one(data_folder: DataFolder, section: LibrarySection, name: str) -> LibraryEntry:
    """Return an entry by its name.

    Raises
    ------
    NotFound, LibraryError
        When neither the shop nor the library has it, or the shop's file cannot be read.
    """
    if name in _library(section):
        return LibraryEntry(name=name, is_own=False, entry=_LOADERS[section](name), text=b"")
    while (file := _own_file(data_folder, section, name)) is not None:
        # Data and text must come from the same file, which may be replaced meanwhile.
        text = _text(file)
        try:
            entry = _load(section, file)
        except StepNcError:
            if text is not None and _text(file) == text:
                raise
            continue
        if text is not None and _text(file) == text:
            return LibraryEntry(name=name, is_own=True, entry=entry, text=text)
    raise NotFound(section.one, name)


def put(
    data_folder: DataFolder,
    section: LibrarySection,
    name: str,
    data: bytes,
    *,
    condition: Condition = always,
) -> LibraryEntry:
    """Store a file of the shop, after it was read without an error.

    Raises
    ------
    Unreadable, Conflict, TooLarge, LibraryError
        When the name is invalid or belongs to the library, or the file is invalid.
    PreconditionFailed
        When the condition is not met.
    StorageFull, Unavailable
        When the disk refuses.
    """
    if not _NAME.fullmatch(name):
        raise Unreadable(f"'{name[:LONGEST]}': use only lower-case letters, digits, '-', '_'")
    if name in _library(section):
        raise Conflict(f"{section.one} '{name}' is built in: choose another name")
    if len(data) > LARGEST:
        raise TooLarge(f"the file of a {section.one}", bound=LARGEST)
    folder = data_folder.files / section.value
    file = folder / f"{name}{_suffix(section, data)}"
    with storing(section.value):
        entry = _try_out(section, file.name, data)
        with _in_turn(data_folder, section):
            before = _changeable(data_folder, section, name, condition)
            write_atomically(file, data)
            data_folder.publish(file)
            for other in before:
                if other != file:
                    data_folder.discard(other)
    return LibraryEntry(name=name, is_own=True, entry=entry, text=data)


@contextmanager
def _in_turn(data_folder: DataFolder, section: LibrarySection) -> Iterator[None]:
    """Let nobody else change a section meanwhile: on this host, or of all that share it."""
    with locked(data_folder.files / section.value):
        if not data_folder.database.is_shared:
            yield
            return
        # Not every file system locks files for all hosts.
        with data_folder.database.writing() as connection:
            connection.lock(f"library {section.value}")
            yield


def _changeable(
    data_folder: DataFolder, section: LibrarySection, name: str, condition: Condition
) -> list[Path]:
    """Return the files of a name that may be changed; the lock must be held."""
    if data_folder.store is not None:
        data_folder.store.mirror(data_folder.files / section.value, at_once=True)
    files = _files_of(data_folder, section, name)
    if not condition(_text(files[0]) if files else None):
        what = "has changed since it was read" if files else "does not exist"
        raise PreconditionFailed(f"{section.one} '{name}' {what}")
    return files


def _try_out(section: LibrarySection, name: str, data: bytes) -> Machine | WorkMaterial:
    """Parse a file before it is stored."""
    with TemporaryDirectory() as folder:
        trial = Path(folder) / name
        trial.write_bytes(data)
        return _load(section, trial)


def _load(section: LibrarySection, file: Path) -> Machine | WorkMaterial:
    """Load a file of the shop; errors name the file without its folder."""
    try:
        return _LOADERS[section](str(file))
    except LibraryError as error:
        told = str(error).removeprefix(f"{error.path}: ").removeprefix(f"line {error.line}: ")
        told = told.removeprefix(f"{error.key}: ")
        raise LibraryError(told, path=file.name, key=error.key, line=error.line) from error


def remove(
    data_folder: DataFolder,
    section: LibrarySection,
    name: str,
    *,
    condition: Condition = always,
) -> None:
    """Delete a file of the shop.

    Raises
    ------
    NotFound, Conflict
        When the entry does not exist, or belongs to the built-in library.
    PreconditionFailed
        When the condition is not met.
    """
    if name in _library(section):
        raise Conflict(f"{section.one} '{name}' is built in and cannot be deleted")
    if not _NAME.fullmatch(name):
        raise NotFound(section.one, name)
    with storing(section.value), _in_turn(data_folder, section):
        files = _changeable(data_folder, section, name, condition)
        if not files:
            raise NotFound(section.one, name)
        # The preferred file is deleted last, so that no other becomes visible meanwhile.
        for file in reversed(files):
            data_folder.discard(file)


def _suffix(section: LibrarySection, data: bytes) -> str:
    is_xml = data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    return ".xml" if is_xml and section is LibrarySection.MACHINES else ".toml"


def _own_file(data_folder: DataFolder, section: LibrarySection, name: str) -> Path | None:
    return next(iter(_own_files(data_folder, section, name)), None)


def _own_files(data_folder: DataFolder, section: LibrarySection, name: str) -> list[Path]:
    """Files of a name as of now, preferred one first."""
    _mirror(data_folder, section)
    return _files_of(data_folder, section, name)


def _mirror(data_folder: DataFolder, section: LibrarySection) -> None:
    """Compare the files of a section with those in the store, if there is one."""
    if data_folder.store is not None:
        folder = data_folder.files / section.value
        with locked(folder):
            data_folder.store.mirror(folder)


def _files_of(data_folder: DataFolder, section: LibrarySection, name: str) -> list[Path]:
    """Files of a name, preferred one first; a second one may remain after a power failure."""
    if not _NAME.fullmatch(name):
        return []
    files = (
        data_folder.files / section.value / f"{name}{suffix}" for suffix in section.suffixes
    )
    return [file for file in files if file.is_file()]


def _text(file: Path) -> bytes | None:
    """Return the content of a file; None if it does not exist."""
    with storing(file.name):
        try:
            return file.read_bytes()
        except FileNotFoundError:
            return None


def _names(data_folder: DataFolder, section: LibrarySection) -> list[str]:
    of_library = _library(section)
    _mirror(data_folder, section)
    with storing(section.value):
        files = [
            path for path in (data_folder.files / section.value).iterdir()
            if path.suffix in section.suffixes and path.is_file()
        ]  # fmt: skip
    own = {path.stem for path in files if _NAME.fullmatch(path.stem)}
    return [*of_library, *sorted(own - set(of_library))]


def _library(section: LibrarySection) -> tuple[str, ...]:
    return machine_names() if section is LibrarySection.MACHINES else material_names()


_LOADERS: dict[LibrarySection, Callable[[str], Machine | WorkMaterial]] = {
    LibrarySection.MACHINES: load_machine,
    LibrarySection.MATERIALS: load_material,
}


def material_of(data_folder: DataFolder, name: str) -> WorkMaterial:
    """Load a material by any designation used in catalogues."""
    return load_material_named(material_word(data_folder, name)).material
