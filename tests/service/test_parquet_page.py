"""Headers of Parquet pages: as the writer made them, and damaged ones."""

import mmap
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import parquet

from service.outputs.parquet_pieces import ParquetPage, pages
from tests.every_case import every_case


def read(path: Path) -> list[ParquetPage]:
    """Pages of the only column."""
    chunk = parquet.read_metadata(path).row_group(0).column(0)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as whole:
        return list(pages(whole, chunk))


@every_case("version", ["1.0", "2.0"])
def test_all_values_stand_in_pages_behind_their_dictionary(
    tmp_path: Path, version: str
) -> None:
    path, count = tmp_path / "a.parquet", 30_000
    table = pa.table({"word": [f"step {row % 7}" for row in range(count)]})
    parquet.write_table(table, path, data_page_version=version, data_page_size=1000)
    dictionary, *others = read(path)
    assert dictionary.is_dictionary
    assert (dictionary.count, dictionary.size) == (7, 7 * (4 + len("step 0")))
    assert len(others) > 1
    assert sum(page.count for page in others) == count
    assert {page.encoding for page in others} <= {2, 8}


def test_a_damaged_header_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    parquet.write_table(pa.table({"word": ["a", "b"]}), path)
    content = path.read_bytes()
    for fill in (b"\xff", b"\x00", b"\x1c", b"\x19"):
        path.write_bytes(content[:4] + fill * 20 + content[24:])
        with pytest.raises(ValueError, match="the header of a page"):
            read(path)
