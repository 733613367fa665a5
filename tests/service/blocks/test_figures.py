"""Figures of block rate and cycle time."""

from pathlib import Path

import pytest

import stepnc
from service.blocks.figures import MOST_POINTS, block_fit_figure, cycle_time_figure
from service.verbs.blockfit.result import paper_fit
from tests.service.verbs.cycletime.test_run import code


def test_the_fit_of_table_2_is_drawn_with_its_outlier() -> None:
    fit = paper_fit()
    figure = block_fit_figure(fit, fit, printed=14_847.0)
    drawn = {each.name: each for each in figure.data}
    assert len(drawn["held by: block rate"].x) == 8
    assert len(drawn["held by: unknown"].x) == 1
    assert {"through the origin", "with an intercept", "robust"} <= set(drawn)


def test_feeds_of_blocks_are_drawn_and_long_programs_thinned(tmp_path: Path) -> None:
    times = stepnc.cycletime(code(tmp_path), machine="vmc15").times
    drawn = {each.name: each for each in cycle_time_figure(times).data}
    assert len(drawn["predicted"].x) == 1000 <= MOST_POINTS
    assert max(drawn["by the block rate"].y) == pytest.approx(60.0 * 0.1 / 0.0042)
    assert max(drawn["programmed"].y) == pytest.approx(6000.0)
