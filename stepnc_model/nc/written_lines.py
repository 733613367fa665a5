"""Lines of a rewritten NC program, and the lines that they come from.

Blocks that are divided and lines that are put in move all lines behind them. Only the places
where the count of lines changes are kept.
"""

import re
from array import array
from bisect import bisect_right
from dataclasses import dataclass, field

LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True, kw_only=True)
class LineOrigin:
    """Part of a line of the program that a rewritten line comes from."""

    line: int
    """Line of the program, counted from 1."""
    begin: float
    """Begin of the part as a fraction of the move, 0 to 1."""
    end: float
    """End of the part."""


@dataclass(slots=True)
class WrittenLines:
    """Origins of the lines of a rewritten program. Running state while it is written."""

    added: int = 0
    """Number of lines that were added so far."""
    _firsts: "array[int]" = field(default_factory=lambda: array("q", [1]))
    _lines: "array[int]" = field(default_factory=lambda: array("q", [1]))
    _begins: "array[float]" = field(default_factory=lambda: array("d", [0.0]))
    _ends: "array[float]" = field(default_factory=lambda: array("d", [1.0]))

    def put_before(self, line: int) -> None:
        """Note a line without a move that was put before a line of the program."""
        self.added += 1
        self._put(line + self.added, line, 0.0, 1.0)

    def divide(self, line: int, lengths: list[float]) -> None:
        """Note the pieces of a line that was divided, by their lengths."""
        first, whole, before = line + self.added, sum(lengths), 0.0
        for row, length in enumerate(lengths):
            is_last = row == len(lengths) - 1
            end = 1.0 if is_last else before + length / whole
            self._put(first + row, line, before, end)
            before = end
        self.added += len(lengths) - 1
        self._put(line + 1 + self.added, line + 1, 0.0, 1.0)

    def origin(self, line: int) -> LineOrigin:
        """Part of the program that a rewritten line comes from.

        Parameters
        ----------
        line : int
            Line of the rewritten program, counted from 1.
        """
        row = bisect_right(self._firsts, line) - 1
        beyond = line - self._firsts[row]
        if beyond:
            return LineOrigin(line=self._lines[row] + beyond, begin=0.0, end=1.0)
        return LineOrigin(line=self._lines[row], begin=self._begins[row], end=self._ends[row])

    def _put(self, first: int, line: int, begin: float, end: float) -> None:
        if first == self._firsts[-1]:
            for column in (self._firsts, self._lines, self._begins, self._ends):
                column.pop()
        self._firsts.append(first)
        self._lines.append(line)
        self._begins.append(begin)
        self._ends.append(end)


def line_ends(text: str) -> int:
    """Return the number of line ends in a text."""
    return sum(1 for _ in LINE_END.finditer(text))
