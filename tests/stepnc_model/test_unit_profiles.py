"""A program's units: the standard's by default, others by their name."""

import pytest

from stepnc_model.units import ISO, PROFILES, FeedUnit
from tests.every_case import every_case


def test_the_standard_writes_metres_per_second_and_revolutions_per_second() -> None:
    assert (ISO.feed, ISO.feed_scale) == (FeedUnit.METRES_PER_SECOND, 1000.0)
    assert (ISO.cutting_speed, ISO.spindle) == (1000.0, 1.0)
    assert (ISO.cutting_speed_unit, ISO.spindle_unit) == ("m/s", "rev/s")


def test_the_standard_comes_first() -> None:
    assert next(iter(PROFILES.values())) is ISO


@every_case(
    ("name", "feed", "spindle_unit"),
    [
        ("iso", FeedUnit.METRES_PER_SECOND, "rev/s"),
        ("rpm-mmin", FeedUnit.MM_PER_MINUTE, "rpm"),
        ("rpm-mmtooth", FeedUnit.MM_PER_TOOTH, "rpm"),
        ("rpm-mmrev", FeedUnit.MM_PER_REVOLUTION, "rpm"),
        ("revs-mmtooth", FeedUnit.MM_PER_TOOTH, "rev/s"),
        ("revs-mmrev", FeedUnit.MM_PER_REVOLUTION, "rev/s"),
    ],
)
def test_the_name_says_spindle_and_feed(name: str, feed: FeedUnit, spindle_unit: str) -> None:
    profile = PROFILES[name]
    assert (profile.name, profile.feed, profile.spindle_unit) == (name, feed, spindle_unit)


def test_eight_profiles_are_known() -> None:
    assert len(PROFILES) == 8


@every_case("name", [name for name in PROFILES if name != "iso"])
def test_shop_floor_files_write_cutting_speeds_in_metres_per_minute(name: str) -> None:
    profile = PROFILES[name]
    assert profile.cutting_speed_unit == "m/min"
    assert profile.cutting_speed * 60.0 == pytest.approx(1000.0)


@every_case("name", PROFILES)
def test_a_thousand_units_of_the_spindle(name: str) -> None:
    profile = PROFILES[name]
    rev_s = 1000.0 if profile.spindle_unit == "rev/s" else 1000.0 / 60.0
    assert 1000.0 * profile.spindle == pytest.approx(rev_s)


@every_case(
    ("name", "canonical"),
    [
        ("iso", 2_400_000.0),
        ("rpm-mmin", 40.0),
        ("rpm-mmtooth", 2400.0),
        ("rpm-mmrev", 2400.0),
        ("revs-mmtooth", 2400.0),
        ("revs-mmrev", 2400.0),
    ],
)
def test_a_feed_of_2400(name: str, canonical: float) -> None:
    assert 2400.0 * PROFILES[name].feed_scale == pytest.approx(canonical)
