import pytest

from simulator.physics import cutting
from simulator.physics.cutting import ForceCorrection
from simulator.spec import CuttingMaterial, Kienzle
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)


def test_specific_force_is_the_main_value_at_one_millimetre() -> None:
    assert cutting.specific_cutting_force(1.0, k_c11=1780.0, m_c=0.17) == 1780.0


def test_zero_exponent_keeps_the_specific_force_constant() -> None:
    thin = cutting.specific_cutting_force(0.01, k_c11=1000.0, m_c=0.0)
    assert thin == cutting.specific_cutting_force(0.5, k_c11=1000.0, m_c=0.0) == 1000.0


def test_twice_the_width_is_twice_the_force() -> None:
    one = cutting.chip_force(STEEL, chip_thickness=0.1, chip_width=1.0)
    two = cutting.chip_force(STEEL, chip_thickness=0.1, chip_width=2.0)
    assert two == pytest.approx(2.0 * one)


def test_twice_the_thickness_is_less_than_twice_the_force() -> None:
    one = cutting.chip_force(STEEL, chip_thickness=0.1, chip_width=1.0)
    two = cutting.chip_force(STEEL, chip_thickness=0.2, chip_width=1.0)
    assert two == pytest.approx(2.0**0.78 * one)


def test_a_degree_of_rake_is_a_per_cent_of_force() -> None:
    more = cutting.rake_factor(rad_from_deg(7.0), rad_from_deg(6.0))
    assert more == pytest.approx(0.99)
    negative = cutting.rake_factor(rad_from_deg(-6.0), rad_from_deg(6.0))
    assert negative == pytest.approx(1.12)


def test_rake_that_leaves_no_force_is_refused() -> None:
    with pytest.raises(ValueError, match="rake factor"):
        cutting.rake_factor(rad_from_deg(60.0), rad_from_deg(-45.0))


def test_hss_needs_a_fifth_more_force_than_carbide() -> None:
    assert cutting.speed_factor(CuttingMaterial.HSS) == 1.2
    assert cutting.speed_factor(CuttingMaterial.CARBIDE) == 1.0


def test_every_cutting_material_has_a_speed_factor() -> None:
    assert set(cutting.SPEED_FACTORS) == set(CuttingMaterial)


def test_corrections_multiply() -> None:
    correction = ForceCorrection(rake=0.94, speed=1.2)
    assert correction.factor == pytest.approx(0.94 * 1.2)
    assert ForceCorrection().factor == 1.0


def test_correction_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="speed factor 0"):
        ForceCorrection(speed=0.0)


def test_factor_scales_the_force() -> None:
    usual = cutting.chip_force(STEEL, chip_thickness=0.1, chip_width=1.0)
    harder = cutting.chip_force(STEEL, chip_thickness=0.1, chip_width=1.0, factor=1.3)
    assert harder == pytest.approx(1.3 * usual)


@every_case("exponent", [-0.1, 1.0, float("nan")])
def test_exponent_outside_its_range_is_refused(exponent: float) -> None:
    with pytest.raises(ValueError, match="at least 0 and less than 1"):
        cutting.specific_cutting_force(0.1, k_c11=1500.0, m_c=exponent)
