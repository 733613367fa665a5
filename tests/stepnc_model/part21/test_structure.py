"""Sections and header statements by their offsets."""

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.structure import read_structure
from tests.every_case import every_case

OPEN = b"ISO-10303-21;HEADER;"
DATA = b"ENDSEC;DATA;#1=A();ENDSEC;"
CLOSE = b"END-ISO-10303-21;"


def messages(data: bytes) -> list[str]:
    return [slip.message for slip in read_structure(data).slips]


def test_statements_are_found_with_their_brackets() -> None:
    data = OPEN + b"FILE_SCHEMA /* ( */ (('A;B'));X(1);" + DATA + CLOSE
    structure = read_structure(data)
    assert [s.keyword for s in structure.statements] == ["FILE_SCHEMA", "X"]
    first = structure.statements[0]
    assert data[first.bracket : first.end] == b"(('A;B'))"
    assert data[structure.data_end :] == b"ENDSEC;" + CLOSE
    assert structure.slips == ()


@every_case(
    ("data", "message"),
    [
        (OPEN.replace(b";", b" ", 1) + DATA + CLOSE, "';' is missing after ISO-10303-21"),
        (OPEN + b"X(1)" + DATA + CLOSE, "';' is missing after X"),
        (OPEN + b"X(1;" + DATA + CLOSE, "the brackets of X do not close"),
        (OPEN + DATA + b"ENDSEC;" + CLOSE, "ENDSEC without an open section"),
        (OPEN + DATA + CLOSE + b" more", "text after the end of the file is ignored: 'more'"),
        (OPEN + DATA + CLOSE[:-1], "';' is missing after END-ISO-10303-21"),
        (OPEN + DATA.replace(b"DATA", b"DATA('x'"), "the parameters of DATA do not end"),
        (OPEN + DATA.replace(b"DATA", b"DATA('x') "), None),
        (OPEN + DATA + b"X(1);" + CLOSE, "X outside the HEADER section"),
        (OPEN + DATA.replace(b";DATA", b";") + CLOSE, "text outside any instance: ';'"),
        (OPEN + DATA[:-7] + b"DATA;#2=B();ENDSEC;" + CLOSE, "ENDSEC is missing after the DATA"),
    ],
)
def test_slip_of_the_frame_is_noted(data: bytes, message: str | None) -> None:
    found = messages(data)
    assert message is None or any(text.startswith(message) for text in found)
    assert 1 in read_structure(data).index.positions


def test_comments_may_stand_within_the_words_of_the_frame() -> None:
    data = OPEN + DATA.replace(b";", b"/* ; */;") + CLOSE.replace(b";", b" /* c */ ;")
    assert messages(data) == []


def test_empty_data_section_is_a_file() -> None:
    assert len(read_structure(OPEN + b"ENDSEC;DATA;ENDSEC;" + CLOSE).index.ids) == 0


def test_comment_without_end_behind_the_data_is_an_error() -> None:
    with pytest.raises(Part21Error, match="does not end"):
        read_structure(OPEN + DATA + b"/* ")
