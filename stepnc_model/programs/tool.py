"""Tool of a workingstep as numbers: ISO 14649-111 and -121 tools in mm and rad."""

from dataclasses import dataclass
from math import pi

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import Hand
from stepnc_model.entities.tools import BallEndmill, MillingCuttingTool, MillingToolBody
from stepnc_model.entities.turning_tools import (
    GroovingTool,
    RoundedCorner,
    TurningMachineCuttingTool,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.user_tools import GivenTool
from stepnc_model.units import rad_from_deg

RIGHT_ANGLE = 0.5 * pi

LEAST_TOP_ANGLE_DEG = 2.0
"""Least top angle in degrees; smaller numbers are radians, as in some files."""


LEAST_DIAMETER = 0.01
"""Least tool diameter accepted, mm."""

MAX_DIAMETER = 2000.0
"""Greatest tool diameter accepted, mm; the largest face mills are below one metre."""

MAX_EDGE_LENGTH = 2000.0
"""Greatest length of a cutting edge accepted, mm; the longest end mills are below one metre."""

MAX_TEETH = 500
"""Greatest number of teeth accepted; only circular saws have more."""


CENTRE_CUTTING = {
    "BALL_ENDMILL": True,
    "FACEMILL": False,
    "SIDE_MILL": False,
    "T_SLOT_MILL": False,
    "DOVETAIL_MILL": False,
    "WOODRUFF_KEYSEAT_MILL": False,
    "THREAD_MILL": False,
}
"""Tool bodies whose form determines whether their edges reach the axis."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """Cutting tool with the data that the cutting physics needs.

    A rotating tool has a diameter and teeth; a turning tool has ``diameter = 0`` and one
    tooth.
    """

    id: str
    keyword: str
    """EXPRESS name of the tool body or turning tool, in capitals."""
    edge_material: tuple[str, ...] = ()
    """Names given for the material of the cutting edge."""
    diameter: float = 0.0
    """Tool diameter, mm."""
    teeth: int = 1
    has_teeth: bool = True
    """Whether the file gives the number of teeth."""
    corner_radius: float | None = None
    """Corner radius of end mill or insert nose, mm; half the diameter for a ball end mill."""
    cutting_edge_length: float | None = None
    """Length of the cutting edge, or the greatest depth that an insert may cut, mm."""
    overhang: float | None = None
    """Distance from the tip to the holder, mm; None: not stated. ISO 14649 has no attribute for
    it: ``overall_assembly_length`` includes the holder."""
    cutting_edge_angle: float = RIGHT_ANGLE
    """Cutting edge angle κ_r, rad."""
    point_angle: float | None = None
    """Included angle of a drill's point, rad."""
    width: float | None = None
    """Width of a grooving insert, mm."""
    centre_cutting: bool | None = None
    """Whether a mill's edges reach its axis; None if its form does not determine it."""
    has_wiper: bool = False
    """Whether a wiper flat smooths the surface; ISO 14649 has no attribute for it."""


def tool_of(program: Program, ref: Ref[Entity]) -> Tool:
    """Read the tool behind a reference.

    Raises
    ------
    SchemaError
        If the diameter is missing or invalid, or the entity is not a cutting tool.
    """
    tool = program.get(ref)
    with program.using(ref):
        if isinstance(tool, MillingCuttingTool):
            return _rotating(program, ref, tool)
        if isinstance(tool, TurningMachineCuttingTool):
            return _turning(program, ref, tool)
    raise program.error("is not a milling, drilling or turning tool", ref)


def is_described(program: Program, ref: Ref[Entity]) -> bool:
    """True unless nothing is known of a rotating tool but its name."""
    tool = program.get(ref)
    if not isinstance(tool, MillingCuttingTool) or getattr(tool, "its_tool_body", None):
        return True
    return any(each.is_named(tool.its_id) for each in program.tools)


def user_tool_for(program: Program, ref: Ref[Entity]) -> GivenTool | None:
    """Tool of the user's that stands for one of which the file has only the name."""
    tool = program.get(ref)
    if not isinstance(tool, MillingCuttingTool) or body_of(program, ref) is not None:
        return None
    return next((each for each in program.tools if each.is_named(tool.its_id)), None)


def tool_name(program: Program, ref: Ref[Entity]) -> str:
    """Id of a tool, also of one of which the file has nothing else."""
    if is_described(program, ref):
        return tool_of(program, ref).id
    return str(getattr(program.get(ref), "its_id", "")) or program.label(ref)


def body_of(program: Program, ref: Ref[Entity]) -> MillingToolBody | None:
    """Body of a rotating tool; None for other tools, or if the file gives none."""
    ref_of_body = getattr(program.get(ref), "its_tool_body", None)
    body = None if ref_of_body is None else program.get(ref_of_body)
    return body if isinstance(body, MillingToolBody) else None


def hand_of(program: Program, ref: Ref[Entity]) -> Hand | None:
    """Hand of cut of a rotating tool; None if not given or neutral."""
    hand = getattr(body_of(program, ref), "hand_of_cut", None)
    return None if hand is Hand.NEUTRAL else hand


def _rotating(program: Program, ref: Ref[Entity], tool: MillingCuttingTool) -> Tool:
    """Convert a milling or drilling tool."""
    given = next((each for each in program.tools if each.is_named(tool.its_id)), None)
    if not is_described(program, ref):
        raise program.error(
            f"the tool has no tool body: --tools gives a table with tool '{tool.its_id}'", ref
        )
    if given is not None and body_of(program, ref) is None:
        return _completed_tool(given, tool.its_id)
    body = program.get(tool.its_tool_body)
    if not isinstance(body, MillingToolBody) or body.dimension is None:
        raise program.error("the tool body has no dimension", tool.its_tool_body, "dimension")
    dimension = program.get(body.dimension)
    diameter = dimension.diameter
    if diameter is None or not LEAST_DIAMETER <= diameter <= MAX_DIAMETER:
        written = "no diameter is given" if diameter is None else f"diameter {diameter} mm"
        bounds = f"{LEAST_DIAMETER:g} mm to {MAX_DIAMETER:g} mm"
        message = f"{written}: it must be positive, {bounds}"
        raise program.error(message, body.dimension, "diameter")
    teeth = body.number_of_teeth
    if teeth is None and given is not None:
        teeth = given.teeth
    if teeth is not None and not 1 <= teeth <= MAX_TEETH:
        message = f"{teeth} teeth: a cutter must have 1 to {MAX_TEETH}"
        if tool.its_id:
            message += f'; --teeth "{tool.its_id}=N" gives another number'
        raise program.error(message, tool.its_tool_body, "number_of_teeth")
    length = dimension.cutting_edge_length
    if length is not None and not 0.0 <= length <= MAX_EDGE_LENGTH:
        message = f"cutting edge length {length:g} mm must be 0 to {MAX_EDGE_LENGTH:g} mm"
        raise program.error(message, body.dimension, "cutting_edge_length")
    radius = 0.5 * diameter if isinstance(body, BallEndmill) else dimension.edge_radius
    return Tool(
        id=tool.its_id or body.keyword.lower().replace("_", " "),
        keyword=body.keyword,
        edge_material=tuple(_edge_materials(program, tool)),
        diameter=diameter,
        teeth=teeth or 1,
        has_teeth=teeth is not None,
        corner_radius=radius or None,
        cutting_edge_length=dimension.cutting_edge_length or None,
        overhang=None if given is None else given.overhang,
        point_angle=_point_angle(dimension.tool_top_angle),
        centre_cutting=CENTRE_CUTTING.get(body.keyword),
    )


def _completed_tool(user_tool: GivenTool, id: str) -> Tool:
    """Tool that the file only names."""
    return Tool(
        id=id,
        keyword=user_tool.body,
        edge_material=(user_tool.edge_material, id),
        diameter=user_tool.diameter,
        teeth=user_tool.teeth,
        corner_radius=user_tool.corner_radius or None,
        cutting_edge_length=user_tool.edge_length,
        cutting_edge_angle=user_tool.insert.cutting_edge_angle
        if user_tool.insert
        else RIGHT_ANGLE,
        width=user_tool.insert.width if user_tool.insert else None,
        overhang=user_tool.overhang,
        point_angle=user_tool.point_angle,
        centre_cutting=CENTRE_CUTTING.get(user_tool.body),
    )


def _turning(program: Program, ref: Ref[Entity], tool: TurningMachineCuttingTool) -> Tool:
    """Convert a turning tool."""
    if tool.cutting_edge is None:
        raise program.error("the tool has no cutting edge", ref, "cutting_edge")
    edge = program.get(tool.cutting_edge)
    corners = [program.get(corner) for corner in edge.corner_transitions or ()]
    radii = [corner.corner_radius for corner in corners if isinstance(corner, RoundedCorner)]
    if radii and not 0.0 <= min(radii) <= MAX_DIAMETER:
        message = f"corner radius {min(radii):g} mm must be 0 to {MAX_DIAMETER:g} mm"
        raise program.error(message, tool.cutting_edge, "corner_transitions")
    angle = edge.tool_cutting_edge_angle
    return Tool(
        id=tool.its_id or tool.keyword.lower().replace("_", " "),
        keyword=tool.keyword,
        edge_material=(tool.its_id,),
        corner_radius=min(radii, default=0.0) or None,
        cutting_edge_length=edge.maximum_side_cutting_depth,
        cutting_edge_angle=rad_from_deg(angle) if angle else RIGHT_ANGLE,
        width=tool.cutting_width if isinstance(tool, GroovingTool) else None,
    )


def _edge_materials(program: Program, tool: MillingCuttingTool) -> list[str]:
    """Texts that name the material of the cutting edges."""
    texts: list[str] = []
    for component in tool.its_cutting_edge:
        material = program.get(component).its_material
        if material is not None:
            entity = program.get(material)
            texts += [entity.standard_identifier, entity.material_identifier]
    return [*texts, tool.its_id]


def _point_angle(top_angle: float | None) -> float | None:
    """Included point angle, rad, from the angle between lip and face plane."""
    if not top_angle:
        return None
    top = top_angle if top_angle < LEAST_TOP_ANGLE_DEG else rad_from_deg(top_angle)
    return pi - 2.0 * top if 0.0 < top < RIGHT_ANGLE else None
