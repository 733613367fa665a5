"""Text, JSON, page and places of ``verify``."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from extras.verification.verbs.verify.result import VerificationResult
from service.recording.table import headings
from tests.extras.verification.runs import clean


def test_text_and_json_say_the_same(tmp_path: Path) -> None:
    result = VerificationResult(verification=clean(tmp_path))
    text = str(result)
    assert "verdict: nothing beyond the uncertainty of the log" in text
    assert "position feedback does not see" in text
    assert "at 10 Hz" in text
    body = json.loads(json.dumps(result.record()))
    assert body["verdict"] == "nothing beyond the uncertainty of the log"
    assert not body["has_errors"]
    assert {"gouge_mm", "excess_mm", "gouge_at_mm"} <= set(body["surfaces"][0])
    assert body["resolution"]["square_corner_mm"] == pytest.approx(0.5893 + 0.001, abs=1e-3)


def test_no_number_is_a_negative_zero(tmp_path: Path) -> None:
    whole = clean(tmp_path)
    found = replace(whole, nominal=np.where(np.isfinite(whole.nominal), -1e-6, np.nan))
    page = VerificationResult(verification=found).page()
    assert "+0.0000 to +0.0000" in page
    assert "-0.0000" not in page


def test_the_page_has_both_pictures_and_loads_nothing(tmp_path: Path) -> None:
    page = VerificationResult(verification=clean(tmp_path)).page()
    assert 'id="plan"' in page
    assert 'id="space"' in page
    assert "nothing beyond the uncertainty of the log" in page
    assert "<script src=" not in page


def test_places_are_written_with_their_units(tmp_path: Path) -> None:
    found = clean(tmp_path)
    count = VerificationResult(verification=found).write_places(tmp_path / "places.csv")
    assert count == int(found.places.is_wall.sum())
    names = headings(tmp_path / "places.csv")
    assert names[:5] == ["x_mm", "y_mm", "z_mm", "deviation_mm", "uncertainty_mm"]
