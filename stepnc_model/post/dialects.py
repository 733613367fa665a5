"""Common interface for writing and reading the NC code of all supported controls."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Protocol

from stepnc_model.errors import PostError
from stepnc_model.post import canonical, heidenhain
from stepnc_model.post.blocks import Block, Comment, Cycles, MachineType
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.fanuc import HAAS, Fanuc, FanucReader
from stepnc_model.post.heidenhain import Heidenhain
from stepnc_model.post.linuxcnc import LinuxCnc, LinuxCncReader
from stepnc_model.post.read_heidenhain import HeidenhainReader
from stepnc_model.post.sinumerik import Sinumerik, SinumerikReader


class Writer(Protocol):
    """Writer of one NC program."""

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """Lines of the NC program."""
        ...


class NcReader(Protocol):
    """Reader of one NC program."""

    def blocks(self, lines: Iterable[str]) -> Iterator[Block]:
        """Neutral blocks of the NC program."""
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

PLACES: dict[Dialect, int] = {
    Dialect.CANONICAL: canonical.PLACES,
    Dialect.LINUXCNC: LinuxCnc.places,
    Dialect.FANUC: Fanuc.places,
    Dialect.HAAS: Fanuc.places,
    Dialect.SINUMERIK: Sinumerik.places,
    Dialect.HEIDENHAIN: heidenhain.PLACES,
}
"""Decimal places of a written coordinate in mm."""


def coordinate_increment(control: Dialect) -> float:
    """Smallest step of a written coordinate, mm."""
    return float(10.0 ** -PLACES[control])


WITHOUT_EXACT_STOPS = frozenset({Dialect.CANONICAL, Dialect.HEIDENHAIN})
"""Controls for which exact stops are not written; Klartext has no modal word for them."""


def with_exact_stops(blocks: Iterable[Block], control: Dialect) -> Iterator[Block]:
    """Blocks whose workingsteps run with exact stops instead of a path tolerance.

    Raises
    ------
    PostError
        If exact stops are not written for the control.
    """
    if control in WITHOUT_EXACT_STOPS:
        raise PostError(f"exact stops are not written for {control.value}: omit --exact-path")
    return (
        replace(block, tolerance=0.0)
        if isinstance(block, Comment) and block.workingstep
        else block
        for block in blocks
    )


def write(
    blocks: Iterable[Block], control: Dialect, *, cycles: Cycles = Cycles.EXPANDED
) -> Iterator[str]:
    """Write NC code line by line, without line ends; lines are generated lazily.

    Raises
    ------
    PostError
        If the control cannot execute a block.
    """
    if control is Dialect.CANONICAL:
        return canonical.write(blocks)
    return WRITERS[control]().lines(blocks, cycles)


def read_blocks(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> Iterator[Block]:
    """Read NC code as neutral blocks.

    Parameters
    ----------
    lines : iterable of str
    control : Dialect
    machine : MachineType
        Machine that the code is for; Fanuc and Haas code does not say.

    Raises
    ------
    PostError
        If a word is unknown to the dialect or an arc is invalid, with its line.
    """
    if control is Dialect.CANONICAL:
        raise PostError("canonical commands are not NC code: they cannot be read as blocks")
    return READERS[control](machine).blocks(lines)


def read(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> tuple[Canonical, ...]:
    """Read NC code as canonical commands; arguments as for :func:`read_blocks`."""
    if control is Dialect.CANONICAL:
        return tuple(canonical.read(lines))
    return tuple(commands(read_blocks(lines, control, machine=machine)))
