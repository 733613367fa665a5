"""Enumerations carry the words of the standard."""

from enum import StrEnum

from stepnc_model.entities import enums
from tests.every_case import every_case

ENUMERATIONS = [
    each
    for each in vars(enums).values()
    if isinstance(each, type) and issubclass(each, StrEnum) and each is not StrEnum
]


@every_case("enumeration", ENUMERATIONS)
def test_value_is_the_name_in_capitals(enumeration: type[StrEnum]) -> None:
    if enumeration is not enums.Logical:
        assert [each.value for each in enumeration] == list(enumeration.__members__)


def test_logical_values_are_letters() -> None:
    assert [each.value for each in enums.Logical] == ["T", "F", "U"]
