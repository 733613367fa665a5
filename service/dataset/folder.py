"""Folder of a data set: partitions of rows in Parquet, and a manifest of what made them.

A partition is written under another name and moved into place, so that it is there with all its
rows or not at all. What is there is never made again.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from service.dataset.rows import COLUMNS, SCHEMA
from service.files import read_bytes, write_atomically
from service.parquet_pieces import parquet_file, parquet_pieces
from service.rendering.records import dump
from service.run_file import RunFile, words_of
from stepnc_model.errors import StepNcError, WriteError

MANIFEST = "manifest.json"
CSV = "data.csv"
PROGRAMS = "programs"
"""Folder of the programs of the rows."""

IN_METADATA = b"stepnc_manifest"
"""Key of the manifest in the metadata of each partition."""

PARTITION = 100
"""Rows of a partition."""


@dataclass(frozen=True, slots=True)
class DatasetFolder:
    """Partitions of rows in a folder."""

    path: Path
    rows: int = PARTITION
    """Rows of a partition."""

    @property
    def is_made(self) -> bool:
        """Whether there is a manifest."""
        return (self.path / MANIFEST).exists()

    def prepare(self, manifest: Mapping[str, Any]) -> None:
        """Make the folder and its manifest, or check that what is there is of the same design.

        Raises
        ------
        StepNcError
            When the folder holds another data set, with the first key that differs.
        WriteError
            When the disk refuses.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(self.path)) from error
        file = self.path / MANIFEST
        wanted = json.loads(dump(manifest))
        if not self.is_made:
            if any(self.path.iterdir()):
                raise StepNcError(
                    f"{self.path}: not empty, and without {MANIFEST}: name another folder"
                )
            write_atomically(file, dump(manifest).encode())
            return
        found = self.manifest()
        for key in {**wanted, **found}:
            if found.get(key) != wanted.get(key):
                raise StepNcError(
                    f"{file}: {key}: the rows there were made with "
                    f"{_short(found.get(key))}, not {_short(wanted.get(key))}: name another "
                    "folder"
                )

    def manifest(self) -> dict[str, Any]:
        """Manifest of the rows that are there.

        Raises
        ------
        StepNcError
            When it cannot be read.
        """
        file = self.path / MANIFEST
        try:
            found = json.loads(read_bytes(file))
        except ValueError as error:
            raise StepNcError(f"{file}: is not JSON: {error}") from error
        if not isinstance(found, dict):
            raise StepNcError(f"{file}: is not the manifest of a data set")
        return found

    def place(self, number: int) -> Path:
        """Path of a partition, counted from 0."""
        return self.path / f"part-{number:06d}.parquet"

    def size(self, number: int, count: int) -> int:
        """Number of rows that a partition has among the first ``count``."""
        return min(self.rows, count - number * self.rows)

    def count(self, number: int) -> int:
        """Number of rows of a partition that are there."""
        path = self.place(number)
        if not path.exists():
            return 0
        with _opened(path) as file:
            rows: int = file.metadata.num_rows
        return rows

    def partition(self, number: int) -> pa.Table:
        """Rows of a partition."""
        place = self.place(number)
        with _opened(place) as file:
            schema = file.schema_arrow
        found = list(parquet_pieces(place, rows=self.rows))
        return pa.Table.from_batches(found, schema=schema)

    def write(self, number: int, rows: pa.Table) -> None:
        """Write a partition, whole or not at all.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        sink = pa.BufferOutputStream()
        told = {IN_METADATA: json.dumps(self.manifest()).encode()}
        parquet.write_table(rows.replace_schema_metadata(told), sink, compression="zstd")
        write_atomically(self.place(number), sink.getvalue().to_pybytes())

    def program(self, number: int) -> Path:
        """Path of the program of a row, by its number from 1."""
        return self.path / PROGRAMS / f"row-{number:06d}.stpnc"

    def tables(self, rows: int) -> Iterator[pa.Table]:
        """The first rows that are there, partition by partition."""
        number = 0
        while rows > 0 and self.place(number).exists():
            table = self.partition(number).slice(0, rows)
            yield table
            rows -= table.num_rows
            number += 1

    def write_csv(self, rows: int) -> Path:
        """Write the first rows as one CSV file.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        path = self.path / CSV
        file = RunFile(path, COLUMNS)
        with file.closing(is_whole=True):
            for table in self.tables(rows):
                for batch in table.to_batches():
                    file.write([
                        words_of(each.to_pylist())
                        if pa.types.is_string(each.type)
                        else each.to_numpy(zero_copy_only=False)
                        for each in batch.columns
                    ])
        return path


def _opened(path: Path) -> parquet.ParquetFile:
    """A partition that is there.

    Raises
    ------
    StepNcError
        When it is no Parquet file with the columns of a data set.
    """
    try:
        file = parquet_file(path)
    except pa.ArrowInvalid as error:
        text = f"{path}: is no Parquet file: delete it, and its rows are made again"
        raise StepNcError(text) from error
    if not file.schema_arrow.equals(SCHEMA):
        raise StepNcError(f"{path}: has other columns than a data set: delete it")
    return file


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:59]}…"
