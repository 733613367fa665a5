"""Distances from nominal walls and floors."""

import numpy as np
import pytest

from extras.verification.model.mesh import (
    NominalOutline,
    floor_deviation,
    profile_side,
    wall_deviation,
)

LINE = NominalOutline(points=(np.array([[0.0, 10.0], [50.0, 10.0]]),))


def test_a_wall_short_of_its_outline_leaves_material() -> None:
    points = np.array([[20.0, 9.7], [20.0, 10.2], [20.0, 2.0]])
    normal = np.tile([0.0, 1.0], (3, 1))
    found = wall_deviation(points, normal, LINE)
    assert found[:2] == pytest.approx([0.3, -0.2])
    assert np.isnan(found[2])


def test_without_an_outline_nothing_is_known() -> None:
    found = wall_deviation(np.zeros((1, 2)), np.ones((1, 2)), NominalOutline(points=()))
    assert np.isnan(found).all()


def test_a_floor_is_compared_with_the_nearest() -> None:
    found = floor_deviation(np.array([-11.9, -8.05, -3.0]), [-12.0, -8.0])
    assert found[:2] == pytest.approx([0.1, -0.05])
    assert np.isnan(found[2])
    assert np.isnan(floor_deviation(np.zeros(1), [])).all()


def test_a_turned_profile_has_its_material_towards_the_axis() -> None:
    # A face, a cylinder of 10 mm and a shoulder, from the front.
    chain = np.array([[0.0, 0.0], [0.0, 10.0], [-20.0, 10.0], [-20.0, 15.0]])
    points = np.array([[0.1, 5.0], [-5.0, 10.3], [-5.0, 9.8], [-19.9, 12.0], [-20.0, 15.2]])
    found = profile_side(points, [chain])
    assert found[:4] == pytest.approx([0.1, 0.3, -0.2, 0.1])
    # Beyond the end of the profile nothing is known, nor without one.
    assert np.isnan(found[4])
    assert np.isnan(profile_side(points, [])).all()
