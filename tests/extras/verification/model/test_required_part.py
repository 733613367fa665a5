"""Logs are compared with a required part alone: a pocket in a block."""

import numpy as np
import pytest

from extras.verification.model.deviation import SurfacePlaces
from extras.verification.model.logged_part import LoggedPart
from extras.verification.model.required_part import required_part, required_places
from simulator.motion.segments import Floats
from simulator.removal.cutter import Cutter
from simulator.removal.mesh_stock import edges_of
from stepnc_model.programs.program import Stock
from tests.extras.verification.model.block import sampled, samples_at
from tests.extras.verification.model.box import box
from tests.extras.verification.model.meshes import pocketed_block

STOCK = Stock(low=(0.0, 0.0, -12.0), high=(40.0, 30.0, 0.0))
MESH = pocketed_block(STOCK.low, STOCK.high, half=(12.0, 8.0), radius=3.0, depth=5.0)
PART = required_part(MESH, STOCK, cell=0.2)
CUTTER = Cutter(diameter=6.0)


def pocket_way() -> tuple[tuple[float, float, float], ...]:
    """The centre of a cutter of 6 mm that clears the pocket in rings."""
    points = [(20.0, 15.0, 5.0), (20.0, 15.0, -5.0)]
    for x, y in ((4.0, 1.0), (6.5, 3.0), (9.0, 5.0)):
        ring = [
            (20.0 + a * x, 15.0 + b * y, -5.0) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        ]
        points += [*ring, ring[0]]
    return (*points, (29.0, 20.0, 5.0))


def places_of(points: Floats) -> SurfacePlaces:
    left = LoggedPart(PART, STOCK, {1: CUTTER})
    left.add(samples_at(points))
    return required_places(PART, left)


def test_walls_lie_on_the_mesh_and_have_its_area() -> None:
    x, y = np.abs(PART.targets.x - 20.0), np.abs(PART.targets.y - 15.0)
    is_straight = (x < 8.0) | (y < 4.0)
    away = np.minimum(np.abs(x - 12.0), np.abs(y - 8.0))
    assert np.abs(away[is_straight]).max() < 1e-6
    around = 2.0 * (24.0 + 16.0) - (8.0 - 2.0 * np.pi) * 3.0
    assert PART.area.sum() == pytest.approx(5.0 * around, rel=0.01)
    assert set(np.round(PART.targets.z, 6)) == {-0.5, -2.5, -4.5}


def test_a_log_without_errors_stays_within_its_uncertainty() -> None:
    for step in (0.04, 0.4371, 1.31):
        assert not places_of(sampled(pocket_way(), step)).is_beyond.any()


@pytest.mark.parametrize("size", [0.15, 0.0254])
def test_an_offset_is_a_gouge_on_one_side_and_an_excess_on_the_other(size: float) -> None:
    places = places_of(sampled(pocket_way(), 0.0417) + np.array([size, 0.0, 0.0]))
    walls = places[places.is_wall & (np.abs(places.position[:, 1] - 15.0) < 4.0)]
    right = walls[walls.position[:, 0] > 25.0]
    left = walls[walls.position[:, 0] < 15.0]
    assert right.deviation == pytest.approx(-size, abs=1e-3)
    assert left.deviation == pytest.approx(size, abs=1e-3)
    assert right.is_beyond.all()


def test_an_offset_in_height_is_found_on_the_floor() -> None:
    places = places_of(sampled(pocket_way(), 0.0417) - np.array([0.0, 0.0, 0.0254]))
    floor = places[~places.is_wall & (places.position[:, 2] == -5.0)]
    assert floor.deviation == pytest.approx(-0.0254, abs=1e-6)
    assert floor.is_beyond.mean() > 0.99


def test_what_is_not_cut_belongs_to_no_tool() -> None:
    places = places_of(sampled(((20.0, 15.0, 5.0), (20.0, 15.0, -5.0)), 0.04))
    walls = places[places.is_wall]
    assert (walls.deviation[walls.workingstep == -1] == 5.0).all()
    assert (walls.workingstep == -1).any()


def test_a_part_without_walls_is_refused() -> None:
    with pytest.raises(ValueError, match="no wall within the stock"):
        required_part(MESH - np.array([0.0, 0.0, 11.9]), STOCK, cell=0.5)


def test_open_and_turned_triangles_are_counted() -> None:
    assert (edges_of(MESH).open, edges_of(MESH).unlike) == (0, 0)
    assert edges_of(MESH[1:]).open == 3
    turned = MESH.copy()
    turned[0] = turned[0][::-1]
    assert edges_of(turned).unlike == 3


HALF_CAST = np.concatenate([
    box(low, high)
    for low, high in (
        ((0.0, 0.0, -12.0), (8.0, 30.0, 0.0)),
        ((8.0, 0.0, -12.0), (20.0, 7.0, 0.0)),
        ((8.0, 23.0, -12.0), (20.0, 30.0, 0.0)),
        ((8.0, 7.0, -12.0), (20.0, 23.0, -5.0)),
        ((20.0, 0.0, -12.0), (40.0, 30.0, 0.0)),
    )
])
"""The block, in which the left half of the pocket is cast, with sharp corners."""


def test_walls_of_the_raw_part_are_not_compared() -> None:
    whole = required_part(MESH, STOCK, cell=0.2)
    part = required_part(MESH, STOCK, cell=0.2, raw=HALF_CAST)
    assert part.targets.x.min() > 19.5
    assert np.count_nonzero(whole.targets.x > 20.5) == np.count_nonzero(part.targets.x > 20.5)
    # What stands in the corners of the required part is not there in the raw one.
    missing = 2.0 * (1.0 - np.pi / 4.0) * 9.0 * 5.0
    assert whole.map.volume - part.map.volume == pytest.approx(missing, rel=0.05)
    left = LoggedPart(part, STOCK, {1: CUTTER}, raw=HALF_CAST)
    assert left.raw_volume - part.map.volume == pytest.approx(
        12.0 * 16.0 * 5.0 - 0.5 * (4.0 - np.pi) * 9.0 * 5.0, rel=0.01
    )
    with pytest.raises(ValueError, match="no wall within the stock"):
        required_part(MESH, STOCK, cell=0.2, raw=MESH)
