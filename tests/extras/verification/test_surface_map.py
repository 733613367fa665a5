"""A map shows the worst places and others evenly spread, and counts what it leaves out."""

from pathlib import Path

import numpy as np

from extras.verification.facts import read_map, shown_rows, write_surface
from simulator.motion.segments import Floats
from tests.extras.verification.runs import clean

SIDE = 100


def plate() -> Floats:
    """A plate of places, 1 mm apart."""
    x, y = np.meshgrid(np.arange(SIDE, dtype=np.float64), np.arange(SIDE, dtype=np.float64))
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(SIDE**2)])


def test_the_worst_are_shown_and_the_rest_evenly() -> None:
    position, beyond = plate(), np.full(SIDE**2, -0.001)
    wrong = np.arange(5000, 5020)
    beyond[wrong] = np.linspace(0.1, 0.2, len(wrong))
    rows = shown_rows(position, beyond, most=500)
    assert set(wrong) <= set(rows.tolist())
    assert 150 < len(rows) <= 500
    for begin in range(0, SIDE, 25):
        strip = (position[rows, 0] >= begin) & (position[rows, 0] < begin + 25)
        assert strip.sum() > 30


def test_of_many_errors_half_of_the_places_are_the_worst() -> None:
    position, beyond = plate(), np.linspace(0.0, 1.0, SIDE**2)
    rows = shown_rows(position, beyond, most=400)
    assert set(range(SIDE**2 - 200, SIDE**2)) <= set(rows.tolist())
    assert rows.min() < SIDE * 20


def test_few_places_are_all_shown() -> None:
    assert len(shown_rows(plate(), np.zeros(SIDE**2), most=SIDE**2)) == SIDE**2


def test_a_map_is_that_of_the_verification(tmp_path: Path) -> None:
    found = clean(tmp_path)
    write_surface(tmp_path / "surface.parquet", found)
    whole = read_map(tmp_path / "surface.parquet", most=10_000_000)
    assert (whole.left_out, whole.left_out_beyond) == (0, 0.0)
    assert len(whole.columns["block"]) == len(found.places)
    assert np.allclose(whole.columns["deviation_mm"], found.places.deviation, atol=1e-4)
    assert set(whole.kinds) == {"wall", "floor"}
    names = [whole.workingsteps[row] for row in whole.columns["workingstep"].tolist()]
    steps = found.places.workingstep.tolist()
    assert names == [found.steps[row].workingstep if row >= 0 else "raw part" for row in steps]
    some = read_map(tmp_path / "surface.parquet", most=500)
    assert len(some.columns["block"]) + some.left_out == len(found.places)
    assert len(some.columns["block"]) <= 500


def test_a_profile_is_shown_as_densely_as_a_surface() -> None:
    along = np.linspace(-100.0, 0.0, 10_000)
    position = np.column_stack([np.full(10_000, 20.0), np.zeros(10_000), along])
    rows = shown_rows(position, np.full(10_000, -0.001), most=1000)
    assert 600 < len(rows) <= 1000
    assert np.diff(position[rows, 2]).max() < 0.5
