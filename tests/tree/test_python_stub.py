"""The types that editors see are those of the declarations."""

from tests.tree.python_stub import STUB, stub


def test_the_stub_is_that_of_the_declarations() -> None:
    text = STUB.read_text(encoding="utf-8")
    assert text == stub(), "run `python -m tests.tree.python_stub`"
