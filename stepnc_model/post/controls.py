"""The controls for which NC code is written and read: one front for all dialects."""

from collections.abc import Callable, Iterable, Iterator
from enum import StrEnum
from typing import Protocol

from stepnc_model.errors import PostError
from stepnc_model.post import canonical, read_canonical
from stepnc_model.post.blocks import Block, Cycles, Machine
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.fanuc import Fanuc, FanucReader
from stepnc_model.post.haas import HAAS
from stepnc_model.post.heidenhain import Heidenhain
from stepnc_model.post.linuxcnc import LinuxCnc, LinuxCncReader
from stepnc_model.post.read_heidenhain import HeidenhainReader
from stepnc_model.post.sinumerik import Sinumerik, SinumerikReader


class Control(StrEnum):
    """Dialects of NC code."""

    CANONICAL = "canonical"
    """canonical machining commands, which no control runs and all can be compared by"""
    LINUXCNC = "linuxcnc"
    FANUC = "fanuc"
    HAAS = "haas"
    SINUMERIK = "sinumerik"
    """840D"""
    HEIDENHAIN = "heidenhain"
    """Klartext, mills only"""

    @property
    def suffix(self) -> str:
        """Ending of its files."""
        return SUFFIXES[self]


class Writer(Protocol):
    """What writes one program."""

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """The program, line by line."""
        ...


class Reader(Protocol):
    """What reads one program."""

    def blocks(self, lines: Iterable[str]) -> Iterator[Block]:
        """Neutral blocks of the program."""
        ...


SUFFIXES = {
    Control.CANONICAL: ".canonical.txt",
    Control.LINUXCNC: ".ngc",
    Control.FANUC: ".nc",
    Control.HAAS: ".nc",
    Control.SINUMERIK: ".mpf",
    Control.HEIDENHAIN: ".h",
}

WRITERS: dict[Control, Callable[[], Writer]] = {
    Control.LINUXCNC: LinuxCnc,
    Control.FANUC: Fanuc,
    Control.HAAS: lambda: Fanuc(HAAS),
    Control.SINUMERIK: Sinumerik,
    Control.HEIDENHAIN: Heidenhain,
}

READERS: dict[Control, Callable[[Machine], Reader]] = {
    Control.LINUXCNC: LinuxCncReader,
    Control.FANUC: FanucReader,
    Control.HAAS: lambda machine: FanucReader(machine, HAAS),
    Control.SINUMERIK: SinumerikReader,
    Control.HEIDENHAIN: HeidenhainReader,
}


def write(
    blocks: Iterable[Block], control: Control, *, cycles: Cycles = Cycles.EXPANDED
) -> Iterator[str]:
    """Lines of NC code, without their ends; made as they are asked for.

    Raises
    ------
    PostError
        At a block that the control cannot do.
    """
    if control is Control.CANONICAL:
        return canonical.write(blocks)
    return WRITERS[control]().lines(blocks, cycles)


def read_blocks(
    lines: Iterable[str], control: Control, *, machine: Machine = Machine.MILL
) -> Iterator[Block]:
    """Neutral blocks of NC code, as far as its dialect is known.

    Parameters
    ----------
    lines : iterable of str
    control : Control
    machine : Machine
        What the code is for; Fanuc and Haas code does not say.

    Raises
    ------
    PostError
        At a word that is not known there, or an arc that is none, with its line.
    """
    if control is Control.CANONICAL:
        raise PostError("canonical commands are no NC code: they have no blocks")
    return READERS[control](machine).blocks(lines)


def read(
    lines: Iterable[str], control: Control, *, machine: Machine = Machine.MILL
) -> tuple[Canonical, ...]:
    """Canonical commands of NC code; the arguments are those of :func:`read_blocks`."""
    if control is Control.CANONICAL:
        return tuple(read_canonical.read(lines))
    return tuple(commands(read_blocks(lines, control, machine=machine)))
