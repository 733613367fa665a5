from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from optimiser.cuts.path_trial import air_share
from simulator.removal.stations import StationKind


def test_the_share_of_air_is_one_of_time_at_the_programmed_feed() -> None:
    """A move at half the speed counts twice, and one at a feed of its own not at all."""
    run: Any = SimpleNamespace(segments=SimpleNamespace(speed=np.array([10.0, 5.0, 1.0])))
    kinds = np.array([StationKind.MILLING, StationKind.AIR, StationKind.AIR])
    stations = SimpleNamespace(segment=np.array([0, 1, 2]), kind=kinds)
    met: Any = SimpleNamespace(stations=stations, length=np.array([20.0, 5.0, 9.0]))
    assert air_share(run, met, np.array([True, True, False])) == pytest.approx(1.0 / 3.0)
    assert air_share(run, met, np.array([False, False, False])) == 0.0
