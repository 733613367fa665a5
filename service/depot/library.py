"""Machines and materials of the shop beside those of the library: a file each, by a safe name.

A name that comes from outside is looked up; it is never taken for a path.
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory

from service.chosen import load_material_named
from service.depot.folder import Depot
from service.errors import Conflict, NotFound, TooLarge, Unreadable
from service.files import read_bytes, write_atomically
from simulator.errors import LibraryError, UnknownMachine
from simulator.library import (
    load_machine,
    load_material,
    machine_names,
    material_names,
)
from simulator.spec import Machine, Material

NAME = "^[a-z0-9][a-z0-9_-]{0,63}$"
"""regular expression of the name of a file of the shop"""

_NAME = re.compile(NAME)

LONGEST = 200
"""letters of any name of a material"""

LARGEST = 1 << 16
"""bytes of a file, ten times the library's: a parser's time may grow with the square"""


class Shelf(StrEnum):
    """What is kept."""

    MACHINES = "machines"
    MATERIALS = "materials"

    @property
    def one(self) -> str:
        """A single one."""
        return self.value.removesuffix("s")


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """A machine or material by name."""

    name: str
    is_own: bool
    """of the shop, not of the library"""
    entry: Machine | Material


def machine_word(depot: Depot, name: str) -> str:
    """What :func:`simulator.library.load_machine` takes for a name; empty stays empty.

    Raises
    ------
    UnknownMachine
        When neither the shop nor the library has it.
    """
    if not name or name in machine_names():
        return name
    file = _own_file(depot, Shelf.MACHINES, name)
    if file is None:
        raise UnknownMachine(name, tuple(_names(depot, Shelf.MACHINES)))
    return str(file)


def material_word(depot: Depot, name: str) -> str:
    """What :func:`service.chosen.load_material_named` takes for a name; empty stays empty.

    Raises
    ------
    Unreadable
        When it is no name of a material, but a path.
    """
    file = _own_file(depot, Shelf.MATERIALS, name)
    if file is not None:
        return str(file)
    # Numbers of materials have one point, and four digits behind it: 1.0503.
    is_number = re.fullmatch(r"\d\.\d{4}", name) is not None
    if not is_number and (set(name) & set("/\\.") or len(name) > LONGEST):
        raise Unreadable(f"'{name[:LONGEST]}' is no name of a material")
    return name


def held(depot: Depot, shelf: Shelf) -> tuple[Held, ...]:
    """All of them, those of the shop last."""
    return tuple(one(depot, shelf, name) for name in _names(depot, shelf))


def one(depot: Depot, shelf: Shelf, name: str) -> Held:
    """One by its name.

    Raises
    ------
    NotFound
        When neither the shop nor the library has it.
    """
    load = _LOADERS[shelf]
    if name in _library(shelf):
        return Held(name=name, is_own=False, entry=load(name))
    file = _own_file(depot, shelf, name)
    if file is None:
        raise NotFound(shelf.one, name)
    return Held(name=name, is_own=True, entry=load(str(file)))


def put(depot: Depot, shelf: Shelf, name: str, data: bytes) -> Held:
    """Keep one, once it has been read without an error.

    Raises
    ------
    Unreadable, Conflict, TooLarge, LibraryError
        When the name cannot be one, is the library's, or the file is no good.
    """
    if not _NAME.fullmatch(name):
        raise Unreadable(f"'{name[:LONGEST]}': a name is small letters, digits, '-' and '_'")
    if name in _library(shelf):
        raise Conflict(f"{shelf.one} '{name}' is of the library: take another name")
    if len(data) > LARGEST:
        raise TooLarge(f"the file of a {shelf.one}", bound=LARGEST)
    suffix = _suffix(shelf, data)
    _try_out(shelf, f"{name}{suffix}", data)
    before = _own_file(depot, shelf, name)
    file = depot.root / shelf.value / f"{name}{suffix}"
    write_atomically(file, data)
    if before is not None and before != file:
        before.unlink(missing_ok=True)
    return one(depot, shelf, name)


def _try_out(shelf: Shelf, name: str, data: bytes) -> None:
    """Read a file before it is kept; what is wrong is told by its name alone."""
    with TemporaryDirectory() as folder:
        trial = Path(folder) / name
        trial.write_bytes(data)
        try:
            _LOADERS[shelf](str(trial))
        except LibraryError as error:
            told = str(error).removeprefix(f"{error.path}: ").removeprefix(f"{error.key}: ")
            raise LibraryError(told, path=name, key=error.key) from error


def text_of(depot: Depot, shelf: Shelf, name: str) -> bytes:
    """The file of one of the shop's.

    Raises
    ------
    NotFound
        When the shop has none of that name.
    """
    file = _own_file(depot, shelf, name)
    if file is None:
        raise NotFound(shelf.one, name)
    return read_bytes(file)


def remove(depot: Depot, shelf: Shelf, name: str) -> None:
    """Delete one of the shop.

    Raises
    ------
    NotFound, Conflict
        When there is none, or it is of the library.
    """
    if name in _library(shelf):
        raise Conflict(f"{shelf.one} '{name}' is of the library: it stays")
    file = _own_file(depot, shelf, name)
    if file is None:
        raise NotFound(shelf.one, name)
    file.unlink(missing_ok=True)


def _suffix(shelf: Shelf, data: bytes) -> str:
    is_xml = data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    return ".xml" if is_xml and shelf is Shelf.MACHINES else ".toml"


def _own_file(depot: Depot, shelf: Shelf, name: str) -> Path | None:
    if not _NAME.fullmatch(name):
        return None
    for suffix in (".toml", ".xml"):
        file = depot.root / shelf.value / f"{name}{suffix}"
        if file.is_file():
            return file
    return None


def _names(depot: Depot, shelf: Shelf) -> list[str]:
    own = sorted(path.stem for path in _files(depot.root / shelf.value))
    return [*_library(shelf), *own]


def _files(folder: Path) -> Iterable[Path]:
    return (path for path in folder.iterdir() if _NAME.fullmatch(path.stem))


def _library(shelf: Shelf) -> tuple[str, ...]:
    return machine_names() if shelf is Shelf.MACHINES else material_names()


_LOADERS: dict[Shelf, Callable[[str], Machine | Material]] = {
    Shelf.MACHINES: load_machine,
    Shelf.MATERIALS: load_material,
}


def material_of(depot: Depot, name: str) -> Material:
    """A material by any name that catalogues give it."""
    return load_material_named(material_word(depot, name)).material
