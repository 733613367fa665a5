"""Blocks of a file, with any line ends."""

from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.nc.text import text_of
from stepnc_model.post.dialect import Dialect


@given(
    st.one_of(st.binary(max_size=200), st.text("aX1~ \r\n", max_size=60).map(str.encode)),
    st.sampled_from(list(Dialect)),
)
def test_blocks_laid_end_to_end_are_the_file(data: bytes, control: Dialect) -> None:
    text = text_of(data, control)
    assert "".join(text.blocks()).encode("latin-1") == data


def test_every_kind_of_line_end_ends_a_block() -> None:
    text = text_of(b"a\r\nb\rc\n\nd", Dialect.FANUC)
    assert list(text.blocks()) == ["a\r\n", "b\r", "c\n", "\n", "d"]
    assert text.lines.tolist() == [1, 2, 3, 4, 5]


def test_a_tilde_continues_a_block_of_klartext() -> None:
    text = text_of(b"1 CYCL DEF 200 ~\r\n Q200=2 ;X ~\n Q201=-5\n2 L\n", Dialect.HEIDENHAIN)
    assert len(text) == 2
    assert text.line(1) == 4
