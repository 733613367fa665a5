"""NC code of a run with the setup that the code itself tells."""

from pathlib import Path

import pytest

from service.simulation.code_run import code_of_run
from service.simulation.code_simulation import CodeRequest

CODE = (
    "(T1 D=10. - FLAT END MILL)\nG21 G90 G54\nT1 M6\nS5000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F100\nX50\n"
)


@pytest.fixture
def request_of(tmp_path: Path) -> CodeRequest:
    """Request of a program with a tool in a comment."""
    place = tmp_path / "part.nc"
    place.write_text(CODE)
    return CodeRequest(code=place)


def test_with_a_material_tools_and_stock_are_those_of_the_code(request_of: CodeRequest) -> None:
    found = code_of_run(request_of, material="c45", machine="vmc15", named=None)
    assert found.code.library is not None
    assert found.code.stock
    assert found.code.is_stock_guessed


def test_without_a_material_nothing_is_cut(request_of: CodeRequest) -> None:
    found = code_of_run(request_of, material="", machine="vmc15", named=None)
    assert found.code is request_of


def test_what_is_missing_is_told(request_of: CodeRequest) -> None:
    request_of.code.write_text(CODE.partition("\n")[2])
    found = code_of_run(request_of, material="c45", machine="vmc15", named=None)
    assert found.code.library is None
    assert any("the setup lacks: tools" in each.message for each in found.code.findings)
