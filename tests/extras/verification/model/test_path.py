"""Programmed paths as chords."""

from math import pi

import numpy as np
import pytest

from extras.verification.model.path import SAGITTA, chorded, rows_between
from simulator.motion.segments import arc
from tests.extras.verification.model.block import round_path, slot_path


def test_chords_stay_within_their_sagitta_of_an_arc() -> None:
    points, rows = chorded(arc((10.0, 0.0, 0.0), (0.0, 0.0, 0.0), pi))
    middles = 0.5 * (points[1:] + points[:-1])
    assert np.hypot(*points[:, :2].T) == pytest.approx(10.0)
    assert np.hypot(*middles[:, :2].T).min() >= 10.0 - SAGITTA * (1.0 + 1e-9)
    assert len(rows) == len(points) - 1
    assert not rows.any()


def test_a_path_turns_at_its_square_corner() -> None:
    path = slot_path()
    assert path.turn == pytest.approx([pi, 0.5 * pi])
    assert path.station == pytest.approx([0.0, 35.0])
    assert not path.is_plunge.any()


def test_a_plunge_is_known_and_arcs_keep_their_radius() -> None:
    path = round_path()
    assert path.is_plunge.tolist() == [True, False]
    assert path.radius == pytest.approx([np.inf, 10.0])


def test_rows_are_lines_in_the_plane_of_x_and_y() -> None:
    rows = rows_between(np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]))
    assert rows.shape == (1, 13)
    assert rows[0, :6].tolist() == [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]
    assert rows[0, 12] == 2.0
