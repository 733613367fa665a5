"""Material of a cutting edge, and its factor on the specific cutting force."""

from collections.abc import Sequence

from simulator.physics.cutting import ForceCorrection, rake_factor, speed_factor
from simulator.spec import CuttingMaterial, ToolGrade, WorkMaterial

WORDS = (
    (CuttingMaterial.CERAMIC, ("ceramic",)),
    (CuttingMaterial.CARBIDE, ("carbide", "hartmetall", "metal duro")),
    (CuttingMaterial.HSS, ("hss", "high speed steel", "high-speed steel")),
)
"""Words by which files name each cutting material."""


def edge_material(texts: Sequence[str]) -> CuttingMaterial | None:
    """Cutting material of the edge, from the words of a file; None if not stated."""
    words = " ".join(texts).lower()
    for material, names in WORDS:
        if any(name in words for name in names):
            return material
    return None


def correction_of(
    material: WorkMaterial, grade: ToolGrade | None, cutting_material: CuttingMaterial
) -> ForceCorrection:
    """Correction factors K_γ and K_v of an edge in a material; 1 if a value is unknown.

    A constant k_s, as of textbooks, is that of the whole example and has no correction.
    """
    if grade is None or (material.kienzle.m_c == 0.0 and not material.iso_group):
        return ForceCorrection()
    reference, rake = material.kienzle.rake_angle, grade.rake_angle
    return ForceCorrection(
        rake=1.0 if reference is None or rake is None else rake_factor(rake, reference),
        speed=speed_factor(cutting_material),
    )
