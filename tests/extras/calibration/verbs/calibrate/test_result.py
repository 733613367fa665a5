"""The table of a calibration names what was found, and leaves empty what is not a number."""

import re

import pytest

from extras.calibration.verbs.calibrate.result import CalibrationResult


@pytest.fixture
def shown(calibration: CalibrationResult) -> str:
    return str(calibration)


def test_values_come_with_unit_and_interval(shown: str) -> None:
    assert re.search(r"^base power +1200 W +1190 to 1210 +yes$", shown, re.MULTILINE)


def test_what_is_not_identified_says_why(shown: str) -> None:
    assert re.search(r"^factor on .* +1 kept +no: nothing was cut$", shown, re.MULTILINE)
    assert "no: no spindle or total power" in shown


def test_times_and_errors_stand_side_by_side(shown: str) -> None:
    assert re.search(r"^run +100\.0 +101\.0 +\+1\.00%$", shown, re.MULTILINE)
    spindle = r"^run +c_axis_wattage +2\.0 +4\.0 +\+1\.00% +\+10\.00% +0\.90 +\+3\.0%$"
    assert re.search(spindle, shown, re.MULTILINE)


def test_shares_of_nothing_stay_empty(shown: str) -> None:
    assert re.search(r"^run +coolant_wattage +2\.0 +4\.0 *$", shown, re.MULTILINE)
    assert re.search(
        r"^run +electric_wattage +2\.0 +4\.0 +not measurable$", shown, re.MULTILINE
    )
    assert not re.search(r"\b(nan|inf)\b", shown)


def test_findings_come_last(shown: str) -> None:
    assert shown.rstrip().endswith("gap of 2 s")
