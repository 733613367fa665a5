"""Compressed files: recognised by their first bytes, bounded, and refused when damaged."""

import gzip
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import Part21Error
from stepnc_model.part21 import compression as module
from stepnc_model.part21.compression import unpacked
from stepnc_model.part21.reader import Part21File
from tests.every_case import every_case

PLAIN = (
    b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=DIRECTION('',(0.,0.,1.));\nENDSEC;\n"
    b"END-ISO-10303-21;\n"
)


def zipped(members: dict[str, bytes]) -> bytes:
    """Archive with some files."""
    out = BytesIO()
    with ZipFile(out, "w", ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return out.getvalue()


class TestPacked:
    @every_case(
        "data",
        [
            PLAIN,
            gzip.compress(PLAIN, mtime=0),
            gzip.compress(PLAIN[:40], mtime=0) + gzip.compress(PLAIN[40:], mtime=0),
            zipped({"part.stpnc": PLAIN}),
            zipped({"README.txt": b"a program", "deep/part.stp": PLAIN}),
            zipped({"a.stp": PLAIN, "ISO-10303.p21": PLAIN}),
        ],
    )
    def test_the_bytes_of_the_program_come_out(self, data: bytes) -> None:
        assert unpacked(data) == PLAIN
        assert list(Part21File.from_bytes(data).ids()) == [1]


class TestRefused:
    @every_case(
        ("data", "message"),
        [
            (zipped({"a.stp": PLAIN, "b.stp": PLAIN}), "holds 2 Part 21 files instead of one"),
            (zipped({"a.txt": b"nothing"}), "holds no Part 21 files instead of one"),
            (zipped({}), "holds no Part 21 files"),
            (gzip.compress(PLAIN, mtime=0)[:-12], "breaks off"),
            (gzip.compress(PLAIN, mtime=0)[:10] + b"xxxxxxxxxx", "damaged"),
            (zipped({"a.stp": PLAIN})[:-30], "cannot be read"),
            (b"PK\x03\x04 and no more", "cannot be read"),
        ],
    )
    def test_an_archive_without_one_whole_program_is_an_error(
        self, data: bytes, message: str
    ) -> None:
        with pytest.raises(Part21Error, match=message):
            Part21File.from_bytes(data)

    @pytest.mark.parametrize("pack", [gzip.compress, lambda data: zipped({"a.stp": data})])
    def test_what_would_grow_too_long_is_refused(
        self, pack: "object", monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(module, "MAX_UNPACKED", 1 << 20)
        assert callable(pack)
        packed = pack(PLAIN + b" " * (1 << 24))
        assert len(packed) < 1 << 16
        with pytest.raises(Part21Error, match="unpacks to more than 1 MB"):
            unpacked(packed)

    @given(
        st.sampled_from([gzip.compress(PLAIN, mtime=0), zipped({"a.stp": PLAIN})]), st.data()
    )
    def test_a_damaged_archive_gives_an_error_or_the_program(
        self, data: bytes, draw: st.DataObject
    ) -> None:
        place = draw.draw(st.integers(4, len(data) - 1))
        byte = draw.draw(st.integers(0, 255))
        damaged = data[:place] + bytes([byte]) + data[place + 1 :]
        try:
            Part21File.from_bytes(damaged)
        except Part21Error as error:
            assert str(error)  # noqa: PT017 (either outcome is right)
