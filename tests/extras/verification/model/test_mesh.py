"""A box of triangles is cut and measured."""

import numpy as np
import pytest

from extras.verification.model.mesh import height_deviation, outline_at, wall_deviation
from tests.extras.verification.model.box import box


def test_the_outline_of_a_box_has_its_perimeter() -> None:
    outline = outline_at(box((0.0, 0.0, -10.0), (40.0, 20.0, 0.0)), -3.0)
    length = sum(float(np.linalg.norm(line[1] - line[0])) for line in outline.points)
    assert length == pytest.approx(120.0)
    assert outline_at(box((0.0, 0.0, -10.0), (40.0, 20.0, 0.0)), 5.0).points == ()


def test_a_wall_before_the_box_is_an_excess() -> None:
    outline = outline_at(box((0.0, 0.0, -10.0), (40.0, 20.0, 0.0)), -3.0)
    found = wall_deviation(np.array([[15.0, 20.3]]), np.array([[0.0, -1.0]]), outline)
    assert found == pytest.approx([0.3])


def test_heights_over_the_top() -> None:
    triangles = box((0.0, 0.0, -10.0), (40.0, 20.0, 0.0))
    places = np.array([[5.0, 5.0, 0.1], [39.0, 1.0, -0.2], [50.0, 5.0, 0.0], [5.0, 5.0, -5.0]])
    found = height_deviation(places, triangles)
    assert found[:2] == pytest.approx([0.1, -0.2])
    assert np.isnan(found[2:]).all()
