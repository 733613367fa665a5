"""The programmed path of the bracket makes its nominal features."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from service.verification.run import verified
from tests.service.verification.runs import REQUEST, clean, fast_log, program
from tests.simulator.verification.box import box


def test_the_programmed_surface_is_nominal(tmp_path: Path) -> None:
    found = clean(tmp_path)
    is_known = np.isfinite(found.nominal)
    # All but the bottoms of the holes and what no feature describes.
    assert is_known.mean() > 0.95
    assert np.abs(found.nominal[is_known]).max() < 1.1e-3


def test_a_required_part_takes_the_place_of_the_features(tmp_path: Path) -> None:
    path = fast_log().write(tmp_path / "log.parquet", program())
    # The part is 150 mm wide, and its finished face lies at z = 0.
    block = box((-0.1, -3.0, -40.0), (150.0, 93.0, 0.05))
    found = verified(path, replace(program(), required=block), REQUEST)
    places = found.places
    faces = ~places.is_wall & (places.workingstep == 1)
    assert found.nominal[faces] == pytest.approx(-0.05)
    x, y, _ = places.position.T
    left = places.is_wall & (x < 1e-3) & (places.workingstep == 3) & (np.abs(y - 45.0) < 20.0)
    assert left.any()
    assert found.nominal[left] == pytest.approx(-0.1, abs=2e-3)
