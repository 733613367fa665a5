"""Points on profiles, and distances from them."""

from math import pi, sqrt

import numpy as np
import pytest

from extras.verification.model.logged_bar import (
    PIECE,
    face_places,
    nearest_on,
    points_along,
    points_on_faces,
    profile_distance,
)
from simulator.removal.lathe import TurningStock
from stepnc_model.programs.program import Stock

BAR = TurningStock(Stock(low=(-20.0, -20.0, -10.0), high=(20.0, 20.0, 0.0), radius=20.0), 0.01)
SHOULDER = np.where(BAR.z > -5.0, 15.0, 20.0)
"""A face of 5 mm at z = -5."""


def test_a_shoulder_has_points_every_piece_of_its_height() -> None:
    places = face_places(SHOULDER, BAR)
    assert len(places) == round(5.0 / PIECE)
    assert places[:, 1] == pytest.approx(-5.0, abs=BAR.cell)
    assert np.diff(places[:, 0]) == pytest.approx(-PIECE)


def test_points_stand_for_the_areas_of_face_and_diameters() -> None:
    faces = points_on_faces(SHOULDER, SHOULDER, BAR)
    assert faces.area.sum() == pytest.approx(pi * (20.0**2 - 15.0**2), rel=1e-9)
    along = points_along(SHOULDER, SHOULDER, BAR)
    plain = along.area[~along.is_face].sum()
    assert plain == pytest.approx(2.0 * pi * (20.0 + 15.0) * 5.0, rel=2e-3)


def test_a_profile_that_is_larger_has_material_beyond() -> None:
    assert (points_along(SHOULDER, SHOULDER + 0.1, BAR).sign > 0.0).all()
    assert (points_along(SHOULDER, SHOULDER - 0.1, BAR).sign < 0.0).all()


def test_the_distance_from_a_cone_is_normal_to_it() -> None:
    cone = np.column_stack([10.0 - BAR.z, BAR.z])
    point = np.array([[15.0 + sqrt(2.0), -5.0]])
    assert profile_distance(point, cone, BAR.cell) == pytest.approx(1.0, abs=1e-9)
    line = nearest_on(point, cone, BAR.cell)[1]
    assert BAR.z[line] == pytest.approx(-5.0 - sqrt(0.5), abs=2.0 * BAR.cell)
