"""Stock as a map of heights."""

from math import pi

import pytest

from simulator.removal.zmap import MOST_CELLS, OUTSIDE, cell_size, zmap_of
from stepnc_model.programs.program import Stock


def test_box_keeps_its_volume_whatever_the_cell() -> None:
    box = Stock(low=(0.0, 0.0, -5.0), high=(10.0, 7.3, 0.0))
    assert zmap_of(box, cell=0.37).volume == pytest.approx(10.0 * 7.3 * 5.0)
    assert zmap_of(box, cell=0.37).cell <= 0.37


def test_bar_is_a_circle_of_cells() -> None:
    bar = Stock(low=(-10.0, -10.0, 0.0), high=(10.0, 10.0, 3.0), radius=10.0)
    found = zmap_of(bar, cell=0.05)
    assert found.volume == pytest.approx(300.0 * pi, rel=1e-3)
    assert (found.grid.owner == OUTSIDE).mean() == pytest.approx(1.0 - pi / 4.0, abs=1e-3)


def test_cells_suit_the_tool_and_stay_few() -> None:
    box = Stock(low=(0.0, 0.0, -5.0), high=(100.0, 100.0, 0.0))
    assert cell_size(box) == pytest.approx(0.1)
    assert cell_size(box, smallest_diameter=1.5) == pytest.approx(0.075)
    finest = cell_size(box, smallest_diameter=0.1)
    assert 100.0 * 100.0 / finest**2 == pytest.approx(MOST_CELLS)
