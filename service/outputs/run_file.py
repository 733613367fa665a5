"""Rows of a run on their way to a Parquet or CSV file, written as they come.

The file gets its name when it is whole. A run that is broken off leaves what it has under
``.partial``, closed and readable. Parquet needs pyarrow, which is loaded for it only.

A file that is written bit by bit, and gets its name when it is whole.

What is broken off is left as ``.partial``, closed and readable.
"""

import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Protocol

import numpy as np
import orjson
from numpy.typing import NDArray

from service.optional_packages import missing_extras_named
from service.outputs.formula import disarmed
from stepnc_model.errors import WriteError

if TYPE_CHECKING:
    import pyarrow as pa


class GrowingFile:
    """File under a temporary name. Running state.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.place: Path | None = None
        """Name of the file once it is closed."""
        try:
            descriptor, self._name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            self.stream = os.fdopen(descriptor, "wb")
        except OSError as error:
            raise self.refused(error) from error

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self.path.with_suffix(f".partial{self.path.suffix}")

    @contextmanager
    def closing(
        self, *, is_whole: bool, has_content: Callable[[], bool] = lambda: True
    ) -> Iterator[None]:
        """Write the last bytes within it; then the file gets its name, or is left as partial.

        A file without content is left only when it is whole.

        Raises
        ------
        WriteError
            When the disk refuses; nothing is left.
        """
        try:
            yield
            self.stream.flush()
            os.fsync(self.stream.fileno())
            if is_whole or has_content():
                place = self.path if is_whole else self.partial
                os.chmod(self._name, _mode(place))
                os.replace(self._name, place)
                self.place = place
        except OSError as failure:
            raise self.refused(failure) from failure
        finally:
            # What the disk has refused once it refuses again.
            with suppress(OSError):
                self.stream.close()
            Path(self._name).unlink(missing_ok=True)

    def refused(self, error: OSError) -> WriteError:
        """Error for what the disk refused."""
        return WriteError(error.strerror or str(error), path=str(self.path))


def _mode(place: Path) -> int:
    """Permissions of the file that is replaced, or what a new file gets."""
    if place.exists():
        return place.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


SUFFIXES = (".parquet", ".csv")

AT_ONCE = 4096
"""rows that become text together"""


class ColumnKind(StrEnum):
    """Type of a column, by its name in Arrow."""

    EXACT = "float64"
    NUMBER = "float32"
    COUNT = "int32"
    INTEGER = "int64"
    TRUTH = "bool"
    WORDS = "dictionary"
    """words that come again and again"""
    TEXT = "string"
    MOMENT = "timestamp"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunColumn:
    """One column of the file."""

    name: str
    kind: ColumnKind = ColumnKind.NUMBER
    unit: str = ""
    notes: Mapping[str, str] = field(default_factory=dict)
    """metadata beside the unit"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Words:
    """Words by their numbers."""

    codes: NDArray[np.int32]
    """(N,) place among the names; negative: none"""
    names: Sequence[str]

    def __len__(self) -> int:
        return len(self.codes)


Values = NDArray[Any] | Words | Sequence[str | float | int | bool | datetime | None]
"""values of a column; NaN is a sample that is missing"""


def words_of(values: Iterable[object]) -> Words:
    """Words and their numbers, in the order in which they first come."""
    places: dict[str, int] = {}
    codes = [
        -1 if each is None else places.setdefault(str(each), len(places)) for each in values
    ]
    return Words(codes=np.array(codes, np.int32), names=list(places))


class RunFile:
    """A file that grows. Running state; what ends it stands in :meth:`closing`.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet`` or ``.csv``.

    Raises
    ------
    WriteError
        When the ending is another, or the disk refuses.
    """

    def __init__(self, path: Path, columns: Sequence[RunColumn]) -> None:
        self.path = path
        self.rows = 0
        is_text = require_suffix(path) == ".csv"
        with missing_extras_named(f"{path.name}: Parquet"):
            schema = None if is_text else arrow_schema(columns)
        self._file = GrowingFile(path)
        try:
            self._writer: _Rows = (
                CsvRows(self._file.stream, columns)
                if schema is None
                else _ParquetRows(self._file.stream, schema)
            )
        except OSError as error:
            raise self._file.refused(error) from error

    @property
    def place(self) -> Path | None:
        """Name of the file once it is closed."""
        return self._file.place

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self._file.partial

    def write(self, values: Sequence[Values]) -> None:
        """More rows, as columns in their order.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        try:
            self._writer.write(values)
        except OSError as error:
            raise self._file.refused(error) from error
        self.rows += len(values[0])

    @contextmanager
    def closing(self, *, is_whole: bool) -> Iterator[None]:
        """Write the last rows within it; then the file gets its name, or is left as partial.

        A file without rows is left only when it is whole.

        Raises
        ------
        WriteError
            When the disk refuses; nothing is left.
        """
        with self._file.closing(is_whole=is_whole, has_content=lambda: bool(self.rows)):
            yield
            self._writer.close()


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


def arrow_schema(columns: Sequence[RunColumn]) -> "pa.Schema":
    """Names and types of the columns, each with its unit and notes as metadata."""
    import pyarrow as pa  # noqa: PLC0415 (an extra)

    kinds = {
        ColumnKind.WORDS: pa.dictionary(pa.int32(), pa.string()),
        ColumnKind.MOMENT: pa.timestamp("us", tz="UTC"),
    }
    return pa.schema([
        pa.field(
            each.name,
            kinds.get(each.kind) or pa.type_for_alias(each.kind.value),
            metadata={"unit": each.unit, **each.notes},
        )
        for each in columns
    ])


class _Rows(Protocol):
    """Writer of one format."""

    def write(self, values: Sequence[Values]) -> None: ...

    def close(self) -> None: ...


class _ParquetRows:
    """Groups of rows of a Parquet file. Running state."""

    def __init__(self, stream: BinaryIO, schema: "pa.Schema") -> None:
        import pyarrow as pa  # noqa: PLC0415 (an extra)
        from pyarrow import parquet  # noqa: PLC0415

        floats = [each.name for each in schema if pa.types.is_floating(each.type)]
        self._schema = schema
        self._writer = parquet.ParquetWriter(
            stream,
            schema,
            compression="zstd",
            # Measured values hardly repeat; their bytes compress when each has its stream.
            use_dictionary=[name for name in schema.names if name not in floats],
            use_byte_stream_split=floats,
        )

    def write(self, values: Sequence[Values]) -> None:
        import pyarrow as pa  # noqa: PLC0415 (an extra)

        arrays = [
            pa.DictionaryArray.from_arrays(
                pa.array(each.codes, mask=each.codes < 0), pa.array(each.names, pa.string())
            )
            if isinstance(each, Words)
            else pa.array(each, column.type, from_pandas=True)
            for column, each in zip(self._schema, values, strict=True)
        ]
        self._writer.write(pa.record_batch(arrays, schema=self._schema))

    def close(self) -> None:
        self._writer.close()


class CsvRows:
    """Lines of a CSV file; an empty cell is a missing value, texts stand in quotes."""

    def __init__(self, stream: BinaryIO, columns: Sequence[RunColumn]) -> None:
        self._stream = stream
        stream.write(b",".join(_quoted(each.name) for each in columns) + b"\n")

    def write(self, values: Sequence[Values]) -> None:
        """Write rows as lines."""
        for begin in range(0, len(values[0]), AT_ONCE):
            rows = slice(begin, begin + AT_ONCE)
            cells = [_cells(each, rows) for each in values]
            self._stream.writelines(
                b",".join(line) + b"\n" for line in zip(*cells, strict=True)
            )

    def close(self) -> None:
        """Every line has been written."""


def _cells(values: Values, rows: slice) -> list[bytes]:
    """Cells of some rows: numbers with the digits that they need, words in quotes."""
    if isinstance(values, Words):
        # The last one is that of a missing word, whose code is -1.
        texts = [*map(_quoted, values.names), b""]
        return [texts[max(code, -1)] for code in values.codes[rows].tolist()]
    if isinstance(values, np.ndarray):
        numbers = np.ascontiguousarray(values[rows])
        text = orjson.dumps(numbers, option=orjson.OPT_SERIALIZE_NUMPY)
        cells = text[1:-1].split(b",")
        # JSON knows neither NaN nor infinity.
        for row in np.flatnonzero(~np.isfinite(numbers)).tolist():
            cells[row] = b"" if np.isnan(numbers[row]) else repr(float(numbers[row])).encode()
        return cells
    return [
        b"" if each is None else _quoted(each) if isinstance(each, str) else orjson.dumps(each)
        for each in values[rows]
    ]


def _quoted(text: str) -> bytes:
    """A text in quotes, none of which becomes a formula."""
    doubled = disarmed(text).replace('"', '""')
    return f'"{doubled}"'.encode()
