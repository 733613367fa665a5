"""Tools that NC code calls by name, or not at all."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.cli.commands import print_result
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from tests.service.along_path.foreign import MILL

TABLE = "number,kind,id,diameter_mm,teeth\n"
MILL_10 = "4,endmill,FR10,10,3\n"
DRILL = "5,drill,DR8,8,2\n"
CUT = "S3000 M3\nG0 X-10 Y10 Z5\nZ-4\nG1 X110 F300\nG0 Z20\nM30\n"
NAMED = 'G17 G54 G71 G90\nT="fr10"\nM6\nD1\n' + CUT
WITHOUT = "G21 G90\n" + CUT


def advised(folder: Path, code: str, table: str) -> CodeAdvice:
    """Advice for code with a tool table."""
    file, tools = folder / "part.nc", folder / "tools.csv"
    file.write_text(code)
    tools.write_text(table)
    return optimise_code(replace(MILL, dialect=None), AdviceFiles(file=file, tools=tools))


def told(found: CodeAdvice) -> str:
    """Findings of advice, one a line."""
    return "\n".join(str(each) for each in found.findings)


def test_a_name_is_the_id_of_the_table(tmp_path: Path) -> None:
    found = advised(tmp_path, NAMED, TABLE + MILL_10 + DRILL)
    assert found.rewritten.changed == 1
    assert "note: tool 'fr10' is T4 of the table, by its id" in told(found)


@pytest.mark.parametrize("table", [DRILL, MILL_10 + "6,endmill,fr10,6,2\n"])
def test_a_name_that_the_table_lacks_or_has_twice_keeps_its_feeds(
    tmp_path: Path, table: str
) -> None:
    found = advised(tmp_path, NAMED, TABLE + table)
    assert found.rewritten.changed == 0
    assert "warning: tool 'fr10' is the id of no tool of the table" in told(found)


def test_a_program_without_tools_takes_the_only_one(tmp_path: Path) -> None:
    found = advised(tmp_path, WITHOUT, TABLE + MILL_10)
    assert found.rewritten.changed == 1
    assert "warning: the program calls no tool: T4, the only one of the table" in told(found)


def test_a_program_without_tools_is_printed_with_what_it_needs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = advised(tmp_path, WITHOUT, TABLE + MILL_10 + DRILL)
    assert found.rewritten.data == WITHOUT.encode()
    print_result(found)
    shown = capsys.readouterr()
    assert "the program calls no tool, and the table has 2" in shown.out + shown.err
