"""The tolerant parser: places of values and of errors."""

from stepnc_model.part21.index import parse_record
from stepnc_model.part21.values import Enumeration, Ref, Typed
from tests.every_case import every_case


def test_spans_leave_out_blanks_and_comments() -> None:
    text = " A ( 1 /* x */ , (2,\n3) , L_M ( 0.5 ) , 'a;b' ) ;"
    record = parse_record(text)
    spans = [text[a:b] for a, b in record.spans]
    assert spans == ["1", "(2,\n3)", "L_M ( 0.5 )", "'a;b'"]
    assert text[record.end] == ")"
    assert record.error is None


def test_complex_instance_has_parts_and_no_spans() -> None:
    record = parse_record("(A(1,(2))B()C_D(#3,X('y')));")
    assert record.is_complex
    assert record.spans == ()
    assert record.parts == (("A", (1, (2,))), ("B", ()), ("C_D", (Ref(3), Typed("X", "y"))))


def test_print_control_between_tokens_is_blank() -> None:
    assert parse_record(r"A(1,\N\2);").parts == (("A", (1, 2)),)


def test_slips_do_not_stop_the_parser() -> None:
    record = parse_record('A(RIGHT,..F.,"X",1E5);')
    assert record.parts[0][1] == (Enumeration("RIGHT"), Enumeration("F"), "X", 1e5)
    assert [slip.offset for slip in record.slips] == [2, 8, 13, 17]


@every_case(
    ("text", "offset", "message"),
    [
        ("", 0, "ends before"),
        (";", 0, "before the brackets"),
        ("A;", 0, "entity was expected"),
        ("A(1;", 3, "before the brackets"),
        ("A(1 2);", 4, "',' is missing"),
        ("A(1 (2));", 4, "',' is missing"),
        ("A(1 X(2));", 4, "',' is missing"),
        ("A(1,);", 4, "before ')'"),
        ("A(,1);", 2, "before ','"),
        ("A(1));", 4, "after the closing"),
        ("A();;", 4, "after the closing"),
        (")", 0, "without an open"),
        ("(A(),B());", 4, "before ','"),
        ("((1));", 1, "entity name"),
        ("(1);", 1, "entity was expected"),
        ("A(X(1,2));", 7, "one value"),
        ("A('x", 2, "not end"),
        ("A(1.2.3);", 5, "',' is missing"),
    ],
)
def test_error_is_told_at_its_place(text: str, offset: int, message: str) -> None:
    error = parse_record(text).error
    assert error is not None
    assert message in error.message
    assert error.offset == offset


def test_an_error_says_what_is_missing_and_before_what() -> None:
    error = parse_record("A(1,);").error
    assert error is not None
    assert error.message == "a value is missing before ')'"
