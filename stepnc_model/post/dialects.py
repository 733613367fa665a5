"""Common interface for writing the NC code of all supported controls."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Protocol

from stepnc_model.errors import PostError
from stepnc_model.post import canonical, heidenhain
from stepnc_model.post.blocks import Block, Cycles, PathControl, ProgramStart
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.fanuc import HAAS, Fanuc
from stepnc_model.post.heidenhain import Heidenhain
from stepnc_model.post.linuxcnc import LinuxCnc
from stepnc_model.post.sinumerik import Sinumerik


class Writer(Protocol):
    """Writer of one NC program."""

    def lines(self, blocks: Iterable[Block], cycles: Cycles) -> Iterator[str]:
        """Lines of the NC program."""
        ...


WRITERS: dict[Dialect, Callable[[], Writer]] = {
    Dialect.LINUXCNC: LinuxCnc,
    Dialect.FANUC: Fanuc,
    Dialect.HAAS: lambda: Fanuc(HAAS),
    Dialect.SINUMERIK: Sinumerik,
    Dialect.HEIDENHAIN: Heidenhain,
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
        PathControl(tolerance=0.0) if isinstance(block, PathControl) else block
        for block in blocks
    )


def with_adaptive_feed(blocks: Iterable[Block], control: Dialect) -> Iterator[Block]:
    """Blocks of a program whose feed an outer loop may change (M52 P1 of LinuxCNC).

    Raises
    ------
    PostError
        If the control is another one.
    """
    if control is not Dialect.LINUXCNC:
        text = f"adaptive feed is written for linuxcnc, not {control.value}"
        raise PostError(f"{text}: omit --adaptive-feed")
    return (
        replace(block, has_adaptive_feed=True) if isinstance(block, ProgramStart) else block
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
