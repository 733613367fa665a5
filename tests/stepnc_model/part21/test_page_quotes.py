r"""Apostrophes that ``\S\`` takes: whole valid files are read, and stay as they are."""

from stepnc_model.part21.reader import Part21File, masked
from stepnc_model.part21.writer import Edits
from tests.every_case import every_case

HEAD = b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"
TAIL = b"\nENDSEC;\nEND-ISO-10303-21;\n"


def file_of(text: bytes) -> Part21File:
    return Part21File.from_bytes(HEAD + text + TAIL)


@every_case(
    ("text", "values"),
    [
        (rb"#1=A('abc\S\'def',2);", ("abc§def", 2)),
        (rb"#1=A('\S\'');", ("§",)),
        (rb"#1=A('\S\'''',2);", ("§'", 2)),
        (rb"#1=A('a\S\''b',2);", ("a§b", 2)),
        (rb"#1=A('\S\',',2);", ("§,", 2)),
        (rb"#1=A('C:\S\',2,'x');", ("C:\\S\\", 2, "x")),
        (rb"#1=A('C:\\S\\',2,'x');", ("C:\\S\\", 2, "x")),
        (rb"#1=A(/* it's */'\S\'7;#9=B(',2);", ("§7;#9=B(", 2)),
        (rb"#1=(A('\S\'')B('it''s'));", None),
    ],
)
def test_the_apostrophe_of_a_directive_ends_no_string(
    text: bytes, values: tuple[object, ...] | None
) -> None:
    file = file_of(text + rb"#2=B('\S\'',#1);")
    assert list(file.ids()) == [1, 2]
    assert file.parameters(2) == ("§", 1)
    if values is None:
        assert [part[1] for part in file.parts(1)] == [("§",), ("it's",)]
    else:
        assert file.parameters(1) == values


def test_bytes_stay_when_another_parameter_changes() -> None:
    file = file_of(rb"#1=A('abc\S\'def',2,'\S\'');")
    writer = Edits(file)
    writer.replace_parameter(1, 1, 3)
    assert rb"#1=A('abc\S\'def',3,'\S\'');" in writer.apply()
    assert Edits(file).apply() == file.data


def test_strings_without_end_take_time_in_proportion() -> None:
    for piece in (rb"'\S\'", rb"'\S\',", rb"'\S\'x", rb"/*'\S\'"):
        data = piece * 100_000
        assert len(masked(data)) == len(data)
