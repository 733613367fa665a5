"""Conversions by numbers that anyone can check, and back without loss."""

from collections.abc import Callable
from math import isclose, pi

import pytest

from stepnc_model import units
from tests.every_case import every_case

Conversion = Callable[[float], float]

PAIRS: list[tuple[Conversion, Conversion]] = [
    (units.speed_from_m_s, units.m_s_from_speed),
    (units.speed_from_mm_min, units.mm_min_from_speed),
    (units.speed_from_m_min, units.m_min_from_speed),
    (units.rev_s_from_rpm, units.rpm_from_rev_s),
    (units.watts_from_kw, units.kw_from_watts),
    (units.nmm_from_nm, units.nm_from_nmm),
    (units.mm_from_um, units.um_from_mm),
    (units.n_mm_from_n_um, units.n_um_from_n_mm),
    (units.rad_from_deg, units.deg_from_rad),
]


@every_case(
    ("conversion", "number", "canonical"),
    [
        (units.speed_from_m_s, 0.04, 40.0),
        (units.speed_from_mm_min, 2400.0, 40.0),
        (units.speed_from_m_min, 35.0, 583.333333333333),
        (units.rev_s_from_rpm, 12_000.0, 200.0),
        (units.watts_from_kw, 7.5, 7500.0),
        (units.nmm_from_nm, 2.5, 2500.0),
        (units.mm_from_um, 1.6, 0.0016),
        (units.n_mm_from_n_um, 12.5, 12_500.0),
        (units.rad_from_deg, 180.0, pi),
    ],
)
def test_a_number_becomes_canonical(
    conversion: Conversion, number: float, canonical: float
) -> None:
    assert conversion(number) == pytest.approx(canonical, rel=1e-12)


@every_case(("there", "back"), PAIRS)
@every_case("number", [0.0, 1e-9, 0.1, 1.0, 1234.5, 1e9, -12.0])
def test_there_and_back_is_the_same(there: Conversion, back: Conversion, number: float) -> None:
    assert isclose(back(there(number)), number, rel_tol=1e-15, abs_tol=0.0)


def test_metres_per_second_are_sixty_thousand_mm_per_minute() -> None:
    assert units.mm_min_from_speed(units.speed_from_m_s(1.0)) == 60_000.0
