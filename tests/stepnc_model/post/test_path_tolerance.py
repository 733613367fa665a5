"""Path modes of posted code: corners are rounded within what the part allows."""

import re
from pathlib import Path

import pytest

from service.programs.toolpaths import nc_lines, paths_of
from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.post.blocks import Linear, MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.path_tolerance import FINISHING, LEAST, ROUGHING, path_tolerance
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"
MODE = re.compile(r"^(?:N\d+ )?(G6[014].*)$")


def modes(part: str, control: Dialect, *, is_exact: bool = False) -> list[str]:
    lines = nc_lines(paths_of(Program.load(PARTS / part)), control, is_exact=is_exact)
    return [found[1] for line in lines if (found := MODE.match(line))]


def test_each_workingstep_has_a_tolerance_within_its_bounds() -> None:
    for part in sorted(PARTS.glob("*.stpnc")):
        program = Program.load(part)
        for step in program.workingsteps:
            left = [
                getattr(step.operation, f"allowance{side}", None)
                for side in ("", "_side", "_bottom")
            ]
            is_final = not any(left)
            tolerance = path_tolerance(program, step)
            assert LEAST <= tolerance <= (FINISHING if is_final else ROUGHING), step.id
    assert path_tolerance(program, None) == FINISHING


def test_linuxcnc_code_names_its_path_mode_before_the_first_move() -> None:
    lines = list(nc_lines(paths_of(Program.load(PARTS / "bracket.stpnc")), Dialect.LINUXCNC))
    first_move = next(row for row, line in enumerate(lines) if re.search(r"\bG[0123]\b", line))
    first_mode = next(row for row, line in enumerate(lines) if "G64" in line)
    assert first_mode < first_move
    found = modes("bracket.stpnc", Dialect.LINUXCNC)
    assert all(re.fullmatch(r"G64 P0\.\d+", mode) for mode in found)
    assert len(set(found)) > 2


def test_exact_stops_are_written_where_a_control_has_them() -> None:
    assert modes("paper002.stpnc", Dialect.LINUXCNC, is_exact=True) == ["G61"]
    assert modes("paper002.stpnc", Dialect.FANUC, is_exact=True) == ["G61", "G64"]
    assert modes("paper002.stpnc", Dialect.HAAS, is_exact=True) == ["G61", "G64"]
    assert modes("paper002.stpnc", Dialect.SINUMERIK, is_exact=True) == ["G60", "G64"]
    for control in (Dialect.HEIDENHAIN, Dialect.CANONICAL):
        with pytest.raises(PostError, match="--exact-path"):
            modes("paper002.stpnc", control, is_exact=True)


def test_code_with_a_path_mode_is_read_back() -> None:
    paths = paths_of(Program.load(PARTS / "paper002.stpnc"))
    for control in (Dialect.LINUXCNC, Dialect.FANUC, Dialect.SINUMERIK):
        ends = []
        for is_exact in (False, True):
            lines = nc_lines(paths, control, is_exact=is_exact)
            blocks = read_blocks(lines, control, machine=MachineType.MILL)
            ends.append([each.end for each in blocks if isinstance(each, Linear)])
        assert ends[0] == ends[1]
        assert ends[0]
