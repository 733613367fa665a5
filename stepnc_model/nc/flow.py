"""Order in which the blocks of an NC program are executed: calls, returns and repeats.

Bounds keep endless loops from running: a program that calls itself, or repeats too often, is
refused with the line.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepnc_model.errors import PostError
from stepnc_model.nc.recorder import RAISED, MoveRecorder
from stepnc_model.nc.text import NcText

DEEPEST = 50
"""Greatest number of calls within each other; controls allow 4 to 20."""

MOST_REPEATED = 1_000_000
"""Greatest number of executed blocks beyond the blocks of the file."""

MOVES_PER_BLOCK = 10
"""Moves of each block of the file that do not count as repeated: a hole takes 4 or 5."""

BYTES_PER_REPEAT = 40
"""Mean bytes of a repeated block; longer ones, which take longer, may be repeated less."""

BEHIND_THE_END = (
    "stands behind the end of the program and is not executed: the feeds from here stay as "
    "they are; if it is another program, give it a file of its own"
)
"""Remark on moves behind the end of a program."""


MOST_LOOPED = 100_000
"""Number of blocks beyond those of the file after which loops are left."""


@dataclass(slots=True)
class _Level:
    """Call or repeat under way."""

    here: int
    """Block that called or repeats."""
    target: int
    left: int
    """Number of further executions."""
    call: int
    """Call that it was made from."""
    is_repeat: bool


class ProgramFlow:
    """Calls and repeats under way. Running state."""

    def __init__(self, text: NcText, recorder: MoveRecorder) -> None:
        self._text = text
        self._recorder = recorder
        self._levels: list[_Level] = []
        self._executed = 0
        self._bytes = 0
        """Bytes of the executed blocks."""
        self.allow(MOST_REPEATED)
        self.trace: list[int] | None = None
        """Blocks in the order of their execution, without those that steer; None: not kept."""

    def allow(self, most: int) -> None:
        """Bound the blocks, and the moves, that are executed beyond those of the file.

        Counts bound the time too: on a slow machine the same programs are refused.
        """
        self._most = most
        self._recorder.bound(self._text, MOVES_PER_BLOCK * len(self._text) + most)

    @property
    def is_called(self) -> bool:
        """True if a subprogram is being executed."""
        return any(not level.is_repeat for level in self._levels)

    @property
    def depth(self) -> int:
        """Number of subprograms being executed within each other."""
        return sum(not level.is_repeat for level in self._levels)

    @property
    def is_worn_out(self) -> bool:
        """True if so many blocks were repeated that no further loop is begun."""
        return self._executed > len(self._text) + MOST_LOOPED

    def is_inside(self, target: int) -> bool:
        """True if the subprogram at a block is being executed."""
        return any(level.target == target for level in self._levels if not level.is_repeat)

    def step(self, block: int) -> None:
        """Count an executed block.

        Raises
        ------
        PostError
            If the program repeats blocks too often.
        """
        text = self._text
        self._executed += 1
        self._bytes += int(text.starts[block + 1] - text.starts[block])
        if self.trace is not None:
            self.trace.append(block)
        if self._executed > len(text) + self._most:
            raise PostError(
                f"the program repeats more than {self._most} blocks: is this loop endless? "
                f"{RAISED}",
                line=text.line(block),
            )
        most = BYTES_PER_REPEAT * self._most
        if self._bytes > len(text.data) + most:
            raise PostError(
                f"the program repeats blocks of more than {most} bytes, {BYTES_PER_REPEAT} for "
                f"each of {self._most} blocks: is this loop endless? {RAISED}",
                line=text.line(block),
            )

    def steered(self, following: int) -> None:
        """Note that the last executed block only says which one follows."""
        if self.trace is not None and following < len(self._text):
            self.trace.pop()

    def call(self, here: int, target: int, *, times: int = 1) -> int:
        """Enter a subprogram; return the block to execute next.

        Raises
        ------
        PostError
            If calls are nested too deeply.
        """
        if times < 1:
            return here + 1
        self._enter(_Level(here, target, times - 1, self._recorder.call, is_repeat=False))
        return target

    def leave(self) -> int | None:
        """Return from a subprogram to the next block, or None if none is being executed."""
        while self._levels and self._levels[-1].is_repeat:
            self._recorder.call = self._levels.pop().call
        if not self._levels:
            return None
        level = self._levels[-1]
        if level.left > 0:
            level.left -= 1
            self._begin(level)
            return level.target
        self._recorder.call = self._levels.pop().call
        return level.here + 1

    def repeat(self, here: int, target: int, *, times: int) -> int:
        """Go back to a block a number of times; return the block to execute next.

        Raises
        ------
        PostError
            If repeats are nested too deeply.
        """
        level = self._levels[-1] if self._levels else None
        if level is None or not (level.is_repeat and level.here == here):
            if times < 1:
                return here + 1
            level = _Level(here, target, times, self._recorder.call, is_repeat=True)
            self._enter(level)
            level.left -= 1
            return target
        if level.left > 0:
            level.left -= 1
            self._begin(level)
            return target
        self._recorder.call = self._levels.pop().call
        return here + 1

    def _enter(self, level: _Level) -> None:
        if len(self._levels) >= DEEPEST:
            raise PostError(
                f"calls and repeats are nested more than {DEEPEST} deep",
                line=self._text.line(level.here),
            )
        self._levels.append(level)
        self._begin(level)

    def _begin(self, level: _Level) -> None:
        """Begin another execution: its moves name the block that it comes from."""
        self._recorder.calls.append((level.call, level.here))
        self._recorder.call = len(self._recorder.calls) - 1


def places(text: NcText, pattern: re.Pattern[bytes]) -> Iterator[tuple[str, int]]:
    """Find names in the whole program, with the blocks that hold them.

    Parameters
    ----------
    text : NcText
    pattern : pattern of bytes
        Its first group is the name.
    """
    for found in pattern.finditer(text.data):
        block = int(np.searchsorted(text.starts, found.start(1), side="right")) - 1
        yield found[1].decode("latin-1").strip().upper(), block
