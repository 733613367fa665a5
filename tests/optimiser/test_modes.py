"""The words by which the user chooses."""

import pytest

from optimiser.modes import Free, Mode


@pytest.mark.parametrize("name", ["TC", "QC", "EC", "CC"])
def test_mode_is_read_from_its_name(name: str) -> None:
    assert Mode(name) == name


def test_there_are_four_modes_and_three_freedoms() -> None:
    assert {mode.value for mode in Mode} == {"TC", "QC", "EC", "CC"}
    assert {free.value for free in Free} == {"feed", "depth", "speed"}


def test_unknown_mode_is_refused() -> None:
    with pytest.raises(ValueError, match="XX"):
        Mode("XX")
