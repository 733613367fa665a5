"""Cuts made by hand, and the conditions they are in."""

from collections.abc import Sequence
from dataclasses import replace
from math import radians

from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.solver.problem import BoundSide, Limit, LimitName, Setting
from simulator.library import find_grade, load_machine, load_material
from simulator.physics.engagement import unidirectional
from simulator.spec import CuttingMaterial, ToolKind
from stepnc_model.programs.tool import Tool

MILL = Tool(
    id="mill",
    keyword="TAPERED_ENDMILL",
    diameter=12.0,
    teeth=4,
    corner_radius=0.5,
    cutting_edge_length=26.0,
)
DRILL = Tool(id="drill", keyword="TWIST_DRILL", diameter=10.0, teeth=2)
INSERT = Tool(id="insert", keyword="GENERAL_TURNING_TOOL", corner_radius=0.8)
CUT = Cut(
    kind=CutKind.MILLING,
    tool=MILL,
    tool_kind=ToolKind.ENDMILL,
    diameter=12.0,
    programmed=Setting(feed=0.05, depth=3.0, passes=2, speed=60.0),
    length=500.0,
    total_depth=6.0,
    is_depth_free=True,
    engagement=unidirectional(6.0, 12.0),
    radial_width=6.0,
    depth_bound=26.0,
    helix_angle=radians(30.0),
)
DRILLED = replace(
    CUT,
    kind=CutKind.DRILLING,
    tool=DRILL,
    tool_kind=ToolKind.DRILL,
    diameter=10.0,
    engagement=None,
    depth_bound=None,
)
TURNED = replace(
    CUT,
    kind=CutKind.TURNING,
    tool=INSERT,
    tool_kind=ToolKind.TURNING,
    diameter=40.0,
    engagement=None,
    corner_radius=0.8,
    texture=Texture.CORNER_PER_REVOLUTION,
    depth_bound=6.0,
)


def conditions(
    kind: ToolKind = ToolKind.ENDMILL, roughness: float | None = None
) -> CuttingConditions:
    """Carbide in C45 on the machining centre of the library."""
    return CuttingConditions(
        machine=load_machine("vmc15"),
        material=load_material("c45"),
        cutting_material=CuttingMaterial.CARBIDE,
        grade=find_grade(kind, CuttingMaterial.CARBIDE, "P"),
        roughness=roughness,
    )


CARBIDE = conditions()
PAPER = CuttingConditions(
    machine=load_machine("paper002"),
    material=load_material("paper002"),
    cutting_material=CuttingMaterial.HSS,
    grade=None,
    roughness=None,
)


def names(limits: Sequence[Limit]) -> set[LimitName]:
    return {limit.name for limit in limits}


def named(
    limits: Sequence[Limit], name: LimitName, sense: BoundSide = BoundSide.AT_MOST
) -> Limit:
    (found,) = (limit for limit in limits if limit.name is name and limit.sense is sense)
    return found
