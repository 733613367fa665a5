"""NC code that people name for a run, and data of it without it."""

from pathlib import Path
from typing import Any

import pytest

from service.requests.code_files import CodeFiles
from service.simulation.code_files import run_files
from simulator.tool_files.file_unit import FileUnit
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

PART, CODE, TABLE = Path("part.stpnc"), Path("part.ngc"), Path("tool.tbl")
STOCK = "0,0,-20,60,40,0"


def test_a_program_needs_no_code() -> None:
    files = run_files(CodeFiles(), PART, stock=STOCK)
    assert (files.file, files.code) == (PART, None)


def test_code_gets_its_tools_and_the_stock() -> None:
    named = CodeFiles(nc=CODE, tools=TABLE, tools_unit=FileUnit.INCH, most_repeats=7)
    code = run_files(named, None, stock=STOCK).code
    assert code is not None
    assert (code.code, code.tools, code.tools_unit) == (CODE, TABLE, FileUnit.INCH)
    assert (code.stock, code.most_repeats) == (STOCK, 7)


@every_case(
    ("words", "message"),
    [
        ({"dialect": "fanuc"}, "need NC code"),
        ({"tools": TABLE}, "need NC code"),
        ({"nc": CODE, "tools_unit": FileUnit.INCH}, "needs a tool table"),
    ],
)
def test_data_of_nothing_are_refused(words: dict[str, Any], message: str) -> None:
    with pytest.raises(StepNcError, match=message):
        run_files(CodeFiles(**words), PART, stock="")
