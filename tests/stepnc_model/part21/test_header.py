"""The header, whatever its statements hold."""

from stepnc_model.part21.reader import HeaderReading, read_header
from stepnc_model.part21.structure import Statement


def reading(*texts: str) -> HeaderReading:
    """Header of statements that stand one behind the other."""
    data, statements = b"", []
    for text in texts:
        start, keyword = len(data), text.partition("(")[0]
        data += text.encode()
        bracket = start + len(keyword)
        statements.append(
            Statement(keyword=keyword, start=start, bracket=bracket, end=len(data))
        )
    return read_header(data, tuple(statements))


def test_missing_statements_are_noted_and_empty() -> None:
    result = reading()
    assert result.schemas == ()
    assert [slip.message for slip in result.slips] == [
        "FILE_DESCRIPTION is missing",
        "FILE_NAME is missing",
        "FILE_SCHEMA is missing",
    ]


def test_first_of_two_statements_counts() -> None:
    result = reading("FILE_SCHEMA(('A'))", "FILE_SCHEMA(('B'))")
    assert result.schemas == ("A",)
    assert "given twice" in result.slips[0].message


def test_blank_schema_names_are_dropped() -> None:
    assert reading("FILE_SCHEMA(('A','',' ','B'))").schemas == ("A", "B")


def test_statement_that_cannot_be_read_is_noted_at_its_place() -> None:
    result = reading("FILE_SCHEMA(('A' 'B'))", "SCHEMA_POPULATION(())")
    assert result.schemas == ()
    assert result.slips[0].offset == 17
