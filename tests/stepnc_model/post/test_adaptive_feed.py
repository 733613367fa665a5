"""Adaptive feed in posted code: LinuxCNC alone has it, and reads it back."""

from pathlib import Path

import pytest

from service.programs.toolpaths import nc_lines, paths_of
from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Program

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"


def test_adaptive_feed_is_on_before_the_first_move_and_off_at_the_end() -> None:
    paths = paths_of(Program.load(PART))
    plain = list(nc_lines(paths, Dialect.LINUXCNC))
    lines = list(nc_lines(paths, Dialect.LINUXCNC, is_adaptive=True))
    words = [line.split(maxsplit=1)[-1] for line in lines]
    assert words.index("M52 P1") < next(row for row, each in enumerate(words) if "G0" in each)
    # M2 keeps adaptive feed: the next program would run with it.
    assert words.index("M2") == words.index("M52 P0") + 1
    assert not any("M52" in line for line in plain)
    # The reader understands it, and has the same moves.
    assert list(read_blocks(lines, Dialect.LINUXCNC)) == list(
        read_blocks(plain, Dialect.LINUXCNC)
    )


@pytest.mark.parametrize("control", [each for each in Dialect if each != Dialect.LINUXCNC])
def test_other_controls_have_no_adaptive_feed(control: Dialect) -> None:
    with pytest.raises(PostError, match="adaptive feed is written for linuxcnc, not"):
        list(nc_lines(paths_of(Program.load(PART)), control, is_adaptive=True))
