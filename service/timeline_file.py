"""A run of the machine as a Parquet or CSV file, written as it comes, in bounded memory.

The file gets its name when it is whole. A run that is broken off leaves what it has under
``.partial``, closed and readable.
"""

import os
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType

import numpy as np
import pyarrow as pa
from pyarrow import csv, parquet

from simulator.machine.samples import Samples, joined
from simulator.timeline import COLUMNS, Column
from stepnc_model.errors import WriteError

ROWS = 32_768
"""in one group of the file"""

MOST_PARTS = 512
"""that wait in memory, each with an overhead of its own"""

EXACT = frozenset({"time", "position"})
"""columns that keep 64 bits; sensors do not have the digits of the others"""

WHOLE = frozenset({"line", "tool"})
"""columns of numbers that count"""

SUFFIXES = (".parquet", ".csv")


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
        self.path = path
        self.rows = 0
        self.place: Path | None = None
        """where the file lies once it is closed"""
        self._workingsteps = workingsteps
        self._program = program
        self._waiting: list[Samples] = []
        self._count = 0
        self._is_text = require_suffix(path) == ".csv"
        try:
            descriptor, self._name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            self._file = os.fdopen(descriptor, "wb")
            self._writer = self._opened()
        except OSError as error:
            raise self._refused(error) from error

    @property
    def partial(self) -> Path:
        """Where a broken-off run is left."""
        return self.path.with_suffix(f".partial{self.path.suffix}")

    def __enter__(self) -> "TimelineFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self._flush()
            self._writer.close()
            self._file.flush()
            os.fsync(self._file.fileno())
            if kind is None or self.rows:
                place = self.path if kind is None else self.partial
                os.chmod(self._name, _mode(place))
                os.replace(self._name, place)
                self.place = place
        except OSError as failure:
            raise self._refused(failure) from failure
        finally:
            # What the disk has refused once it refuses again.
            with suppress(OSError):
                self._file.close()
            Path(self._name).unlink(missing_ok=True)

    def add(self, samples: Samples) -> None:
        """More samples, later than those before."""
        self._waiting.append(samples)
        self._count += len(samples)
        if self._count >= ROWS:
            self._flush()
        elif len(self._waiting) >= MOST_PARTS:
            self._waiting = [joined(self._waiting)]

    def _opened(self) -> parquet.ParquetWriter | csv.CSVWriter:
        schema = timeline_schema(events=pa.string() if self._is_text else EVENT)
        if self._is_text:
            return csv.CSVWriter(self._file, schema)
        floats = [field.name for field in schema if pa.types.is_floating(field.type)]
        return parquet.ParquetWriter(
            self._file,
            schema,
            compression="zstd",
            # Measured values hardly repeat; their bytes compress when each has its stream.
            use_dictionary=[name for name in schema.names if name not in floats],
            use_byte_stream_split=floats,
        )

    def _flush(self) -> None:
        if not self._count:
            return
        samples, self._waiting, self._count = joined(self._waiting), [], 0
        names = {"program": (self._program,), "workingstep": ("", *self._workingsteps)}
        arrays = [_array(column, samples, names) for column in COLUMNS]
        if self._is_text:
            arrays = [
                array.dictionary_decode() if isinstance(array, pa.DictionaryArray) else array
                for array in arrays
            ]
        headings = [column.name for column in COLUMNS]
        try:
            self._writer.write(pa.record_batch(arrays, names=headings))
        except OSError as error:
            raise self._refused(error) from error
        self.rows += len(samples)

    def _refused(self, error: OSError) -> WriteError:
        return WriteError(error.strerror or str(error), path=str(self.path))


def require_suffix(path: Path) -> str:
    """The ending of a file for a run, in small letters.

    Raises
    ------
    WriteError
        When it is neither of the two.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise WriteError(f"a run is written as {' or '.join(SUFFIXES)}", path=str(path))
    return suffix


Names = Mapping[str, tuple[str, ...]]
"""words that only the run knows, by the attribute of the samples"""

OF_RUN: Names = {"program": (), "workingstep": ()}

EVENT = pa.dictionary(pa.int32(), pa.string())
"""words that come again and again"""


def timeline_schema(*, events: pa.DataType = EVENT) -> pa.Schema:
    """Names and types of the columns, each with its unit as metadata."""

    def kind(column: Column) -> pa.DataType:
        if _words(column, OF_RUN) is not None:
            return events
        if column.source in WHOLE:
            return pa.int32()
        return pa.float64() if column.source in EXACT else pa.float32()

    return pa.schema([
        pa.field(column.name, kind(column), metadata={"unit": column.unit})
        for column in COLUMNS
    ])


def _words(column: Column, of_run: Names) -> tuple[str, ...] | None:
    """What the numbers of a column stand for; None: themselves."""
    return of_run.get(column.source, column.words)


def _array(column: Column, samples: Samples, of_run: Names) -> pa.Array:
    """One column of the file."""
    values = getattr(samples, column.source)
    if column.axis is not None:
        values = values[:, column.axis]
    words = _words(column, of_run)
    if words is not None:
        return pa.DictionaryArray.from_arrays(
            pa.array(values.astype(np.int32)), pa.array(words)
        )
    if column.source in WHOLE:
        return pa.array(values.astype(np.int32))
    kind = np.float64 if column.source in EXACT else np.float32
    # NaN: the sample is missing.
    return pa.array((values * column.scale).astype(kind), from_pandas=True)


def _mode(place: Path) -> int:
    """Permissions of the file that is replaced, or what a new file gets."""
    if place.exists():
        return place.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask
