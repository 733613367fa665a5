"""Ways between samples: their turns, and how long they may be."""

import numpy as np
import pytest

from extras.verification.model.sample_ways import longest_ways, turns_of


def test_the_turns_of_a_path() -> None:
    corner = np.array([[0.0, 0.0, 0.0], [1, 0, 0], [2, 0, 0], [2, 0, 0], [2, 1, 0], [2, 2, 0]])
    half = 0.5 * np.pi
    before, behind = turns_of(corner)
    assert before == pytest.approx([np.pi, 0.0, 0.0, half, 0.0])
    assert behind == pytest.approx([0.0, half, 0.0, 0.0, np.pi])


def test_a_way_is_as_long_as_those_on_steady_straights_around() -> None:
    seconds = np.full(5, 0.1)
    steady = np.array([1.6, 1.7, 0.4, 1.7, np.nan])
    assert longest_ways(steady, seconds)[2] == 1.7
    # Twice as long without a sample: the tool may have gone twice as far.
    assert longest_ways(steady, seconds * [1, 1, 2, 1, 1])[2] == 3.4
    # In at one speed and out at another one.
    assert longest_ways(np.array([1.7, 1.7, 0.4, 9.0, 9.0]), seconds)[2] == np.inf
    assert longest_ways(np.array([np.nan, np.nan, 0.4, 1.7, 1.7]), seconds)[2] == np.inf
