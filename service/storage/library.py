"""Machines and materials of the shop beside those of the library: a file each, by a safe name.

A name that comes from outside is looked up; it is never taken for a path.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory

from service.chosen import load_material_named
from service.errors import Conflict, NotFound, PreconditionFailed, TooLarge, Unreadable
from service.files import write_atomically
from service.live.storage import storing
from service.storage.file_lock import locked
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

NAME = "^[a-z0-9][a-z0-9_-]{0,63}$"
"""regular expression of the name of a file of the shop"""

_NAME = re.compile(NAME)

LONGEST = 200
"""letters of any name of a material"""

LARGEST = 1 << 16
"""bytes of a file, ten times the library's: a parser's time may grow with the square"""


class LibrarySection(StrEnum):
    """Section of the library."""

    MACHINES = "machines"
    MATERIALS = "materials"

    @property
    def one(self) -> str:
        """A single one."""
        return self.value.removesuffix("s")

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Endings of files, the one that counts first: one name has one file."""
        return (".toml", ".xml") if self is LibrarySection.MACHINES else (".toml",)


@dataclass(frozen=True, slots=True, kw_only=True)
class LibraryEntry:
    """A machine or material by name."""

    name: str
    is_own: bool
    """of the shop, not of the library"""
    entry: Machine | WorkMaterial
    text: bytes
    """the file that it was read from; empty: it is of the library"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LibraryListing:
    """A machine or material as lists tell it."""

    name: str
    is_own: bool
    title: str
    problem: str
    """why it cannot be read; empty: it can"""


Condition = Callable[[bytes | None], bool]
"""whether a file may be changed, by what is in it now; None: there is none"""


def always(_text: bytes | None) -> bool:
    """Whatever is in it."""
    return True


def machine_word(data_folder: DataFolder, name: str) -> str:
    """Argument of :func:`simulator.library.load_machine` for a name; empty stays empty.

    Raises
    ------
    UnknownMachine
        When neither the shop nor the library has it.
    """
    if not name or name in machine_names():
        return name
    file = _own_file(data_folder, LibrarySection.MACHINES, name)
    if file is None:
        raise UnknownMachine(name, tuple(_names(data_folder, LibrarySection.MACHINES)))
    return str(file)


def material_word(data_folder: DataFolder, name: str) -> str:
    """Argument of :func:`service.chosen.load_material_named` for a name; empty stays empty.

    Raises
    ------
    Unreadable
        When it is no name of a material, but a path.
    """
    file = _own_file(data_folder, LibrarySection.MATERIALS, name)
    if file is not None:
        return str(file)
    # Numbers of materials have one point, and four digits behind it: 1.0503.
    is_number = re.fullmatch(r"\d\.\d{4}", name) is not None
    if not is_number and (set(name) & set("/\\.") or len(name) > LONGEST):
        raise Unreadable(f"'{name[:LONGEST]}' is no name of a material")
    return name


def require(data_folder: DataFolder, *, machine: str, material: str) -> None:
    """Refuse a machine or a material that a job could not take; empty: one that suits.

    Raises
    ------
    UnknownMachine, UnknownMaterial, Unreadable, LibraryError
        As the job would.
    """
    if machine:
        machine_word(data_folder, machine)
        one(data_folder, LibrarySection.MACHINES, machine)
    if _own_file(data_folder, LibrarySection.MATERIALS, material) is not None:
        one(data_folder, LibrarySection.MATERIALS, material)
    elif material:
        material_of(data_folder, material)


def entries_of(data_folder: DataFolder, section: LibrarySection) -> tuple[LibraryListing, ...]:
    """All of them, those of the shop last; one that cannot be read says why."""
    found = (_listed(data_folder, section, name) for name in _names(data_folder, section))
    return tuple(each for each in found if each is not None)


def _listed(
    data_folder: DataFolder, section: LibrarySection, name: str
) -> LibraryListing | None:
    """One of them; None: it was deleted meanwhile."""
    try:
        found = one(data_folder, section, name)
    except NotFound:
        return None
    except StepNcError as error:
        return LibraryListing(name=name, is_own=True, title=name, problem=str(error))
    return LibraryListing(name=name, is_own=found.is_own, title=found.entry.title, problem="")


def one(data_folder: DataFolder, section: LibrarySection, name: str) -> LibraryEntry:
    """One by its name.

    Raises
    ------
    NotFound, LibraryError
        When neither the shop nor the library has it, or the shop's cannot be read.
    """
    if name in _library(section):
        return LibraryEntry(name=name, is_own=False, entry=_LOADERS[section](name), text=b"")
    while (file := _own_file(data_folder, section, name)) is not None:
        # Entry and text are of one file: it is read again when it was replaced meanwhile.
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
    """Keep one, once it has been read without an error.

    Raises
    ------
    Unreadable, Conflict, TooLarge, LibraryError
        When the name cannot be one, is the library's, or the file is no good.
    PreconditionFailed
        When the condition is not met.
    StorageFull, Unavailable
        When the disk refuses.
    """
    if not _NAME.fullmatch(name):
        raise Unreadable(f"'{name[:LONGEST]}': a name is small letters, digits, '-' and '_'")
    if name in _library(section):
        raise Conflict(f"{section.one} '{name}' is of the library: take another name")
    if len(data) > LARGEST:
        raise TooLarge(f"the file of a {section.one}", bound=LARGEST)
    folder = data_folder.root / section.value
    file = folder / f"{name}{_suffix(section, data)}"
    with storing(section.value):
        entry = _try_out(section, file.name, data)
        with locked(folder):
            before = _changeable(data_folder, section, name, condition)
            write_atomically(file, data)
            for other in before:
                if other != file:
                    other.unlink(missing_ok=True)
    return LibraryEntry(name=name, is_own=True, entry=entry, text=data)


def _changeable(
    data_folder: DataFolder, section: LibrarySection, name: str, condition: Condition
) -> list[Path]:
    """Files of a name that may be changed; within the turn."""
    files = _own_files(data_folder, section, name)
    if not condition(_text(files[0]) if files else None):
        what = "was changed meanwhile: read it again" if files else "is not there"
        raise PreconditionFailed(f"{section.one} '{name}' {what}")
    return files


def _try_out(section: LibrarySection, name: str, data: bytes) -> Machine | WorkMaterial:
    """Read a file before it is kept."""
    with TemporaryDirectory() as folder:
        trial = Path(folder) / name
        trial.write_bytes(data)
        return _load(section, trial)


def _load(section: LibrarySection, file: Path) -> Machine | WorkMaterial:
    """A file of the shop; what is wrong is told by its name alone."""
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
    """Delete one of the shop.

    Raises
    ------
    NotFound, Conflict
        When there is none, or it is of the library.
    PreconditionFailed
        When the condition is not met.
    """
    if name in _library(section):
        raise Conflict(f"{section.one} '{name}' is of the library: it stays")
    if not _NAME.fullmatch(name):
        raise NotFound(section.one, name)
    with storing(section.value), locked(data_folder.root / section.value):
        files = _changeable(data_folder, section, name, condition)
        if not files:
            raise NotFound(section.one, name)
        # The one that counts last: none comes to light on the way.
        for file in reversed(files):
            file.unlink(missing_ok=True)


def _suffix(section: LibrarySection, data: bytes) -> str:
    is_xml = data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    return ".xml" if is_xml and section is LibrarySection.MACHINES else ".toml"


def _own_file(data_folder: DataFolder, section: LibrarySection, name: str) -> Path | None:
    return next(iter(_own_files(data_folder, section, name)), None)


def _own_files(data_folder: DataFolder, section: LibrarySection, name: str) -> list[Path]:
    """The one that counts first; a second one is left when the power failed in between."""
    if not _NAME.fullmatch(name):
        return []
    files = (
        data_folder.root / section.value / f"{name}{suffix}" for suffix in section.suffixes
    )
    return [file for file in files if file.is_file()]


def _text(file: Path) -> bytes | None:
    """Content of a file; None: it is gone."""
    with storing(file.name):
        try:
            return file.read_bytes()
        except FileNotFoundError:
            return None


def _names(data_folder: DataFolder, section: LibrarySection) -> list[str]:
    of_library = _library(section)
    with storing(section.value):
        files = [
            path for path in (data_folder.root / section.value).iterdir()
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
    """A material by any name that catalogues give it."""
    return load_material_named(material_word(data_folder, name)).material
