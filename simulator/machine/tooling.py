"""Tools of a program as the virtual machine holds them: shape, edge and wear."""

from dataclasses import replace

from simulator.edge_material import correction_of, edge_material
from simulator.errors import LibraryError
from simulator.library import find_grade, find_window
from simulator.machine.cutting import Edge
from simulator.machine.virtual import LoadedTool
from simulator.removal.tool_shape import THREADS, shape_of, tool_kind
from simulator.spec import CuttingMaterial, Grade, Material, Taylor, ToolKind
from simulator.tool_table import TableTool
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.tool import tool_of


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
    kind = tool_kind(tool)
    # Carbide where nothing is said, as in the optimiser.
    cutting_material = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    edge = _edge(kind, cutting_material, tool.teeth, material=material)
    return LoadedTool(
        number=number,
        id=tool.id,
        shape=shape_of(program, ref),
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
