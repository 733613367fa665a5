"""The table of tool paths adds up to what the paths say."""

from math import dist
from pathlib import Path

import pytest

from service.paths.output import print_paths
from service.paths.toolpaths import tool_paths

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def test_lengths_of_a_drilled_hole_are_those_of_its_moves(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Only straight moves: contact, air and rapid add up to the whole way."""
    paths = tool_paths(PARTS / "bracket.stpnc")
    print_paths(paths)
    row = next(
        line for line in capsys.readouterr().out.splitlines() if line.startswith("DRILL HOLE 1")
    )
    path = next(path for path in paths.paths if path.id == "DRILL HOLE 1")
    whole = sum(dist(start, move.end) for start, move in path.segments())
    *_, moves, arcs, contact, air, rapid, lowest = row.split()
    assert (int(moves), int(arcs)) == (len(path.moves), 0)
    assert float(contact) + float(air) + float(rapid) == pytest.approx(whole, abs=1.5)
    assert float(lowest) == pytest.approx(min(move.end[2] for move in path.moves), abs=1e-3)


def test_a_stop_has_a_row_of_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    print_paths(tool_paths(PARTS / "bracket.stpnc"))
    assert "LOOK AT THE CLAMPING  optional_stop\n" in capsys.readouterr().out
