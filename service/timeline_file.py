"""A run of the machine as a Parquet or CSV file, written as it comes, in bounded memory.

The file gets its name when it is whole. A run that is broken off leaves what it has under
``.partial``, closed and readable.
"""

import os
import tempfile
from collections.abc import Sequence
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

EXACT = frozenset({"time", "position"})
"""columns that keep 64 bits; sensors do not have the digits of the others"""

SUFFIXES = (".parquet", ".csv")


class TimelineFile:
    """Samples on their way to a file. Running state; use it with ``with``.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet`` or ``.csv``.
    workingsteps : sequence of str
        Ids by their number, from 1; may grow while samples come.

    Raises
    ------
    WriteError
        When the ending is another, or the disk refuses.
    """

    def __init__(self, path: Path, workingsteps: Sequence[str]) -> None:
        if path.suffix.lower() not in SUFFIXES:
            raise WriteError(f"a run is written as {' or '.join(SUFFIXES)}", path=str(path))
        self.path = path
        self.rows = 0
        self._workingsteps = workingsteps
        self._waiting: list[Samples] = []
        try:
            descriptor, self._name = tempfile.mkstemp(
                prefix=f".{path.name}.", suffix=path.suffix.lower(), dir=path.parent
            )
            os.close(descriptor)
            self._writer = self._opened()
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(path)) from error

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
            place = self.path if kind is None else self.partial
            if kind is None or self.rows:
                os.chmod(self._name, 0o666 & ~_umask())
                os.replace(self._name, place)
        except OSError as failure:
            reason = failure.strerror or str(failure)
            raise WriteError(reason, path=str(self.path)) from failure
        finally:
            Path(self._name).unlink(missing_ok=True)

    def add(self, samples: Samples) -> None:
        """More samples, later than those before."""
        self._waiting.append(samples)
        if sum(map(len, self._waiting)) >= ROWS:
            self._flush()

    def _opened(self) -> parquet.ParquetWriter | csv.CSVWriter:
        if self.path.suffix.lower() == ".csv":
            return csv.CSVWriter(self._name, _schema(np.str_))
        return parquet.ParquetWriter(self._name, _schema(np.int32), compression="zstd")

    def _flush(self) -> None:
        if not self._waiting:
            return
        samples, self._waiting = joined(self._waiting), []
        words = ("", *self._workingsteps)
        is_text = isinstance(self._writer, csv.CSVWriter)
        arrays = [_array(column, samples, words) for column in COLUMNS]
        if is_text:
            arrays = [
                array.cast(pa.string()) if pa.types.is_dictionary(array.type) else array
                for array in arrays
            ]
        try:
            self._writer.write(
                pa.record_batch(arrays, names=[column.name for column in COLUMNS])
            )
        except OSError as error:
            reason = error.strerror or str(error)
            raise WriteError(reason, path=str(self.path)) from error
        self.rows += len(samples)


def _array(column: Column, samples: Samples, workingsteps: tuple[str, ...]) -> pa.Array:
    """One column of the file."""
    values = getattr(samples, column.source)
    if column.axis is not None:
        values = values[:, column.axis]
    words = workingsteps if column.source == "workingstep" else column.words
    if words is not None:
        return pa.DictionaryArray.from_arrays(
            pa.array(values.astype(np.int32)), pa.array(words)
        )
    if values.dtype.kind == "f":
        kind = np.float64 if column.source in EXACT else np.float32
        # NaN: the sample is missing.
        return pa.array((values * column.scale).astype(kind), from_pandas=True)
    return pa.array(values.astype(np.int32))


def _schema(events: type) -> pa.Schema:
    """Types of the columns, with their units."""
    text = pa.string() if events is np.str_ else pa.dictionary(pa.int32(), pa.string())
    fields = []
    for column in COLUMNS:
        kind = pa.float64() if column.source in EXACT else pa.float32()
        if column.words is not None or column.source == "workingstep":
            kind = text
        elif column.source in {"line", "tool"}:
            kind = pa.int32()
        fields.append(pa.field(column.name, kind, metadata={"unit": column.unit}))
    return pa.schema(fields)


def _umask() -> int:
    umask = os.umask(0)
    os.umask(umask)
    return umask
