"""Points on the walls of the programmed part."""

import numpy as np
import pytest

from extras.verification.model.surface import LEVELS
from tests.extras.verification.model.block import part_of, round_path, slot_path


def test_points_lie_on_the_exact_walls_of_a_slot() -> None:
    walls = part_of(slot_path()).walls
    lower = (walls.targets.x < 19.0) & (walls.targets.y < 20.0)
    assert walls.targets.y[lower] == pytest.approx(15.0, abs=1e-9)
    assert sorted(set(walls.targets.z[lower].round(6))) == pytest.approx([
        -4.0 + 4.0 * level for level in LEVELS
    ])
    assert walls.normal[lower] == pytest.approx(np.tile([0.0, -1.0], (lower.sum(), 1)))


def test_points_stand_for_the_area_of_the_walls() -> None:
    walls = part_of(round_path()).walls
    # Outer and inner wall of the groove: radii 13 and 7 mm, 4 mm deep.
    assert walls.area.sum() == pytest.approx(2.0 * np.pi * (13.0 + 7.0) * 4.0, rel=0.02)


def test_a_path_in_the_air_leaves_no_wall() -> None:
    path = slot_path()
    raised = [each + np.array([0.0, 0.0, 20.0]) for each in path.chords]
    with pytest.raises(ValueError, match="no wall"):
        part_of(
            type(path)(**{
                **{name: getattr(path, name) for name in path.__slots__},
                "chords": tuple(raised),
            })
        )
