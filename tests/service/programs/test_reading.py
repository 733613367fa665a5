"""Files become programs, words become choices, and everything else is refused by name."""

from enum import StrEnum
from pathlib import Path

import pytest

from service.programs.reading import one_of, read_program, unit_profile
from service.progress import silent
from stepnc_model.errors import StepNcError

PARTS = Path(__file__).parents[3] / "examples" / "parts"


class Fruit(StrEnum):
    APPLE = "apple"
    PEAR = "pear"


def test_a_program_is_read_in_the_units_named() -> None:
    program = read_program(PARTS / "paper002.stpnc", units="iso")
    assert program.name == "paper002.stpnc"
    assert program.units.name == "iso"


def test_a_file_that_is_not_there_is_named() -> None:
    with pytest.raises(StepNcError, match=r"nowhere\.stpnc"):
        read_program(Path("nowhere.stpnc"), units="iso")


def test_unknown_units_are_answered_with_the_known_ones() -> None:
    with pytest.raises(StepNcError, match="unknown units 'inch'; known: iso, rpm-mmin"):
        unit_profile("inch")


def test_a_word_becomes_the_member_of_its_value() -> None:
    assert one_of(Fruit, "pear", "fruit") is Fruit.PEAR


def test_an_unknown_word_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StepNcError, match="unknown fruit 'plum'; known: apple, pear"):
        one_of(Fruit, "plum", "fruit")


def test_silence_takes_any_message() -> None:
    silent("nobody hears this")
