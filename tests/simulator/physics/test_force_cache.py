"""Forces looked up by place against forces computed for each of them."""

from math import pi

import numpy as np
import pytest

from simulator.physics import force_cache as known_places
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.force_cache import DIGITS, peak_at, wall_at
from simulator.physics.tooth_forces import Floats, Places, peak_resultant, wall_force

EDGES = CuttingEdges(teeth=3, diameter=8.0, helix_angle=0.5, corner_radius=1.0)
LAW = ForceLaw(exponent=0.75)


def arcs(seed: int, count: int = 60) -> Floats:
    random = np.random.default_rng(seed)
    entry = random.choice([0.0, 0.5, 1.2], count)
    exit_ = np.minimum(entry + random.choice([0.3, 1.0, pi], count), pi)
    return np.stack((entry, exit_, random.choice([0.2, 1.5, 4.0], count)))


def places(of: Floats) -> Places:
    entry, exit_, depth = np.round(of, DIGITS)
    return Places(entry_angle=entry, exit_angle=exit_, axial_depth=depth)


def test_known_and_new_places_have_the_forces_of_the_model() -> None:
    for seed in range(3):
        met = arcs(seed)
        np.testing.assert_array_equal(
            peak_at(EDGES, LAW, met), peak_resultant(EDGES, places(met), LAW)
        )
        np.testing.assert_array_equal(
            wall_at(EDGES, LAW, met), wall_force(EDGES, places(met), LAW)
        )


def test_another_cutter_or_law_has_other_forces() -> None:
    met = arcs(0)
    flat = CuttingEdges(teeth=3, diameter=8.0)
    np.testing.assert_array_equal(
        peak_at(flat, LAW, met), peak_resultant(flat, places(met), LAW)
    )
    hard = ForceLaw(exponent=0.6)
    np.testing.assert_array_equal(
        peak_at(EDGES, hard, met), peak_resultant(EDGES, places(met), hard)
    )


def test_no_more_places_are_kept_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known_places, "KEPT", 5)
    known_places._table.cache_clear()
    for depth in np.arange(1.0, 4.0, 0.1):
        met = np.array([[0.0], [1.0], [depth]])
        np.testing.assert_array_equal(
            peak_at(EDGES, LAW, met), peak_resultant(EDGES, places(met), LAW)
        )
        assert len(known_places._table(peak_resultant, EDGES, LAW).known[0]) <= 5


def test_depths_beyond_a_key_are_computed_at_once() -> None:
    met = np.array([[0.0], [1.0], [3000.0]])
    np.testing.assert_array_equal(
        peak_at(EDGES, LAW, met), peak_resultant(EDGES, places(met), LAW)
    )


def test_no_places_have_no_forces() -> None:
    assert len(wall_at(EDGES, LAW, np.empty((3, 0)))) == 0
