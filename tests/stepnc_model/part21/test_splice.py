"""Splices on bytes."""

from stepnc_model.part21.writer import Element, line_span, line_start, list_splices, spliced
from tests.every_case import every_case

LIST = b"(a , bb /* , */, c )"
SPANS = [(1, 2), (5, 7), (17, 18)]


@every_case(
    ("elements", "expected"),
    [
        (SPANS, LIST),
        ([b"a", b"bb", b"c"], LIST),
        ([b"x", *SPANS[1:]], b"(x , bb /* , */, c )"),
        ([*SPANS, b"d", b"e"], b"(a , bb /* , */, c, d, e )"),
        (SPANS[:2], b"(a , bb /* , */ )"),
        (SPANS[:1], b"(a  )"),
        ([], b"( )"),
        (SPANS[1:], b"(bb , c /* , */ )"),
    ],
)
def test_list_becomes_what_is_asked(elements: list[Element], expected: bytes) -> None:
    splices = list_splices(LIST, elements, spans=SPANS, close=19)
    assert spliced(LIST, splices, start=0, end=len(LIST)) == expected


def test_empty_list_gets_its_first_elements() -> None:
    splices = list_splices(b"()", [b"a", b"b"], spans=[], close=1)
    assert spliced(b"()", splices, start=0, end=2) == b"(a, b)"


@every_case(
    ("data", "span"),
    [
        (b"\n  X \nb", (1, 6)),
        (b"X\r\nb", (0, 3)),
        (b"X\rb", (0, 2)),
        (b"a\nX c\n", (2, 3)),
        (b"a X\n", (2, 3)),
        (b"a\nX", (2, 3)),
    ],
)
def test_line_goes_only_if_nothing_else_stands_there(
    data: bytes, span: tuple[int, int]
) -> None:
    start = data.index(b"X")
    assert line_span(data, (start, start + 1)) == span


def test_line_start_is_the_offset_where_text_stands_before() -> None:
    assert line_start(b"a\n \tX", 4) == 2
    assert line_start(b"a X", 2) == 2
    assert line_start(b"  X", 2) == 0
