"""The march along a path: where its stations lie."""

import numpy as np
import pytest

from simulator.motion.segments import lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.rim import FORGETTING
from simulator.removal.stations import StationKind
from simulator.removal.trial import rows_of
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -12.0), high=(60.0, 40.0, 0.0))


def test_rows_hold_the_path() -> None:
    path = lines([(0.0, 0.0, 0.0), (3.0, 4.0, 5.0)], speed=1.0)
    assert rows_of(path)[0] == pytest.approx([0, 0, 0, 3, 4, 5, 0, 0, 0, 0, 0, 0, 2])


def test_stations_ascend_and_end_with_their_segment() -> None:
    path = lines(
        [(-8.0, 20.0, 5.0), (-8.0, 20.0, -2.0), (68.0, 20.0, -2.0), (68.0, 20.0, -2.0)],
        speed=1.0,
    )
    found = MillingStock(BOX, cell=0.2).cut(path, Cutter(diameter=10.0))
    last = np.flatnonzero(np.diff(found.segment, append=99))
    assert found.station[last] == pytest.approx(path.length)
    same = np.diff(found.segment) == 0
    assert (np.diff(found.station)[same] > 0.0).all()
    assert found.kind[[0, -1]].tolist() == [StationKind.AIR, StationKind.AIR]
    # Between the ends of the slot the stations lie a quarter of the radius apart at most, and
    # closer where the tool enters.
    steps = np.diff(found.station[found.segment == 1])
    assert steps[1:-1].max() <= 1.25 + 1e-9
    assert steps[:8].min() < 0.5


def test_long_programs_are_taken_in_pieces() -> None:
    angle = np.linspace(0.0, 60.0, 20_001)
    points = np.column_stack([
        30.0 + 0.3 * angle * np.cos(angle),
        20.0 + 0.3 * angle * np.sin(angle),
        0 * angle - 1,
    ])
    work = MillingStock(BOX, cell=0.5)
    found = work.cut(lines(list(points), speed=1.0), Cutter(diameter=10.0))
    assert np.unique(found.segment).tolist() == list(range(20_000))


def test_exact_stations_stay_exact_where_others_of_their_move_are_not() -> None:
    """Beside a slot whose first half is forgotten: that holds what is left of the volume."""
    work, flat = MillingStock(BOX, cell=0.5), Cutter(diameter=10.0)
    work.cut(lines([(-8.0, 20.0, -2.0), (30.0, 20.0, -2.0)], speed=1.0), flat)
    work._past.next[0] += FORGETTING
    work.cut(lines([(30.0, 20.0, -2.0), (68.0, 20.0, -2.0)], speed=1.0), flat)
    before = work.volume
    found = work.cut(lines([(-8.0, 24.0, -2.0), (68.0, 24.0, -2.0)], speed=1.0), flat)
    remembered = (found.station > 52.0) & (found.station < 60.0)
    assert found.section[remembered] == pytest.approx(8.0, rel=1e-6)
    forgotten = (found.station > 20.0) & (found.station < 34.0)
    assert np.abs(found.section[forgotten] / 8.0 - 1.0).max() > 1e-4
    assert found.section[forgotten] == pytest.approx(8.0, rel=0.1)
    cut = float((found.section * np.diff(found.station, prepend=0.0)).sum())
    assert cut == pytest.approx(work.volume - before)
