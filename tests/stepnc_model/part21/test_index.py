"""Columns of instances, and what stands between them."""

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.index import IndexBuilder, skip_junk
from stepnc_model.part21.places import SyntaxSlip


def test_columns_follow_the_order_of_the_file() -> None:
    data = b" #5=A(1);\n#2 = b ( ';' ) ;/* c */#9=(A()B());ENDSEC;"
    slips: list[SyntaxSlip] = []
    builder = IndexBuilder(data, slips)
    assert data[builder.add_section(0) :] == b"ENDSEC;"
    index = builder.finish()
    assert list(index.ids) == [5, 2, 9]
    assert [index.keywords[code] for code in index.codes] == ["A", "B", ""]
    spans = zip(index.starts, index.ends, strict=True)
    assert [data[a:b] for a, b in spans] == [b"#5=A(1);", b"#2 = b ( ';' ) ;", b"#9=(A()B());"]
    assert index.positions == {5: 0, 2: 1, 9: 2}
    assert slips == []


def test_every_byte_is_an_instance_blank_or_noted() -> None:
    data = b'#1=A()x#2=B()\n??\n#3=C();; #4 E #5=D("12");'
    slips: list[SyntaxSlip] = []
    builder = IndexBuilder(data, slips)
    assert builder.add_section(0) == len(data)
    assert list(builder.finish().ids) == [1, 2, 3, 5]
    assert [slip.message.rpartition(": ")[2] for slip in slips] == [
        "';' is missing after #1",
        "'x'",
        "';' is missing after #2",
        "'??'",
        "'; #4 E'",
    ]


@pytest.mark.parametrize("word", [b"ENDSEC;", b"endsec", b"END-ISO-10303-21;", b"DATA;"])
def test_section_ends_before_the_word_that_ends_it(word: bytes) -> None:
    data = b"#1=A(); " + word
    assert IndexBuilder(data, []).add_section(0) == 8


def test_words_that_begin_like_the_end_do_not_end_a_section() -> None:
    data = b"#1=ENDSECTION('ENDSEC;',.END.);junk ENDING DATABASE #2=DATA(1);"
    builder = IndexBuilder(data, [])
    assert builder.add_section(0) == len(data)
    assert list(builder.finish().ids) == [1, 2]


def test_id_given_twice_is_refused() -> None:
    builder = IndexBuilder(b"#1=A();\n#01=B();", [])
    builder.add_section(0)
    with pytest.raises(Part21Error, match="line 2, column 1: #1 is defined twice"):
        builder.finish()


def test_junk_always_moves_on() -> None:
    slips: list[SyntaxSlip] = []
    assert skip_junk(b"#1=A();", 0, slips=slips) == 1
    assert len(slips) == 1
