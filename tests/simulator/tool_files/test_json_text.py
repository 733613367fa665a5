"""JSON documents."""

from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.tool_files.json_text import list_in, object_in, parsed_json, shown
from tests.every_case import every_case

FILE = Path("a.json")


@every_case(
    ("text", "told"),
    [
        ('{"a":\n 1,}', "a.json: line 2: is not JSON: "),
        ("[1]", "a.json: is not a JSON object"),
        ('{"a": NaN}', "a.json: NaN is not a number of JSON"),
        ("[" * 100_000, "a.json: is not JSON that can be read"),
        ('{"a": ' + "1" * 5000 + "}", "a.json: is not JSON that can be read"),
    ],
)
def test_a_document_that_cannot_be_read_is_refused(text: str, told: str) -> None:
    with pytest.raises(LibraryError) as refused:
        parsed_json(text, FILE)
    assert str(refused.value).startswith(told)


def test_what_is_absent_is_empty() -> None:
    assert object_in({}, "a", FILE, place="x") == {}
    assert list_in({"a": None}, "a", FILE, place="x") == []


def test_another_value_is_refused_with_its_path() -> None:
    with pytest.raises(LibraryError, match=r"x\[0\].a: 3 is not an object"):
        object_in({"a": 3}, "a", FILE, place="x[0]")
    with pytest.raises(LibraryError, match=r"json: a: \{'b': 1\} is not a list"):
        list_in({"a": {"b": 1}}, "a", FILE, place="")


def test_long_values_are_cut() -> None:
    assert len(shown("x" * 1000)) == 60
