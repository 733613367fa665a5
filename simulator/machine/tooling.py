"""Tools of a program prepared for the virtual machine: shape, edge and wear."""

from dataclasses import replace
from math import isinf

from simulator.library import find_window
from simulator.machine.cutting import CuttingEdge
from simulator.machine.virtual import LoadedTool, Shape
from simulator.physics.drilling import LIPS_ONLY
from simulator.physics.flutes import CuttingEdges
from simulator.physics.strength import end_mill
from simulator.removal.cutter import THREADS, Cutter, shape_of
from simulator.spec import CuttingMaterial, Taylor, ToolGrade, ToolKind, WorkMaterial
from simulator.tool_kind import correction_of, edge_material, tool_kind
from simulator.tools.tool_table import TableTool, grade_for, grade_of_table_tool
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import tool_of


def loaded_tool(
    program: Program,
    ref: Ref[Entity],
    number: int,
    material: WorkMaterial,
    *,
    factor: float = 1.0,
) -> LoadedTool:
    """Prepare a tool of a program for the virtual machine.

    Parameters
    ----------
    ref : reference
        Reference to the tool.
    number : int
        Number of the tool in the machine.
    material : WorkMaterial
        Material of the workpiece.
    factor : float
        Factor on k_c from calibration.

    Raises
    ------
    SchemaError
        If the tool cannot be used.
    """
    tool = tool_of(program, ref)
    kind = tool_kind(tool)
    # Carbide if no material is given, as in the optimiser.
    cutting_material = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    shape = shape_of(program, ref)
    grade = grade_for(kind, cutting_material, material)
    edge = _edge(
        kind,
        cutting_material,
        tool.teeth,
        shape=shape,
        material=material,
        grade=grade,
        overhang=tool.overhang,
    )
    return LoadedTool(
        number=number,
        id=tool.id,
        shape=shape,
        edge=replace(edge, factor=factor * edge.factor),
        taylor=_taylor(kind, cutting_material, material),
    )


def table_tool(tool: TableTool, material: WorkMaterial, *, factor: float = 1.0) -> LoadedTool:
    """Prepare a tool of a tool table for the virtual machine."""
    edge = _edge(
        tool.kind,
        tool.cutting_material,
        tool.teeth,
        shape=tool.shape,
        material=material,
        grade=grade_of_table_tool(tool, material),
        overhang=tool.shape.overhang if isinstance(tool.shape, Cutter) else None,
    )
    if edge.flutes is not None and tool.helix_angle is not None:
        edge = replace(edge, flutes=replace(edge.flutes, helix_angle=tool.helix_angle))
    return LoadedTool(
        number=tool.number,
        id=tool.id,
        shape=None if tool.kind in THREADS else tool.shape,
        edge=replace(edge, factor=factor * edge.factor),
        taylor=_taylor(tool.kind, tool.cutting_material, material),
    )


def _taylor(
    kind: ToolKind, cutting_material: CuttingMaterial, material: WorkMaterial
) -> Taylor | None:
    window = find_window(material, kind, cutting_material)
    return None if window is None else window.taylor


def _edge(  # noqa: PLR0913 (a tool, what it cuts, and how far it stands out)
    kind: ToolKind,
    cutting_material: CuttingMaterial,
    teeth: int,
    *,
    shape: Shape | None,
    material: WorkMaterial,
    grade: ToolGrade | None,
    overhang: float | None,
) -> CuttingEdge:
    """Cutting edge of a tool in a material, with the compliance of an end mill."""
    correction = correction_of(material, grade, cutting_material)
    edge = CuttingEdge(
        teeth=teeth,
        kienzle=material.kienzle,
        factor=correction.factor,
        point=(None if grade is None else grade.point) or LIPS_ONLY,
        feed_force=material.feed_force,
        back_force=material.back_force,
    )
    if not isinstance(shape, Cutter) or shape.is_drill:
        return edge
    flutes = CuttingEdges(
        teeth=teeth,
        diameter=shape.diameter,
        helix_angle=0.0 if grade is None else grade.helix_angle,
        corner_radius=shape.corner_radius,
        cutting_edge_angle=shape.cutting_edge_angle,
    )
    compliance = 0.0
    if grade is not None and kind is ToolKind.ENDMILL:
        length = None if isinf(shape.edge_length) else shape.edge_length
        compliance = end_mill(
            shape.diameter,
            cutting_edge_length=length,
            youngs_modulus=grade.youngs_modulus,
            overhang=overhang,
        ).compliance
    return replace(edge, flutes=flutes, compliance=compliance)
