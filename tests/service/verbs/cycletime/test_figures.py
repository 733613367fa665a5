"""Figure of a cycle time."""

from pathlib import Path

import pytest

import stepnc
from service.verbs.cycletime.figures import MOST_POINTS, cycle_time_figure
from tests.service.verbs.cycletime.test_run import code


def test_feeds_of_blocks_are_drawn_and_long_programs_thinned(tmp_path: Path) -> None:
    times = stepnc.cycletime(code(tmp_path), machine="vmc15").times
    drawn = {each.name: each for each in cycle_time_figure(times).data}
    assert len(drawn["predicted"].x) == 1000 <= MOST_POINTS
    assert max(drawn["by the block rate"].y) == pytest.approx(60.0 * 0.1 / 0.0042)
    assert max(drawn["programmed"].y) == pytest.approx(6000.0)
