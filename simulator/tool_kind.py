"""Kind of a tool from its name in EXPRESS, as plans and runs take it.

Material of a cutting edge, and its factor on the specific cutting force.
"""

from collections.abc import Sequence

from simulator.physics.cutting import ForceCorrection, rake_factor, speed_factor
from simulator.spec import CuttingMaterial, ToolGrade, ToolKind, WorkMaterial
from stepnc_model.programs.tool import Tool

KINDS = {
    "FACEMILL": ToolKind.FACEMILL,
    "TWIST_DRILL": ToolKind.DRILL,
    "SPADE_DRILL": ToolKind.DRILL,
    "STEP_DRILL": ToolKind.DRILL,
    "DRILL": ToolKind.DRILL,
    "CENTER_DRILL": ToolKind.CENTER_DRILL,
    "COUNTERSINK": ToolKind.COUNTERSINK,
    "COUNTERBORE": ToolKind.COUNTERSINK,
    "REAMER": ToolKind.REAMER,
    "TAPERED_REAMER": ToolKind.REAMER,
    "BORING_TOOL": ToolKind.BORING_BAR,
    "TAP": ToolKind.TAP,
    "TAPERED_TAP": ToolKind.TAP,
    "COMBINED_DRILL_AND_TAP": ToolKind.TAP,
    "GROOVING_TOOL": ToolKind.GROOVING,
    "TURNING_THREADING_TOOL": ToolKind.THREADING,
    "GENERAL_TURNING_TOOL": ToolKind.TURNING,
    "USER_DEFINED_TURNING_TOOL": ToolKind.TURNING,
    "KNURLING_TOOL": ToolKind.TURNING,
}

LEAST_FACEMILL = 25.0
"""Least diameter of a face mill, mm; files call smaller end mills FACEMILL too."""


def tool_kind(tool: Tool) -> ToolKind:
    """Kind of a tool from its EXPRESS name; an end mill if the name is not listed."""
    kind = KINDS.get(tool.keyword, ToolKind.ENDMILL)
    if kind is ToolKind.FACEMILL and tool.diameter < LEAST_FACEMILL:
        return ToolKind.ENDMILL
    return kind


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
