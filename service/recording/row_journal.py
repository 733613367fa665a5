"""Rows of a recording as lines of a CSV file, on the disk before they are announced.

A Parquet file can only be read once its last bytes are written. So a recording writes its rows
here too, as they come; the file goes when that of the recording has its name. What is left
after a power cut or ``kill -9`` is a table that every command reads which reads a recording,
but for a last line that may be cut off.
"""

import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from service.run_file import CsvRows, RunColumn, Values
from stepnc_model.errors import WriteError

if TYPE_CHECKING:
    from io import BufferedWriter


class RowJournal:
    """Open journal of a recording. Running state.

    Parameters
    ----------
    path : Path
        File that the recording will have; the journal stands beside it, as ``.partial.csv``.
    columns : sequence of RunColumn

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, path: Path, columns: Sequence[RunColumn]) -> None:
        self.place = path
        try:
            self.place, self._stream = _opened(path)
            self._rows = CsvRows(self._stream, columns)
        except OSError as error:
            raise self._refused(error) from error

    def write(self, values: Sequence[Values]) -> None:
        """Hand rows over to the operating system, which keeps them when this process dies.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        try:
            self._rows.write(values)
            self._stream.flush()
        except OSError as error:
            raise self._refused(error) from error

    def sync(self) -> None:
        """Wait until all rows are on the disk, which keeps them when the power fails.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        try:
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise self._refused(error) from error

    def close(self) -> None:
        """Close the file and leave it."""
        # What the disk has refused once it refuses again.
        with suppress(OSError):
            self._stream.close()

    def remove(self) -> None:
        """Remove the file: its rows stand in that of the recording."""
        self.close()
        self.place.unlink(missing_ok=True)

    def _refused(self, error: OSError) -> WriteError:
        return WriteError(error.strerror or str(error), path=str(self.place))


def _opened(path: Path) -> "tuple[Path, BufferedWriter]":
    """First free name beside a file, opened: that of a broken-off recording stays as it is."""
    number = 1
    while True:
        ending = ".partial.csv" if number == 1 else f".partial-{number}.csv"
        place = path.with_suffix(ending)
        with suppress(FileExistsError):
            return place, place.open("xb")
        number += 1
