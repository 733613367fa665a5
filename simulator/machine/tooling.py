"""Tools of a program as the virtual machine holds them: shape, edge and wear."""

from dataclasses import replace
from math import inf, pi

from simulator.edge_material import correction_of, edge_material
from simulator.errors import LibraryError
from simulator.library import find_grade, find_window
from simulator.machine.cutting import Edge
from simulator.machine.virtual import LoadedTool
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.spec import CuttingMaterial, Grade, Material, Taylor, ToolKind
from simulator.tool_table import ENDS, TableTool
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.tools import CuttingTool, MillingCuttingTool, TaperedEndmill
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.tool import Tool, tool_of
from stepnc_model.units import rad_from_deg

HOLDER_SHARE = 2.0
"""diameter of a holder over that of its tool, where nothing is said: a collet chuck"""

CUSTOMARY_POINT = rad_from_deg(118.0)

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
}
"""by the EXPRESS name of the tool; all others are end mills"""

THREADS = {ToolKind.TAP, ToolKind.THREADING}


def loaded_tool(
    program: Program, ref: Ref[Entity], number: int, material: Material, *, factor: float = 1.0
) -> LoadedTool:
    """A tool of a program.

    Parameters
    ----------
    program : Program
    ref : reference
        To the tool.
    number : int
        In the machine.
    material : Material
        Of the workpiece.
    factor : float
        On k_c, from calibration.

    Raises
    ------
    SchemaError
        When the tool cannot be used.
    """
    tool = tool_of(program, ref)
    entity = program.get(ref)
    is_turning = isinstance(entity, TurningMachineCuttingTool)
    kind = KINDS.get(tool.keyword, ToolKind.ENDMILL)
    shape: Cutter | Insert | None = None
    if kind not in THREADS:
        shape = _insert(tool, entity) if is_turning else _cutter(program, tool, entity)
    # Carbide where nothing is said, as in the optimiser.
    cutting_material = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    edge = _edge(kind, cutting_material, tool.teeth, material=material)
    return LoadedTool(
        number=number,
        id=tool.id,
        shape=shape,
        edge=replace(edge, factor=factor * edge.factor),
        taylor=_taylor(kind, cutting_material, material),
    )


def table_tool(tool: TableTool, material: Material, *, factor: float = 1.0) -> LoadedTool:
    """A tool of a tool table."""
    edge = _edge(tool.kind, tool.cutting_material, tool.teeth, material=material)
    return LoadedTool(
        number=tool.number,
        id=tool.id,
        shape=None if tool.kind in THREADS else tool.shape,
        edge=replace(edge, factor=factor * edge.factor),
        taylor=_taylor(tool.kind, tool.cutting_material, material),
    )


def _taylor(
    kind: ToolKind, cutting_material: CuttingMaterial, material: Material
) -> Taylor | None:
    window = find_window(material, kind, cutting_material)
    return None if window is None else window.taylor


def _edge(
    kind: ToolKind, cutting_material: CuttingMaterial, teeth: int, *, material: Material
) -> Edge:
    """What a tool cuts a material with."""
    grade = _grade(kind, cutting_material, material)
    correction = correction_of(material, grade, cutting_material)
    return Edge(teeth=teeth, kienzle=material.kienzle, factor=correction.factor)


def _grade(
    kind: ToolKind, cutting_material: CuttingMaterial, material: Material
) -> Grade | None:
    if not material.iso_group:
        return None
    try:
        return find_grade(kind, cutting_material, material.iso_group)
    except LibraryError:
        return None


def _insert(tool: Tool, entity: Entity) -> Insert:
    hand = getattr(entity, "hand_of_tool", None) or HandOfToolType.RIGHT
    radius = tool.corner_radius or 0.0
    width = tool.width
    return Insert(
        nose_radius=radius if width is None else min(radius, 0.5 * width),
        cutting_edge_angle=tool.cutting_edge_angle,
        width=width,
        hand=hand,
    )


def _cutter(program: Program, tool: Tool, entity: Entity) -> Cutter:
    kind = KINDS.get(tool.keyword, ToolKind.ENDMILL)
    is_end = kind in ENDS
    point = tool.point_angle or (CUSTOMARY_POINT if kind is ToolKind.DRILL else pi)
    return Cutter(
        diameter=tool.diameter,
        corner_radius=0.0 if is_end else min(tool.corner_radius or 0.0, 0.5 * tool.diameter),
        taper_angle=_taper(program, entity),
        point_angle=point if is_end else pi,
        teeth=tool.teeth,
        edge_length=tool.cutting_edge_length or inf,
        cutting_edge_angle=tool.cutting_edge_angle,
        is_drill=is_end,
        holder=_holder(tool, entity),
    )


def _taper(program: Program, entity: Entity) -> float:
    body = program.get(entity.its_tool_body) if isinstance(entity, MillingCuttingTool) else None
    angle = body.taper_angle if isinstance(body, TaperedEndmill) else None
    return rad_from_deg(angle) if angle else 0.0


def _holder(tool: Tool, entity: Entity) -> Holder | None:
    """A collet chuck at the tool's assembly length; None where no length is given."""
    length = entity.overall_assembly_length if isinstance(entity, CuttingTool) else None
    if not length:
        return None
    return Holder(diameter=HOLDER_SHARE * tool.diameter, overhang=length)
