"""Tools and stock of NC code, from the user, the code, or its moves."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.simulation.code_setup import CodeSetup, GivenSetup, code_setup, numbers_of
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Stock

POSTS = Path(__file__).parents[2] / "data" / "posts"
TABLE = "number,kind,diameter_mm,teeth\n1,endmill,12,3\n"
BARE = "G21 G90\nT1 M6\nS5000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F100\nX50 F400\nG0 Z5\n"
GIVEN = GivenSetup(file=Path("a part.nc"), material="c45", machine="vmc15")


def setup(code: str, given: GivenSetup = GIVEN, dialect: Dialect | None = None) -> CodeSetup:
    """Tools and stock of a program."""
    return code_setup(read_program(code.encode(), dialect=dialect), given)


def test_nothing_is_missing_where_comments_and_moves_tell() -> None:
    found = setup("(T1 D=10. - FLAT END MILL)\n" + BARE)
    found.require_whole()
    assert found.is_stock_guessed
    assert found.guesses[1].has_teeth
    assert found.uses[1].depth == pytest.approx(7.0)


@pytest.mark.parametrize(
    ("post", "stock"),
    [
        ("heidenhain.h", "-50,-40,-20,50,40,0"),
        ("sinumerik.mpf", "-50,-40,-20,50,40,0"),
        ("mastercam.nc", "-50.8,-38.1,-25.4,50.8,38.1,0"),
    ],
)
def test_a_stated_stock_is_no_guess(post: str, stock: str) -> None:
    found = code_setup(read_program((POSTS / post).read_bytes()), GIVEN)
    assert (found.stock, found.is_stock_guessed) == (stock, False)


def test_what_the_user_gives_wins(tmp_path: Path) -> None:
    table = tmp_path / "tools.csv"
    table.write_text(TABLE)
    given = replace(GIVEN, tools=table, stock="0,0,-5,50,50,0")
    found = setup("(T1 D=10. - FLAT END MILL)\n" + BARE, given)
    assert (found.stock, found.is_stock_guessed, found.guesses) == (given.stock, False, {})
    assert [tool.teeth for tool in found.library.tools] == [3]
    assert any("12 mm" in each.message for each in found.library.findings)


def test_everything_that_is_missing_is_told_at_once() -> None:
    found = setup(BARE, GivenSetup(file=Path("a part.nc")))
    with pytest.raises(StepNcError) as error:
        found.require_whole()
    message = str(error.value)
    assert "T1" in message
    assert "material" in message
    assert found.command in message
    assert found.command == (
        "stepnc optimise 'a part.nc' --tools TABLE --material MATERIAL --machine vmc15"
    )


def test_a_guessed_stock_is_not_named_in_the_command() -> None:
    # It would come back as a given one.
    found = setup("(T1 D=10. - FLAT END MILL)\n" + BARE, replace(GIVEN, material=""))
    assert found.is_stock_guessed
    assert "--stock" not in found.command


def test_a_lathe_needs_table_and_stock() -> None:
    code = "G18 G21 G90 G96 S200\nT0101\nG0 X50 Z1\nG1 Z-20 F0.2\n"
    found = setup(code, GivenSetup(file=Path("a.nc")), Dialect.FANUC)
    assert len(found.missing) == 3
    assert "--stock=DIAMETER,Z0,Z1" in found.command
    assert "--machine lathe22" in found.command


def test_faults_in_a_guessed_stock_are_warnings() -> None:
    found = setup("(T1 D=10. - FLAT END MILL)\n" + BARE)
    fault = Finding(severity=Severity.ERROR, message="a rapid move cuts", line=4)
    assert found.faults_in_stock((fault,)) == ()
    (doubt,) = found.doubts((fault,))
    assert (doubt.severity, doubt.line) == (Severity.WARNING, 4)
    sure = replace(found, is_stock_guessed=False)
    assert sure.faults_in_stock((fault,)) == (fault,)
    assert not list(sure.doubts((fault,)))


def test_numbers_of_a_guess_are_rounded_outward() -> None:
    box = Stock(low=(-1.00049, 0.0, -2.0), high=(5.00041, 9.0, 0.0))
    assert numbers_of(box) == "-1.001,0,-2,5.001,9,0"
    bar = Stock(low=(-25.0, -25.0, -80.0), high=(25.0, 25.0, 1.0), radius=25.0)
    assert numbers_of(bar) == "0,0,50,-80,1"
