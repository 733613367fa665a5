"""The controls for which NC code is written and read: one front for all dialects."""

from collections.abc import Callable, Iterable, Iterator
from typing import Protocol

from stepnc_model.errors import PostError
from stepnc_model.post import canonical
from stepnc_model.post.blocks import Block, Cycles, MachineType
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.fanuc import HAAS, Fanuc, FanucReader
from stepnc_model.post.heidenhain import Heidenhain
from stepnc_model.post.linuxcnc import LinuxCnc, LinuxCncReader
from stepnc_model.post.read_heidenhain import HeidenhainReader
from stepnc_model.post.sinumerik import Sinumerik, SinumerikReader


class Writer(Protocol):
    """Writer of one program."""

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """The program, line by line."""
        ...


class NcReader(Protocol):
    """Reader of one program."""

    def blocks(self, lines: Iterable[str]) -> Iterator[Block]:
        """Neutral blocks of the program."""
        ...


WRITERS: dict[Dialect, Callable[[], Writer]] = {
    Dialect.LINUXCNC: LinuxCnc,
    Dialect.FANUC: Fanuc,
    Dialect.HAAS: lambda: Fanuc(HAAS),
    Dialect.SINUMERIK: Sinumerik,
    Dialect.HEIDENHAIN: Heidenhain,
}

READERS: dict[Dialect, Callable[[MachineType], NcReader]] = {
    Dialect.LINUXCNC: LinuxCncReader,
    Dialect.FANUC: FanucReader,
    Dialect.HAAS: lambda machine: FanucReader(machine, HAAS),
    Dialect.SINUMERIK: SinumerikReader,
    Dialect.HEIDENHAIN: HeidenhainReader,
}


def write(
    blocks: Iterable[Block], control: Dialect, *, cycles: Cycles = Cycles.EXPANDED
) -> Iterator[str]:
    """Lines of NC code, without their ends; made as they are asked for.

    Raises
    ------
    PostError
        At a block that the control cannot do.
    """
    if control is Dialect.CANONICAL:
        return canonical.write(blocks)
    return WRITERS[control]().lines(blocks, cycles)


def read_blocks(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> Iterator[Block]:
    """Neutral blocks of NC code, as far as its dialect is known.

    Parameters
    ----------
    lines : iterable of str
    control : Dialect
    machine : MachineType
        What the code is for; Fanuc and Haas code does not say.

    Raises
    ------
    PostError
        At a word that is not known there, or an arc that is none, with its line.
    """
    if control is Dialect.CANONICAL:
        raise PostError("canonical commands are no NC code: they have no blocks")
    return READERS[control](machine).blocks(lines)


def read(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> tuple[Canonical, ...]:
    """Canonical commands of NC code; the arguments are those of :func:`read_blocks`."""
    if control is Dialect.CANONICAL:
        return tuple(canonical.read(lines))
    return tuple(commands(read_blocks(lines, control, machine=machine)))
