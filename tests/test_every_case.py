"""A table of cases is one test, and no case that fails hides another."""

from inspect import signature
from pathlib import Path

import pytest

from tests.every_case import every_case


def test_every_case_that_fails_is_reported() -> None:
    @every_case("number", [1, 2, 3, 4])
    def even(number: int) -> None:
        if number == 3:
            pytest.fail("three")
        assert number % 2 == 0

    with pytest.raises(BaseExceptionGroup, match="2 of 4 cases fail") as caught:
        even()
    notes = [fault.__notes__ for fault in caught.value.exceptions]
    assert notes == [["case 0: 1"], ["case 2: 3"]]


def test_a_single_fault_is_raised_as_it_is() -> None:
    @every_case(("number", "root"), [(4, 2), (9, 2), (16, 4)])
    def square(number: int, root: int) -> None:
        if root**2 != number:
            raise KeyError(number)

    with pytest.raises(KeyError, match="9") as caught:
        square()
    assert caught.value.__notes__ == ["case 1: (9, 2)"]


def test_all_pairs_of_two_tables_are_run() -> None:
    seen = []

    @every_case("letter", "ab")
    @every_case("digit", [1, 2])
    def note(letter: str, digit: int) -> None:
        seen.append(f"{letter}{digit}")

    note()
    assert seen == ["a1", "a2", "b1", "b2"]


@every_case("name", ["x", "y"])
def test_a_case_has_a_folder_an_environment_and_an_output_of_its_own(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").touch()
    monkeypatch.setitem(ENVIRONMENT, name, "set")
    assert list(ENVIRONMENT) == [name]
    print(name)  # noqa: T201 (what is left over is seen by no other case)
    assert capsys.readouterr().out == f"{name}\n"
    print("left over")  # noqa: T201


ENVIRONMENT: dict[str, str] = {}


def test_fixtures_are_asked_for_and_cases_are_not() -> None:
    @every_case("name", ["x"])
    def named(tmp_path: Path, name: str) -> None: ...

    assert list(signature(named).parameters) == ["tmp_path"]


def test_no_cases_and_names_that_the_test_does_not_take_are_mistakes() -> None:
    with pytest.raises(ValueError, match="no cases"):
        every_case("name", [])
    with pytest.raises(TypeError, match="does not take"):
        every_case("nam", ["x"])(lambda name: None)


class TestMethods:
    @every_case("number", [1, 2])
    def test_a_method_is_a_test_too(self, number: int) -> None:
        assert number in {1, 2}
