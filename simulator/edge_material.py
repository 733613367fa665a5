"""Material of a cutting edge, and its factor on the specific cutting force."""

from collections.abc import Sequence

from simulator.physics.cutting import ForceCorrection, rake_factor, speed_factor
from simulator.spec import CuttingMaterial, ToolGrade, WorkMaterial

WORDS = (
    (CuttingMaterial.CERAMIC, ("ceramic",)),
    (CuttingMaterial.CARBIDE, ("carbide", "hartmetall", "metal duro")),
    (CuttingMaterial.HSS, ("hss", "high speed steel", "high-speed steel")),
)
"""how files name them"""


def edge_material(texts: Sequence[str]) -> CuttingMaterial | None:
    """Material of the edge, from the words of a file; None: not stated."""
    words = " ".join(texts).lower()
    for material, names in WORDS:
        if any(name in words for name in names):
            return material
    return None


def correction_of(
    material: WorkMaterial, grade: ToolGrade | None, cutting_material: CuttingMaterial
) -> ForceCorrection:
    """K_γ and K_v of an edge in a material; all 1 without a grade, or for a constant k_s."""
    if grade is None:
        return ForceCorrection()
    reference, rake = material.kienzle.rake_angle, grade.rake_angle
    return ForceCorrection(
        rake=1.0 if reference is None or rake is None else rake_factor(rake, reference),
        speed=speed_factor(cutting_material),
    )
