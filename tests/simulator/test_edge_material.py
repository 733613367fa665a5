"""What an edge is made of, and its factor on the force."""

from dataclasses import replace

import pytest

from simulator.library import find_grade, load_material
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_kind import correction_of, edge_material
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case


@every_case(
    ("texts", "material"),
    [
        (["Carbide P25"], CuttingMaterial.CARBIDE),
        (["VHM", "Hartmetall K10"], CuttingMaterial.CARBIDE),
        (["METAL DURO"], CuttingMaterial.CARBIDE),
        (["HSS-Co8"], CuttingMaterial.HSS),
        (["high-speed steel"], CuttingMaterial.HSS),
        (["", "oxide ceramic"], CuttingMaterial.CERAMIC),
        (["END MILL 10"], None),
        ([], None),
    ],
)
def test_edge_material_by_its_words(texts: list[str], material: CuttingMaterial | None) -> None:
    assert edge_material(texts) is material


def test_high_speed_steel_cuts_with_a_fifth_more_force() -> None:
    """Tschätsch: K_v 1.2 for HSS, 1.0 for carbide."""
    steel = load_material("c45")
    for material, factor in ((CuttingMaterial.HSS, 1.2), (CuttingMaterial.CARBIDE, 1.0)):
        grade = find_grade(ToolKind.ENDMILL, material, "P")
        assert correction_of(steel, grade, material).speed == factor


def test_one_degree_more_rake_is_one_per_cent_less_force() -> None:
    steel = load_material("c45")
    grade = find_grade(ToolKind.ENDMILL, CuttingMaterial.CARBIDE, "P")
    steel = replace(steel, kienzle=replace(steel.kienzle, rake_angle=rad_from_deg(6.0)))
    grade = replace(grade, rake_angle=rad_from_deg(10.0))
    assert correction_of(steel, grade, CuttingMaterial.CARBIDE).rake == pytest.approx(0.96)


def test_without_a_grade_or_a_reference_nothing_is_corrected() -> None:
    steel = load_material("c45")
    assert correction_of(steel, None, CuttingMaterial.HSS).factor == 1.0
    grade = find_grade(ToolKind.ENDMILL, CuttingMaterial.CARBIDE, "P")
    constant = replace(steel, kienzle=replace(steel.kienzle, rake_angle=None))
    assert correction_of(constant, grade, CuttingMaterial.CARBIDE).rake == 1.0
