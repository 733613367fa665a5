"""Rows, bands and resolution of a verification."""

from pathlib import Path

import pytest

from extras.verification.facts import (
    BANDS,
    log_resolution,
    surface_deviations,
    tolerance_bands,
)
from tests.extras.verification.runs import clean


def test_facts_of_a_log_without_errors(tmp_path: Path) -> None:
    found = clean(tmp_path)
    rows = list(surface_deviations(found))
    assert ("FINISH POCKET", "POCKET") in {(row.workingstep, row.feature) for row in rows}
    assert not any(row.beyond for row in rows)
    bands = tolerance_bands(found)
    assert [band.width for band in bands] == list(BANDS)
    assert [band.share for band in bands] == sorted(band.share for band in bands)
    can = log_resolution(found)
    # 1000 mm/min at 10 Hz: 1.667 mm; 0.589 mm at square corners, and a micrometre.
    assert can.step == pytest.approx(1000.0 / 60.0 / 10.0, rel=1e-3)
    assert can.corner == pytest.approx(0.5893 + 0.001, abs=1e-3)
    assert can.straight == pytest.approx(0.001)
