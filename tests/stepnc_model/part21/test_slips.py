"""Deviations are noted within bounds."""

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.places import (
    MOST_OF_FILE,
    MOST_OF_INSTANCE,
    FileSlips,
    InstanceSlips,
    SyntaxSlip,
)


def test_one_deviation_more_than_the_most_of_a_file_is_an_error_at_its_place() -> None:
    slips = FileSlips(b"\n\nab")
    for _ in range(MOST_OF_FILE):
        slips.append(SyntaxSlip(offset=0, message="odd"))
    with pytest.raises(Part21Error, match=r"line 3, column 2: .*the last one: too odd"):
        slips.append(SyntaxSlip(offset=3, message="too odd"))
    assert len(slips.noted) == MOST_OF_FILE


def test_of_an_instance_the_first_are_kept_and_all_counted() -> None:
    slips = InstanceSlips()
    for offset in range(MOST_OF_INSTANCE + 5):
        slips.append(SyntaxSlip(offset=offset, message="odd"))
    assert [slip.offset for slip in slips.noted] == list(range(MOST_OF_INSTANCE))
    assert slips.count == MOST_OF_INSTANCE + 5
