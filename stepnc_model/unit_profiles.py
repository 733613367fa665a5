"""In which units a program writes its feeds and speeds.

ISO 14649-10 §4.2.1 says m/s for speeds and rev/s for spindles when the file names no unit.
Many public files write something else, and what they mean cannot be told from the numbers
alone, so another profile is chosen by the user and never guessed.
"""

from dataclasses import dataclass
from enum import StrEnum

from stepnc_model.units import MM_PER_M, SECONDS_PER_MINUTE


class FeedUnit(StrEnum):
    """What a number in ``feedrate`` means."""

    METRES_PER_SECOND = "m/s"
    MM_PER_MINUTE = "mm/min"
    MM_PER_TOOTH = "mm/tooth"
    MM_PER_REVOLUTION = "mm/rev"


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitProfile:
    """Units of one program."""

    name: str
    feed: FeedUnit
    cutting_speed: float
    """mm/s per unit of ``cutspeed``"""
    cutting_speed_unit: str
    spindle: float
    """rev/s per unit of ``spindle``"""
    spindle_unit: str

    @property
    def feed_scale(self) -> float:
        """Canonical number (mm/s, or mm per tooth or revolution) per unit of ``feedrate``."""
        return {
            FeedUnit.METRES_PER_SECOND: MM_PER_M,
            FeedUnit.MM_PER_MINUTE: 1.0 / SECONDS_PER_MINUTE,
            FeedUnit.MM_PER_TOOTH: 1.0,
            FeedUnit.MM_PER_REVOLUTION: 1.0,
        }[self.feed]


def _profile(name: str, feed: FeedUnit, *, rpm: bool) -> UnitProfile:
    """A profile with m/min cutting speeds, as shop-floor files have them."""
    return UnitProfile(
        name=name,
        feed=feed,
        cutting_speed=MM_PER_M / SECONDS_PER_MINUTE,
        cutting_speed_unit="m/min",
        spindle=1.0 / SECONDS_PER_MINUTE if rpm else 1.0,
        spindle_unit="rpm" if rpm else "rev/s",
    )


ISO = UnitProfile(
    name="iso",
    feed=FeedUnit.METRES_PER_SECOND,
    cutting_speed=MM_PER_M,
    cutting_speed_unit="m/s",
    spindle=1.0,
    spindle_unit="rev/s",
)

PROFILES = {
    profile.name: profile
    for profile in (
        ISO,
        _profile("rpm-mmin", FeedUnit.MM_PER_MINUTE, rpm=True),
        _profile("rpm-mmtooth", FeedUnit.MM_PER_TOOTH, rpm=True),
        _profile("rpm-mmrev", FeedUnit.MM_PER_REVOLUTION, rpm=True),
        _profile("revs-mmtooth", FeedUnit.MM_PER_TOOTH, rpm=False),
        _profile("revs-mmrev", FeedUnit.MM_PER_REVOLUTION, rpm=False),
    )
}
