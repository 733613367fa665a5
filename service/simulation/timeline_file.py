"""The samples of a simulated run as a Parquet or CSV file, in bounded memory."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.run_file import ColumnKind, RunColumn, RunFile, Values, Words
from simulator.machine.samples import Samples, joined
from simulator.timeline import COLUMNS, DataItem

ROWS = 32_768
"""in one group of the file"""

MOST_PARTS = 512
"""that wait in memory, each with an overhead of its own"""

EXACT = frozenset({"time", "position"})
"""columns that keep 64 bits; sensors do not have the digits of the others"""

WHOLE = frozenset({"line", "tool"})
"""columns of numbers that count"""


class TimelineFile:
    """Samples on their way to a file. Running state; use it with ``with``.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet`` or ``.csv``.
    workingsteps : sequence of str
        Ids by their number, from 1; may grow while samples come.
    program : str
        Its name.

    Raises
    ------
    WriteError
        When the ending is another, or the disk refuses.
    """

    def __init__(self, path: Path, workingsteps: Sequence[str], *, program: str = "") -> None:
        self._run = RunFile(path, timeline_columns())
        self._workingsteps = workingsteps
        self._program = program
        self._waiting: list[Samples] = []
        self._count = 0

    @property
    def rows(self) -> int:
        """Number of rows written."""
        return self._run.rows

    @property
    def place(self) -> Path | None:
        """Name of the file once it is closed."""
        return self._run.place

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self._run.partial

    def __enter__(self) -> "TimelineFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._run.closing(is_whole=kind is None):
            self._flush()

    def add(self, samples: Samples) -> None:
        """More samples, later than those before."""
        self._waiting.append(samples)
        self._count += len(samples)
        if self._count >= ROWS:
            self._flush()
        elif len(self._waiting) >= MOST_PARTS:
            self._waiting = [joined(self._waiting)]

    def _flush(self) -> None:
        if not self._count:
            return
        samples, self._waiting, self._count = joined(self._waiting), [], 0
        names = {"program": (self._program,), "workingstep": ("", *self._workingsteps)}
        self._run.write([_values(column, samples, names) for column in COLUMNS])


Names = Mapping[str, tuple[str, ...]]
"""words that only the run knows, by the attribute of the samples"""

OF_RUN: Names = {"program": (), "workingstep": ()}


def timeline_columns() -> list[RunColumn]:
    """Columns of the file, in their order."""

    def kind(column: DataItem) -> ColumnKind:
        if _words(column, OF_RUN) is not None:
            return ColumnKind.WORDS
        if column.source in WHOLE:
            return ColumnKind.COUNT
        return ColumnKind.EXACT if column.source in EXACT else ColumnKind.NUMBER

    return [
        RunColumn(name=column.name, kind=kind(column), unit=column.unit) for column in COLUMNS
    ]


def _words(column: DataItem, of_run: Names) -> tuple[str, ...] | None:
    """Words of the numbers of a column; None: it has numbers."""
    return of_run.get(column.source, column.words)


def _values(column: DataItem, samples: Samples, of_run: Names) -> Values:
    """One column of the file."""
    values: NDArray[Any] = getattr(samples, column.source)
    if column.axis is not None:
        values = values[:, column.axis]
    words = _words(column, of_run)
    if words is not None:
        return Words(codes=values.astype(np.int32), names=words)
    if column.source in WHOLE:
        return values.astype(np.int32)
    kind = np.float64 if column.source in EXACT else np.float32
    return (values * column.scale).astype(kind)
