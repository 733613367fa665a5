"""Formats told apart by their content."""

from contextlib import suppress
from pathlib import Path
from zipfile import ZipFile

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import ToolFormat, read_tools
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

TOML = '# tools\n[[tool]]\nnumber = 7\nkind = "endmill"\ndiameter_mm = 6\n'


@pytest.mark.parametrize("name", ["a.toml", "a.csv", "a", "a.json"])
def test_the_name_of_a_file_does_not_matter(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_text(TOML, encoding="utf-8")
    library = read_tools(file)
    assert library.format is ToolFormat.TOML
    assert [tool.number for tool in library.tools] == [7]


def test_tools_are_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    lines = ["number,kind,diameter_mm", "9,drill,3", "2,drill,4"]
    file.write_text("\n".join(lines), encoding="utf-8")
    library = read_tools(file)
    assert [each.number for each in library.tools] == [2, 9]
    assert list(library.by_number) == [2, 9]


@every_case(
    ("content", "told"),
    [
        (b"", "is none of the known formats: TOML, CSV, LinuxCNC tool table, Fusion"),
        (b"G0 X0\n", "is none of the known formats"),
        (b"\xff\x00\xff", "is not utf-8-sig text"),
        (b'{"a": 1}', "is a JSON document with neither 'data' (Fusion)"),
        (b"PK\x03\x04nothing", "is a damaged archive"),
        (b"[[tool]]\nnumber = 1\n", "tool[1].kind: missing"),
    ],
)
def test_another_content_is_refused(tmp_path: Path, content: bytes, told: str) -> None:
    file = tmp_path / "tools"
    file.write_bytes(content)
    assert refusal(file).startswith(told)


def test_a_toml_table_is_refused_where_its_name_tells_another_unit(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(TOML + 'id = "6 inch mill"\n', encoding="utf-8")
    assert (
        refusal(file) == "tool[1].diameter_mm: 6 mm, but its name '6 inch mill' says 152.4 mm"
    )


def test_an_archive_without_the_document_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.tools"
    with ZipFile(file, "w") as archive:
        archive.writestr("other.json", "{}")
    assert refusal(file) == "the archive has no tools.json"


def test_an_archive_that_unpacks_too_far_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.tools"
    with ZipFile(file, "w", compression=8) as archive:
        archive.writestr("tools.json", b" " * ((1 << 25) + 1))
    assert "unpacks to more than 33554432 bytes" in refusal(file)


def test_a_unit_is_only_for_tables_that_name_none(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(TOML, encoding="utf-8")
    assert refusal(file, FileUnit.INCH) == "a TOML names its own units; omit the unit inch"


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    assert refusal(tmp_path / "b") == "cannot be read: No such file or directory"


@settings(max_examples=60)
@given(
    start=st.sampled_from([b"", b"{", b'{"data": [', b"<", b"T1 P1 ", b"number,kind\n", b"PK"]),
    rest=st.binary(max_size=60),
)
def test_any_content_is_read_or_refused_by_the_tree(
    tmp_path_factory: pytest.TempPathFactory, start: bytes, rest: bytes
) -> None:
    file = tmp_path_factory.getbasetemp() / "any"
    file.write_bytes(start + rest)
    with suppress(LibraryError):
        read_tools(file)
