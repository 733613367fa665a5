"""Blocks, tools and stock from a program."""

from itertools import islice
from pathlib import Path

import pytest

from service.inputs.numbers import numbers_in
from service.progress import silent
from service.requests.runs import RunRequest
from service.simulation.setup import CountedIterator, PreparedRun, from_program
from simulator.removal.engage import MillingStock
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

EXAMPLES = Path(__file__).parents[3] / "examples"
BRACKET = EXAMPLES / "parts" / "bracket.stpnc"


def test_numbers_are_read_in_order() -> None:
    assert numbers_in("-3, 1e2,.5", "zero", counts=(3,)) == (-3.0, 100.0, 0.5)
    assert numbers_in("7", "stock", counts=(1, 2)) == (7.0,)


@every_case("text", ["", "x", "1,", "1,2,nan", "1,2,inf", "1,2", "1 2 3"])
def test_what_are_no_numbers_is_refused(text: str) -> None:
    with pytest.raises(
        StepNcError, match=f"zero '{text}': expected 3 numbers separated by commas"
    ):
        numbers_in(text, "zero", counts=(3,))


def test_what_is_handed_on_is_counted() -> None:
    items = CountedIterator(["ab", "c", "defg"], len)
    assert list(islice(items, 2)) == ["ab", "c"]
    assert items.count == 2
    assert items.share(12) == 0.25
    assert items.share(2) == 1.0
    assert CountedIterator([]).share(0) == 0.0


def program(machine: str = "vmc15") -> PreparedRun:
    return from_program(BRACKET, RunRequest(machine=machine), tell=silent)


def test_a_program_brings_tools_stock_and_material() -> None:
    prepared = program()
    assert prepared.name == "bracket.stpnc"
    assert prepared.material is not None
    assert prepared.material.material.name == "c45"
    assert prepared.tools is not None
    assert list(prepared.tools) == [1, 2, 3, 4, 5, 6, 7]
    assert prepared.raw is not None
    assert prepared.raw.high == (153.0, 93.0, 2.0)
    assert isinstance(prepared.stock("ROUGH FACE"), MillingStock)
    assert prepared.stock("ROUGH FACE") is prepared.stock("FINISH FACE")
    assert prepared.stock("ANOTHER") is None


def test_blocks_of_a_program_are_counted_to_its_end() -> None:
    prepared = program()
    assert prepared.done() == 0.0
    lines = [line for line, _ in prepared.blocks]
    assert lines == list(range(1, len(lines) + 1))
    assert prepared.done() > 0.95
