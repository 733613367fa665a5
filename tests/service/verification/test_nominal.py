"""The programmed path of the bracket makes its nominal features."""

from pathlib import Path

import numpy as np

from tests.service.verification.runs import clean


def test_the_programmed_surface_is_nominal(tmp_path: Path) -> None:
    found = clean(tmp_path)
    is_known = np.isfinite(found.nominal)
    # All but the bottoms of the holes and what no feature describes.
    assert is_known.mean() > 0.95
    assert np.abs(found.nominal[is_known]).max() < 1.1e-3
