"""Blocks, tools and stock from a program or from NC code."""

from itertools import islice
from pathlib import Path

import pytest

from service.numbers import numbers_in
from service.reading import silent
from service.requests.runs import RunRequest
from service.simulation.setup import (
    CodeRequest,
    CountedIterator,
    PreparedRun,
    from_code,
    from_program,
)
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from stepnc_model.errors import StepNcError
from stepnc_model.post import blocks as post

EXAMPLES = Path(__file__).parents[3] / "examples"
BRACKET = EXAMPLES / "parts" / "bracket.stpnc"
TOOLS = EXAMPLES / "tools" / "bracket.toml"


def test_numbers_are_read_in_order() -> None:
    assert numbers_in("-3, 1e2,.5", "zero", counts=(3,)) == (-3.0, 100.0, 0.5)
    assert numbers_in("7", "stock", counts=(1, 2)) == (7.0,)


@pytest.mark.parametrize("text", ["", "x", "1,", "1,2,nan", "1,2,inf", "1,2", "1 2 3"])
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


def test_the_table_of_the_example_holds_the_tools_of_its_program(tmp_path: Path) -> None:
    code = tmp_path / "a.ngc"
    code.touch()
    request = CodeRequest(code=code, tools=TOOLS, stock="-3,-3,-40,153,93,2")
    prepared = from_code(request, RunRequest(machine="vmc15", material="c45"), program=None)
    known = program()
    assert prepared.tools == known.tools
    assert prepared.raw == known.raw


def coded(folder: Path, text: str, name: str = "a.ngc", *, dialect: str = "") -> PreparedRun:
    path = folder / name
    path.write_text(text, encoding="ascii")
    request = CodeRequest(code=path, dialect=dialect)
    return from_code(request, RunRequest(machine="vmc15"), program=None)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.ngc", "G21 G90 G94\nG0 X1 Y2 Z3\n"),
        ("a.NC", "G21 G90 G94\nG0 X1. Y2. Z3.\n"),
        ("a.mpf", "G710 G90 G94\nG0 X1 Y2 Z3\n"),
        ("a.h", "0 BEGIN PGM A MM\n1 L X+1 Y+2 Z+3 R0 FMAX\n"),
    ],
)
def test_the_ending_of_a_file_names_its_dialect(tmp_path: Path, name: str, text: str) -> None:
    rapids = [
        (line, block.end)
        for line, block in coded(tmp_path, text, name).blocks
        if isinstance(block, post.Rapid)
    ]
    assert rapids == [(2, (1.0, 2.0, 3.0))]


def test_a_dialect_that_is_named_wins(tmp_path: Path) -> None:
    prepared = coded(tmp_path, "0 BEGIN PGM A MM\n1 M8\n", dialect="HEIDENHAIN")
    assert [line for line, block in prepared.blocks if isinstance(block, post.Coolant)] == [2]


def test_a_file_that_names_no_dialect_is_refused(tmp_path: Path) -> None:
    prepared = coded(tmp_path, "M30\n", "a.tap")
    with pytest.raises(StepNcError, match="add --dialect: canonical, linux"):
        next(prepared.blocks)


def test_remarks_that_name_a_workingstep_begin_it(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("(rough-face)\n(mill a slot)\n(MILL SLOT)\n", encoding="ascii")
    request = CodeRequest(code=path)
    prepared = from_code(request, RunRequest(machine="vmc15"), program=BRACKET)
    begun = [
        block.workingstep for _, block in prepared.blocks if isinstance(block, post.Comment)
    ]
    assert begun == ["ROUGH FACE", "", "MILL SLOT"]


def test_a_bar_has_a_diameter_and_two_ends(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("", encoding="ascii")
    request = CodeRequest(code=path, stock="60,-150,2", tools=TOOLS)
    prepared = from_code(request, RunRequest(machine="lathe22", material="c45"), program=None)
    assert prepared.raw is not None
    assert (prepared.raw.low, prepared.raw.high) == ((-30.0, -30.0, -150.0), (30.0, 30.0, 2.0))
    assert prepared.raw.radius == 30.0
    assert isinstance(prepared.stock(""), TurningStock)


def test_share_of_code_is_that_of_its_bytes(tmp_path: Path) -> None:
    prepared = coded(tmp_path, "G90\n" * 10)
    assert prepared.done() == 0.0
    assert list(prepared.blocks) == []
    assert prepared.done() == 1.0
