"""Unit conversions between the internal units mm, s, N, W, rad, rev/s and those of files.

``x_from_y`` returns the canonical x from a number in the unit y. ISO 14649-10 §4.2.1 writes
speeds in m/s, spindle speeds in rev/s and angles in degrees; controls and people use mm/min
and rpm.

A :class:`UnitProfile` gives the units in which a program writes its feeds and speeds. ISO
14649-10 §4.2.1 prescribes m/s for speeds and rev/s for spindles when the file names no unit.
Many public files use other units, so another profile is chosen by the user, or by
:mod:`stepnc_model.programs.plausibility` where it is the only one that makes all numbers
plausible.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import pi

MM_PER_M = 1000.0
SECONDS_PER_MINUTE = 60.0
SECONDS_PER_HOUR = 3600.0
MS_PER_SECOND = 1000.0
WATTS_PER_KILOWATT = 1000.0
MM_PER_MICROMETRE = 1e-3
MM_PER_INCH = 25.4
UM_PER_MM = 1000.0
NEWTONS_PER_KILONEWTON = 1000.0
NMM_PER_NM = 1000.0
NMM_S_PER_WATT = 1000.0
MM_PER_FOOT = 304.8
US_PER_SECOND = 1_000_000
SECONDS_PER_DAY = 86_400.0


def seconds_from_hours(value: float) -> float:
    """Time in s from h."""
    return value * SECONDS_PER_HOUR


def hours_from_seconds(time: float) -> float:
    """Time in h from s."""
    return time / SECONDS_PER_HOUR


def seconds_from_minutes(value: float) -> float:
    """Time in s from min."""
    return value * SECONDS_PER_MINUTE


def ms_from_seconds(time: float) -> float:
    """Time in ms from s."""
    return time * MS_PER_SECOND


def rev_s_from_rad_s(value: float) -> float:
    """Speed in rev/s from rad/s."""
    return value / (2.0 * pi)


def rad_s_from_rev_s(value: float) -> float:
    """Speed in rad/s from rev/s."""
    return value * (2.0 * pi)


def kj_from_joules(energy: float) -> float:
    """Energy in kJ from J."""
    return energy / WATTS_PER_KILOWATT


def kwh_from_joules(energy: float) -> float:
    """Energy in kWh from J."""
    return energy / (WATTS_PER_KILOWATT * SECONDS_PER_HOUR)


def seconds_from_ms(value: float) -> float:
    """Time in s from ms."""
    return value / MS_PER_SECOND


def speed_from_m_s(value: float) -> float:
    """Speed in mm/s from m/s (Part 21)."""
    return value * MM_PER_M


def m_s_from_speed(speed: float) -> float:
    """Speed in m/s (Part 21) from mm/s."""
    return speed / MM_PER_M


def speed_from_mm_min(value: float) -> float:
    """Speed in mm/s from mm/min."""
    return value / SECONDS_PER_MINUTE


def mm_min_from_speed(speed: float) -> float:
    """Speed in mm/min from mm/s."""
    return speed * SECONDS_PER_MINUTE


def speed_from_m_min(value: float) -> float:
    """Speed in mm/s from m/min."""
    return value * MM_PER_M / SECONDS_PER_MINUTE


def m_min_from_speed(speed: float) -> float:
    """Speed in m/min from mm/s."""
    return speed * SECONDS_PER_MINUTE / MM_PER_M


def rev_s_from_rpm(value: float) -> float:
    """Spindle speed in rev/s from rpm."""
    return value / SECONDS_PER_MINUTE


def rpm_from_rev_s(speed: float) -> float:
    """Spindle speed in rpm from rev/s."""
    return speed * SECONDS_PER_MINUTE


def watts_from_kw(value: float) -> float:
    """Power in W from kW."""
    return value * WATTS_PER_KILOWATT


def kw_from_watts(power: float) -> float:
    """Power in kW from W."""
    return power / WATTS_PER_KILOWATT


def newtons_from_kn(value: float) -> float:
    """Force in N from kN."""
    return value * NEWTONS_PER_KILONEWTON


def kn_from_newtons(force: float) -> float:
    """Force in kN from N."""
    return force / NEWTONS_PER_KILONEWTON


def nmm_from_nm(value: float) -> float:
    """Torque in N·mm from N·m."""
    return value * NMM_PER_NM


def nm_from_nmm(torque: float) -> float:
    """Torque in N·m from N·mm."""
    return torque / NMM_PER_NM


def mm_from_um(value: float) -> float:
    """Length in mm from µm."""
    return value * MM_PER_MICROMETRE


def um_from_mm(length: float) -> float:
    """Length in µm from mm."""
    return length / MM_PER_MICROMETRE


def mm_from_inches(length: float) -> float:
    """Length in mm from inches."""
    return length * MM_PER_INCH


def inches_from_mm(length: float) -> float:
    """Length in inches from mm."""
    return length / MM_PER_INCH


def n_mm_from_n_um(value: float) -> float:
    """Stiffness in N/mm from N/µm."""
    return value * UM_PER_MM


def n_um_from_n_mm(stiffness: float) -> float:
    """Stiffness in N/µm from N/mm."""
    return stiffness / UM_PER_MM


def rad_from_deg(value: float) -> float:
    """Angle in rad from degrees."""
    return value * pi / 180.0


def deg_from_rad(angle: float) -> float:
    """Angle in degrees from rad."""
    return angle * 180.0 / pi


class FeedUnit(StrEnum):
    """Unit of the attribute ``feedrate`` in a file."""

    METRES_PER_SECOND = "m/s"
    MM_PER_MINUTE = "mm/min"
    MM_PER_TOOTH = "mm/tooth"
    MM_PER_REVOLUTION = "mm/rev"


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitProfile:
    """Units of the feeds and speeds of one program."""

    name: str
    feed: FeedUnit
    """Unit of ``feedrate``, of drilling too unless ``drilling_feed`` gives another."""
    cutting_speed: float
    """Factor from the file's ``cutspeed`` to mm/s."""
    cutting_speed_unit: str
    spindle: float
    """Factor from the file's ``spindle`` to rev/s."""
    spindle_unit: str
    drilling_feed: FeedUnit | None = None
    """Unit of ``feedrate`` in drilling, boring and reaming; None for that of ``feed``."""

    def for_drilling(self) -> "UnitProfile":
        """Units of the feeds and speeds of drilling operations."""
        if self.drilling_feed is None:
            return self
        return replace(self, feed=self.drilling_feed, drilling_feed=None)

    @property
    def feed_scale(self) -> float:
        """Factor from the file's ``feedrate`` to mm/s, or to mm per tooth or revolution."""
        return {
            FeedUnit.METRES_PER_SECOND: MM_PER_M,
            FeedUnit.MM_PER_MINUTE: 1.0 / SECONDS_PER_MINUTE,
            FeedUnit.MM_PER_TOOTH: 1.0,
            FeedUnit.MM_PER_REVOLUTION: 1.0,
        }[self.feed]


def _profile(
    name: str, feed: FeedUnit, *, rpm: bool, drilling: FeedUnit | None = None
) -> UnitProfile:
    """Unit profile with cutting speeds in m/min, as in shop-floor files."""
    return UnitProfile(
        name=name,
        feed=feed,
        cutting_speed=MM_PER_M / SECONDS_PER_MINUTE,
        cutting_speed_unit="m/min",
        spindle=1.0 / SECONDS_PER_MINUTE if rpm else 1.0,
        spindle_unit="rpm" if rpm else "rev/s",
        drilling_feed=drilling,
    )


_PER_TOOTH, _PER_TURN = FeedUnit.MM_PER_TOOTH, FeedUnit.MM_PER_REVOLUTION


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
        _profile("rpm-mmtooth-mmrev", _PER_TOOTH, rpm=True, drilling=_PER_TURN),
        _profile("revs-mmtooth-mmrev", _PER_TOOTH, rpm=False, drilling=_PER_TURN),
    )
}
"""Unit profiles by name; ``mmtooth-mmrev`` is per tooth in milling, per turn in drilling."""

AUTO = "auto"
"""Name that stands for the only profile that makes all numbers of a file plausible."""
