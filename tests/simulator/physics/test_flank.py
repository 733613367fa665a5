from math import hypot

import numpy as np
import pytest

from simulator.physics import flank


def test_wear_of_nothing_or_an_edge_out_of_the_cut_adds_nothing() -> None:
    assert flank.land_force(flank.CUTTING, 0.0, 3.0) == 0.0
    assert flank.land_force(flank.CUTTING, 0.3, 0.0) == 0.0


def test_force_is_in_proportion_to_wear_and_width() -> None:
    one = flank.land_force(flank.FEED, 0.1, 2.0)
    assert flank.land_force(flank.FEED, 0.2, 4.0) == pytest.approx(4.0 * one)


def test_arrays_are_taken_element_by_element() -> None:
    found = flank.land_force(flank.BACK, np.array([0.1, 0.2]), np.array([1.0, 3.0]))
    np.testing.assert_allclose(found, [158.0, 948.0])


def test_what_acts_square_to_the_edge_is_feed_and_back_force_together() -> None:
    assert pytest.approx(hypot(950.0, 1580.0)) == flank.NORMAL
