"""Text and JSON of a verification."""

import json
from pathlib import Path

import pytest

from service.verification.output import print_verification, verification_json
from tests.service.verification.runs import clean


def test_text_and_json_say_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = clean(tmp_path)
    print_verification(found)
    text = capsys.readouterr().out
    assert "verdict: nothing beyond the uncertainty of the log" in text
    assert "position feedback does not see" in text
    assert "at 10 Hz" in text
    body = json.loads(verification_json(found))
    assert body["verdict"] == "nothing beyond the uncertainty of the log"
    assert not body["has_errors"]
    assert {"gouge_mm", "excess_mm", "gouge_at_mm"} <= set(body["surfaces"][0])
    assert body["resolution"]["square_corner_mm"] == pytest.approx(0.5893, abs=1e-3)
