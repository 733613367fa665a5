"""Figure of a fitted block rate."""

from extras.calibration.verbs.blockfit.figures import block_fit_figure
from extras.calibration.verbs.blockfit.result import paper_fit


def test_the_fit_of_table_2_is_drawn_with_its_outlier() -> None:
    fit = paper_fit()
    figure = block_fit_figure(fit, fit, printed=14_847.0)
    drawn = {each.name: each for each in figure.data}
    assert len(drawn["held by: block rate"].x) == 8
    assert len(drawn["held by: unknown"].x) == 1
    assert {"through the origin", "with an intercept", "robust"} <= set(drawn)
