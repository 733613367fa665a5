"""Files with faults: what can be read is read, and what cannot is told with its place."""

import pytest

from stepnc_model.errors import Part21Error, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from tests.every_case import every_case
from tests.stepnc_model.part21.test_reader import (
    END,
    HEADER,
    file_of,
    messages,
)


def test_missing_semicolon_loses_no_instance() -> None:
    file = file_of("#1=A(1)", "#2=B(2) /* c */", "#3=C((3)")
    assert list(file.ids()) == [1, 2, 3]
    assert file.parameters(2) == (2,)
    assert [f.message for f in file.findings if f.severity is Severity.WARNING] == [
        "';' is missing after #1",
        "';' is missing after #2",
        "';' is missing after #3",
    ]


def test_junk_between_instances_is_a_finding_with_its_line() -> None:
    file = file_of("#1=A();", "it's ## junk; (", "#2=B();")
    assert list(file.ids()) == [1, 2]
    (finding,) = file.findings
    assert finding.line == 9
    assert "it's ## junk; (" in finding.message


def test_comment_that_swallows_instances_says_so() -> None:
    file = file_of("#1=A(); /* lost end", "#2=B();", "#3=C(); /* c */", "#4=D();")
    assert list(file.ids()) == [1, 4]
    assert messages(file) == ["nested comment: '/*' within a comment; it hides 2 instances"]


@every_case(
    ("text", "value", "slips"),
    [
        ("1E5", 1e5, 1),
        ("1.5e-3", 1.5e-3, 1),
        (".5", 0.5, 1),
        ("word", "WORD", 1),
        ("..F.", "F", 1),
        ('"WIDE"', "WIDE", 1),
        ("((((((1))))))", ((((((1,),),),),),), 0),
    ],
)
def test_slip_in_a_value_is_read_and_reported(text: str, value: object, slips: int) -> None:
    file = file_of(f"#1=A({text});")
    assert file.parameters(1) == (value,)
    assert len(file.findings) == slips


@every_case(
    "text",
    [
        "1,,2",
        "1,",
        ",1",
        "1 2",
        "nan",
        "INF",
        "-nan",
        "1=2",
        "(1",
        "1)",
        "@",
        "X(1,2)",
        "X()",
        "\x00",
        "1.5abc",
        "1" * 5000,
        "#" + "1" * 30,
        "(" * 600 + ")" * 600,
        '"',
        "A(1)B(2)",
    ],
)
def test_malformed_parameters_are_an_error_of_that_instance_only(text: str) -> None:
    file = file_of("#1=FIRST(1);", f"#2=X({text});", "#3=LAST(3);")
    assert file.parameters(1) == (1,)
    assert file.parameters(3) == (3,)
    with pytest.raises(Part21Error, match="#2 X") as caught:
        file.parameters(2)
    assert caught.value.line == 9
    (error,) = [f for f in file.findings if f.severity is Severity.ERROR]
    assert error.entity == "#2 X"
    assert error.line == 9


def test_error_names_line_and_column() -> None:
    with pytest.raises(Part21Error) as caught:
        file_of("#1=A(1,\n  2 3);").parameters(1)
    assert (caught.value.line, caught.value.column) == (9, 5)


@every_case(
    ("data", "place", "word"),
    [
        (b"", (1, 1), "empty"),
        (b" \r\n\t", (1, 1), "empty"),
        (b"\xef\xbb\xbf \n", (1, 1), "empty"),
        (b"G0 X1", (1, 1), "not an ISO"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", (1, 1), "not an ISO"),
        (HEADER.encode("utf-16"), (1, 1), "not an ISO"),
        (HEADER.encode(), (7, 1), "no DATA"),
        (b"ISO-10303-21;", (1, 14), "no DATA"),
        (b"ISO-10303-21; /* x", (1, 15), "comment"),
        ((HEADER + "DATA;\n#1=A();\n#2=PLANE('x',#").encode(), (9, 1), "cut off"),
        ((HEADER + "DATA;\n#1=A('x;\nENDSEC;\n").encode(), (8, 6), "string"),
        ((HEADER + "DATA;\n#1=A(/* x);\nENDSEC;\n").encode(), (8, 6), "comment"),
        ((HEADER + "DATA;\n#1=A('x);\n#2=B('y');\n" + END).encode(), (9, 8), "string"),
        ((HEADER + "DATA;\n#1=A();\n#2=B();\n#1=C();\n").encode(), (10, 1), "twice"),
        ((HEADER + "DATA;\n#" + "9" * 30 + "=A();\n").encode(), (8, 1), "30 digits"),
    ],
)
def test_refusal_is_told_at_its_place(data: bytes, place: tuple[int, int], word: str) -> None:
    with pytest.raises(Part21Error, match=word) as caught:
        Part21File.from_bytes(data)
    assert (caught.value.line, caught.value.column) == place


def test_a_name_without_an_instance_is_a_finding() -> None:
    assert Part21File.from_bytes((HEADER + "DATA;\n#1=A();\n#2").encode()).findings


def test_refusal_of_another_file_says_what_was_expected_and_found() -> None:
    with pytest.raises(Part21Error) as caught:
        Part21File.from_bytes(b"G0 X1")
    assert str(caught.value) == (
        "line 1, column 1: not an ISO 10303-21 file: 'ISO-10303-21;' expected, 'G0 X1' found"
    )


def test_duplicate_id_names_both_lines() -> None:
    with pytest.raises(Part21Error, match=r"^line 10, .*first on line 8"):
        file_of("#5=A();", "#6=B();", "#5=A();")


def test_absent_instance_is_named() -> None:
    with pytest.raises(SchemaError) as refused:
        file_of("#1=A();").parameters(2)
    assert refused.value.entity == "#2"


@every_case("unit", ["'", '"', "/*", "*/", "(", "#1=", ";", "DATA;", "ENDSEC;", "A("])
@every_case("opening", ["", "#9=A("])
def test_repeated_marks_are_answered_in_linear_time(unit: str, opening: str) -> None:
    data = (HEADER + "DATA;\n" + opening + unit * (200_000 // len(unit))).encode()
    try:
        file = Part21File.from_bytes(data)
    except Part21Error:
        return
    assert len(file) <= 1
    assert file.findings


def test_millions_of_brackets_are_refused_without_recursion() -> None:
    brackets = b"(" * 5_000_000
    with pytest.raises(Part21Error, match="not an ISO"):
        Part21File.from_bytes(brackets)
    with pytest.raises(Part21Error, match="cut off within #1 A"):
        Part21File.from_bytes(HEADER.encode() + b"DATA;#1=A" + brackets)
    with pytest.raises(Part21Error, match="#1 is 5000005 bytes long; at most 2097152"):
        Part21File.from_bytes(HEADER.encode() + b"DATA;#1=A" + brackets + b";" + END.encode())
    file = Part21File.from_bytes(
        HEADER.encode() + b"DATA;#1=A" + brackets[:1_000_000] + b";" + END.encode()
    )
    with pytest.raises(Part21Error, match="nested deeper than 500"):
        file.parameters(1)
