"""Parquet files within budgets: what is refused costs little, what is honest comes whole."""

from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from service.outputs.parquet_pieces import MOST_ROWS, parquet_pieces
from tests.limited import refusals

MIB = 1 << 20


def repeated(text: str, count: int) -> pa.Table:
    """Rows with the same long text, as a dictionary keeps it."""
    words = pa.DictionaryArray.from_arrays(np.zeros(count, dtype=np.int32), [text])
    return pa.table({"time_s": np.arange(count, dtype=np.float64), "workingstep": words})


def attacks(folder: Path) -> dict[str, Path]:
    """Files of some kilobytes, by a word of their refusal."""
    plain = {"use_dictionary": False, "compression": "zstd"}
    tables: dict[str, tuple[pa.Table, dict[str, object]]] = {
        "the texts of 1900 rows": (repeated("a" * MIB, 1900), {}),
        f"at most {MOST_ROWS}": (repeated("a", 0), {}),
        "texts of the file": (repeated("a" * 2000, 900_000), {"compression": "zstd"}),
        "a page unpacks to": (pa.table({"workingstep": ["a" * (40 * MIB)]}), plain),
        "texts take": (pa.table({"workingstep": ["a" * MIB] * 8}), plain),
        "lists": (pa.table({"workingstep": [["a"] * 10_000]}), {}),
        "DELTA_BYTE_ARRAY": (
            pa.table({"workingstep": ["a" * MIB] * 300}),
            {**plain, "column_encoding": "DELTA_BYTE_ARRAY"},
        ),
    }
    found = {}
    for number, (word, (table, options)) in enumerate(tables.items()):
        found[word] = folder / f"{number}.parquet"
        with parquet.ParquetWriter(found[word], table.schema, **options) as writer:
            for _ in range(1 if len(table) else 3):
                writer.write_table(table if len(table) else repeated("a", 600_000))
    return found


def test_small_files_that_stand_for_gigabytes_are_refused_in_little_memory(
    tmp_path: Path,
) -> None:
    files = attacks(tmp_path)
    # Times that ascend are not packed well; the others hold next to nothing.
    sizes = {word: path.stat().st_size for word, path in files.items()}
    for path in (found for word, found in files.items() if word != f"at most {MOST_ROWS}"):
        assert path.stat().st_size < 8 * MIB, sizes
    words = (
        "for piece in batches(path, {'workingstep': pa.string()}): held.append(piece.num_rows)"
    )
    said = refusals(
        words,
        list(files.values()),
        imports="import pyarrow as pa; from service.recording.table import batches; held = []",
        memory=1400,
    )
    wrong = [
        (word, text)
        for word, text in zip(files, said, strict=True)
        if word not in text and "at most" not in word
    ]
    assert not wrong


def test_a_file_with_more_rows_than_its_size_explains_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "rows.parquet"
    table = pa.table({"workingstep": pa.DictionaryArray.from_arrays(
        np.zeros(MOST_ROWS + MIB, dtype=np.int32), ["a"])})  # fmt: skip
    parquet.write_table(table, path)
    (text,) = refusals(
        "list(batches(path, {'workingstep': pa.string()}))",
        [path],
        imports="import pyarrow as pa; from service.recording.table import batches",
        memory=1400,
    )
    assert f"{MOST_ROWS + MIB} rows" in text


def test_an_honest_table_comes_whole_in_the_types_of_the_file(tmp_path: Path) -> None:
    path, count = tmp_path / "honest.parquet", 5000
    words = [None if row % 7 == 0 else f"step {row % 11}" for row in range(count)]
    table = pa.table({
        "time_s": np.arange(count) * 0.01,
        "workingstep": pa.array(words, pa.large_string()),
        "execution": pa.array(words),
        "tool": pa.array(np.arange(count) % 3, pa.int32()),
        "nothing": pa.nulls(count, pa.float64()),
    }).replace_schema_metadata({"made": "here"})
    for options in ({}, {"use_dictionary": False}, {"data_page_version": "2.0"}):
        parquet.write_table(table, path, row_group_size=1500, **options)
        pieces = list(parquet_pieces(path, rows=1000))
        assert [len(piece) for piece in pieces] == [1000, 500] * 3 + [500]
        assert pa.Table.from_batches(pieces).equals(table)
        assert pieces[0].schema.metadata[b"made"] == b"here"
        names = ["tool", "execution"]
        chosen = pa.Table.from_batches(list(parquet_pieces(path, rows=1000, columns=names)))
        assert chosen.equals(table.select(names))


def test_a_table_without_rows_has_no_pieces(tmp_path: Path) -> None:
    path = tmp_path / "empty.parquet"
    parquet.write_table(repeated("a", 0), path)
    assert list(parquet_pieces(path, rows=10)) == []
