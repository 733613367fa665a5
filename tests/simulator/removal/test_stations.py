"""Stations of a path."""

from dataclasses import replace

import numpy as np
import pytest

from simulator.removal.stations import CutKind, air, merged


def test_air_removes_nothing() -> None:
    found = air(np.array([0, 1]), np.array([2.0, 3.0]))
    assert found.kind.tolist() == [CutKind.AIR, CutKind.AIR]
    assert found.section.tolist() == [0.0, 0.0]


def test_runs_merge_in_order() -> None:
    parts = [air(np.array([1, 3]), np.array([5.0, 2.0])), air(np.array([0, 1]), np.ones(2))]
    found = merged(parts)
    assert found.segment.tolist() == [0, 1, 1, 3]
    assert found.station.tolist() == [1.0, 1.0, 5.0, 2.0]


def test_columns_are_equally_long() -> None:
    found = air(np.array([0]), np.array([1.0]))
    with pytest.raises(ValueError, match="section"):
        replace(found, section=np.zeros(2))
