"""Bytes of an NC program and its blocks; the blocks laid end to end are the file.

Only the offsets of the blocks are kept, so that a file of 100 MB needs little more than itself.
A line ends with LF, CR LF or a single CR. Klartext continues a block on the next line with a
tilde: such lines form one block.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepnc_model.post.dialect import Dialect

CHUNK = 1 << 22
"""Bytes that are searched for line ends at a time."""

CONTINUED = re.compile(rb"~[ \t]*(?:\r\n|\n|\r)")

LF, CR = 10, 13


@dataclass(frozen=True, slots=True, kw_only=True)
class NcText:
    """Bytes of an NC program with the places of its blocks."""

    data: bytes
    starts: NDArray[np.int64]
    """(N + 1,) array: offset of each block, and the size of the file."""
    lines: NDArray[np.int64]
    """(N,) array: line of each block, counted from 1."""

    def __len__(self) -> int:
        return len(self.lines)

    def block(self, index: int) -> str:
        """Text of a block with its line end; one character stands for one byte."""
        return self.data[self.starts[index] : self.starts[index + 1]].decode("latin-1")

    def blocks(self) -> Iterator[str]:
        """Texts of all blocks, in the order of the file."""
        for index in range(len(self)):
            yield self.block(index)

    def line(self, index: int) -> int:
        """Line on which a block begins, counted from 1."""
        return int(self.lines[index])


def text_of(data: bytes, dialect: Dialect) -> NcText:
    r"""Find the blocks of an NC program.

    Parameters
    ----------
    data : bytes
        Content of the file; any bytes are accepted.
    dialect : Dialect

    Examples
    --------
    >>> text = text_of(b"G0 X1\r\nG1 X2 F100", Dialect.LINUXCNC)
    >>> list(text.blocks())
    ['G0 X1\r\n', 'G1 X2 F100']
    """
    ends = _line_ends(data)
    starts = np.concatenate((np.zeros(1, np.int64), ends))
    if len(starts) < 2 or starts[-1] != len(data):
        starts = np.append(starts, len(data))
    if not data:
        starts = np.zeros(1, np.int64)
    numbers = np.arange(1, len(starts), dtype=np.int64)
    if dialect is Dialect.HEIDENHAIN:
        joined = [found.end() for found in CONTINUED.finditer(data)]
        keeps = ~np.isin(starts[:-1], np.array(joined, np.int64))
        starts, numbers = np.append(starts[:-1][keeps], starts[-1]), numbers[keeps]
    return NcText(data=data, starts=starts, lines=numbers)


def _line_ends(data: bytes) -> NDArray[np.int64]:
    """Offsets behind each line end."""
    whole = np.frombuffer(data, np.uint8)
    found = [np.zeros(0, np.int64)]
    for begin in range(0, len(whole), CHUNK):
        part = whole[begin : begin + CHUNK]
        follows = whole[begin + 1 : begin + CHUNK + 1]
        is_end = part == LF
        returns = part == CR
        returns[: len(follows)] &= follows != LF
        found.append(np.flatnonzero(is_end | returns) + (begin + 1))
    return np.concatenate(found)
