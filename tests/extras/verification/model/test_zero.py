"""Fit of the zero, which cannot hide a constant error."""

import numpy as np
import pytest

from extras.verification.model.path import distance_from, fitted_zero
from tests.extras.verification.model.block import SLOT, sampled, slot_path


def test_whole_millimetres_are_fitted_and_the_rest_stays() -> None:
    moved = sampled(SLOT, 0.3) + np.array([-400.0, 250.3, 12.0])
    zero, rest = fitted_zero(moved, slot_path())
    assert zero == (-400.0, 250.0, 12.0)
    assert rest == pytest.approx([0.0, 0.3, 0.0], abs=2e-3)


def test_distance_from_the_path() -> None:
    points = np.array([[0.0, 23.0, -4.0], [25.0, 30.0, 0.0]])
    assert distance_from(points, slot_path()) == pytest.approx([3.0, 4.0])
