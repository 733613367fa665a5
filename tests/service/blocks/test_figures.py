"""Figures of block rate and cycle time."""

from service.blocks.block_fit import paper_points
from service.blocks.figures import block_fit_figure
from simulator.calibration.block_fit import fitted_block_time


def test_the_fit_of_table_2_is_drawn_with_its_outlier() -> None:
    fit = fitted_block_time(paper_points())
    figure = block_fit_figure(fit, fit, printed=14_847.0)
    drawn = {each.name: each for each in figure.data}
    assert len(drawn["held by: block rate"].x) == 8
    assert len(drawn["held by: unknown"].x) == 1
    assert {"through the origin", "with an intercept", "robust"} <= set(drawn)
