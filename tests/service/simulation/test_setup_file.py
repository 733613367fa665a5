"""Setup files beside NC code: what is read, refused, and still a guess."""

from pathlib import Path

import pytest

from service.requests.program_facts import StockFile
from service.simulation.code_setup import GivenSetup, code_setup
from service.simulation.setup_file import SetupFile, read_setup, setup_of, setup_place
from simulator.errors import LibraryError
from stepnc_model.errors import Finding
from stepnc_model.nc.program import read_program

CODE = (
    b"(T1 D=10. - FLAT END MILL)\nG21 G90 G54\nT1 M6\nS5000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F100\nX50\n"
)
TOOL = '[[tool]]\nnumber = 1\nkind = "endmill"\ndiameter_mm = 10\nteeth = 4\n'


def written(folder: Path, text: str) -> Path:
    """Setup file beside part.nc."""
    place = setup_place(folder / "part.nc")
    place.write_text(text)
    return place


def found(folder: Path, text: str) -> SetupFile:
    """Setup that is found beside part.nc."""
    written(folder, text)
    setup = setup_of(folder / "part.nc", None)
    assert isinstance(setup, SetupFile)
    return setup


def test_what_stays_in_the_list_is_a_guess(tmp_path: Path) -> None:
    setup = found(tmp_path, TOOL + 'guessed = ["teeth"]\n')
    guess = setup.guesses[1]
    assert (guess.has_teeth, guess.has_edge, guess.has_length) == (True, False, False)
    assert not found(tmp_path, TOOL).guesses


def test_what_the_file_gives_counts_before_comments_and_after_the_user(tmp_path: Path) -> None:
    file = found(tmp_path, 'material = "c45"\n[stock]\nnumbers_mm = "-9,-9,-9,60,9,0"\n' + TOOL)
    given = GivenSetup(file=tmp_path / "part.nc", material="al6061", file_of_setup=file)
    setup = code_setup(read_program(CODE), given)
    assert (setup.material, setup.stock) == ("al6061", "-9,-9,-9,60,9,0")
    assert not setup.is_stock_guessed
    assert [tool.teeth for tool in setup.library.tools] == [4]
    assert not setup.missing


def test_a_setup_of_another_program_is_not_used(tmp_path: Path) -> None:
    written(tmp_path, 'program = "part.mpf"\n' + TOOL)
    told = setup_of(tmp_path / "part.nc", None)
    assert isinstance(told, Finding)
    assert "part.mpf" in told.message
    assert setup_of(tmp_path / "other.nc", None) is None


def test_files_that_it_names_lie_beside_it(tmp_path: Path) -> None:
    setup = found(tmp_path, 'tools = "tools.csv"\n[stock]\nfile = "raw.stl"\n')
    assert setup.table == tmp_path / "tools.csv"
    assert setup.stock == StockFile(path=tmp_path / "raw.stl")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (TOOL + TOOL, "tool[2].number"),
        ('tools = "t.csv"\n' + TOOL, "tools"),
        ('[stock]\nnumbers_mm = "1,2"\nfile = "a.stl"\n', "stock.numbers_mm"),
        ('[stock]\nnumbers_mm = "5,0,0,1,1,1"\n', "stock.numbers_mm"),
        (TOOL.replace("teeth = 4\n", ""), "tool[1].teeth"),
        (TOOL + 'guessed = ["colour"]\n', "tool[1].guessed[1]"),
    ],
)
def test_a_fault_names_its_key(tmp_path: Path, text: str, key: str) -> None:
    with pytest.raises(LibraryError) as error:
        read_setup(written(tmp_path, text))
    assert error.value.key == key


@pytest.mark.parametrize(
    ("text", "key"), [('unit = "inch"\n', "unit"), ('zero = "G55"\n', "zero")]
)
def test_unit_and_zero_are_those_of_the_program(tmp_path: Path, text: str, key: str) -> None:
    given = GivenSetup(file=tmp_path / "part.nc", file_of_setup=found(tmp_path, text))
    with pytest.raises(LibraryError) as error:
        code_setup(read_program(CODE), given)
    assert error.value.key == key
