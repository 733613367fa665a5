"""Archives whose directory lies about sizes, and methods that cannot be bounded."""

import struct
import zlib
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from zipfile import ZIP_BZIP2, BadZipFile, ZipFile

import pytest

from stepnc_model.zip_member import read_member, require_sizes
from tests.limited import refusals

MIB = 1 << 20


def zeros(mib: int) -> bytes:
    """Raw deflate stream of zeros, quickly made: equal blocks one after the other."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    block = packer.compress(bytes(MIB)) + packer.flush(zlib.Z_FULL_FLUSH)
    return block * mib + zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS).flush()


def lying(name: str, packed: bytes, *, size: int) -> bytes:
    """Archive whose directory states another size, with the checksum that fits it."""
    raw, check = name.encode(), zlib.crc32(bytes(size))
    numbers = struct.pack("<HHHHHIIIHH", 20, 0, 8, 0, 33, check, len(packed), size, len(raw), 0)
    local = b"PK\x03\x04" + numbers + raw
    entry = b"PK\x01\x02" + struct.pack("<H", 20) + numbers + bytes(14) + raw
    end = struct.pack("<HHHHIIH", 0, 0, 1, 1, len(entry), len(local) + len(packed), 0)
    return local + packed + entry + b"PK\x05\x06" + end


def test_a_member_that_is_longer_than_stated_is_refused_in_little_memory(
    tmp_path: Path,
) -> None:
    names = ("part.stp", "tools.json", "heights.npy")
    packed = zeros(1000)
    for name in (*names, "stepnc.json"):
        (tmp_path / name).write_bytes(lying(name, packed, size=100))
    readers = """
from simulator.removal.stock_file import kept_stock
from simulator.tool_files.read import read_tools
from stepnc_model.part21.reader import Part21File
read = {
    "part.stp": lambda path: Part21File.from_bytes(path.read_bytes()),
    "tools.json": read_tools,
    "heights.npy": lambda path: kept_stock(path.read_bytes(), str(path)),
}
"""
    said = refusals(
        "read[path.name](path)",
        [tmp_path / name for name in names],
        imports=readers,
        memory=900,
    )
    said += refusals(
        "load_model(path)",
        [tmp_path / "stepnc.json"],
        imports="from extras.learning.model_file import load_model",
        memory=2000,
    )
    assert len(said) == len(names) + 1
    assert not [text for text in said if "accepted" in text]


def test_what_a_directory_states_is_what_comes_out() -> None:
    content = BytesIO()
    with ZipFile(content, "w", 8) as archive:
        archive.writestr("a", b"text" * 100_000)
        archive.writestr("b", b"")
    with ZipFile(content) as archive:
        one, other = archive.infolist()
        assert read_member(archive, one, most=400_000) == b"text" * 100_000
        assert read_member(archive, other, most=0) == b""
        require_sizes(archive, most=400_000)
        refused: tuple[tuple[str, Callable[[], object]], ...] = (
            ("more than 399999", lambda: read_member(archive, one, most=399_999)),
            ("more than", lambda: require_sizes(archive, most=399_999)),
        )
        for word, read in refused:
            with pytest.raises(BadZipFile, match=word):
                read()


def test_a_method_without_a_bound_is_refused() -> None:
    content = BytesIO()
    with ZipFile(content, "w", ZIP_BZIP2) as archive:
        archive.writestr("a", b"text")
    with ZipFile(content) as archive, pytest.raises(BadZipFile, match="neither stored"):
        read_member(archive, archive.infolist()[0], most=100)
