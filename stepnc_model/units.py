"""Named conversions at the edges. Inside: mm, s, N, W, rad, rev/s.

``x_from_y`` reads: the canonical x from a number in the unit y. ISO 14649-10 §4.2.1 writes
speeds in m/s, spindles in rev/s and angles in degrees; controls and people speak mm/min and
rpm.
"""

from math import pi

MM_PER_M = 1000.0
SECONDS_PER_MINUTE = 60.0
WATTS_PER_KILOWATT = 1000.0
MM_PER_MICROMETRE = 1e-3
UM_PER_MM = 1000.0
NEWTONS_PER_KILONEWTON = 1000.0
NMM_PER_NM = 1000.0


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
