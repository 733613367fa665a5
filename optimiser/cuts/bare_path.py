"""Cuts of workingsteps of which nothing but the tool path is known.

CAM systems write operations with a given path and no feature. What such an operation removes
is met along its path in the stock: depth and width are neither in the file nor needed there.
"""

from dataclasses import replace

from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.cuts.feature_estimate import drill_kind, is_hole_making, texture_of_floor
from optimiser.cuts.hardest_places import PathContacts
from optimiser.solver.problem import Setting
from simulator.motion.tool_path import ToolPathRun
from simulator.physics.engagement import full_immersion
from simulator.removal.stations import StationKind
from simulator.spec import ToolKind
from simulator.tool_kind import tool_kind
from stepnc_model.entities.features import ToolpathFeature
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, PathError
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tool import Tool
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Move

UNKNOWN_DEPTH = "the depth along the given path is not known: --stock gives the raw part"


def is_path_only(program: Program, step: ResolvedWorkingstep) -> bool:
    """True if nothing but its tool path tells what a workingstep cuts."""
    if step.operation.its_toolpath is None:
        return False
    features = [program.get(feature) for feature in step.features]
    return all(isinstance(each, ToolpathFeature) and each.depth is None for each in features)


def path_only_cut(
    program: Program,
    step: ResolvedWorkingstep,
    tool: Tool,
    *,
    speed: float,
    feed: float,
    depth: float | None,
) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a workingstep whose width and depth are met along its path.

    Parameters
    ----------
    speed : float, rev/s
        Programmed spindle speed.
    feed : float, mm
        Programmed feed per tooth.
    depth : float or None, mm
        Greatest depth met along the path; None if the stock is not known.

    Raises
    ------
    PathError
        If neither the stock nor the length of the edge bounds the depth.
    """
    depth = depth or tool.cutting_edge_length
    if not depth:
        raise program.path_error(UNKNOWN_DEPTH, step.operation_ref)
    cut = Cut(
        kind=CutKind.MILLING,
        tool=tool,
        tool_kind=tool_kind(tool),
        diameter=tool.diameter,
        programmed=Setting(feed=feed, depth=depth, passes=1, speed=speed),
        length=0.0,
        total_depth=depth,
        is_depth_free=False,
        texture=Texture.NONE,
        is_finishing=step.is_last_on_feature,
        depth_bound=tool.cutting_edge_length,
    )
    if isinstance(step.operation, TurningMachiningOperation):
        return _turned(program, step, cut), ()
    if is_hole_making(step.operation, tool):
        kind = drill_kind(step.operation, tool)
        return replace(cut, kind=CutKind.DRILLING, tool_kind=kind, depth_bound=None), ()
    texture, corner = texture_of_floor(tool, cut.tool_kind)
    return replace(
        cut,
        texture=texture,
        corner_radius=corner,
        engagement=full_immersion(),
        radial_width=tool.diameter,
    ), ()


def _turned(program: Program, step: ResolvedWorkingstep, cut: Cut) -> Cut:
    """Cut of a turning insert."""
    tool, diameter = cut.tool, path_diameter(program, step)
    if tool.width:
        return replace(
            cut,
            kind=CutKind.GROOVING,
            tool_kind=ToolKind.GROOVING,
            diameter=diameter,
            radial_width=tool.width,
            is_fed_inwards=True,
            depth_bound=None,
        )
    return replace(
        cut,
        kind=CutKind.TURNING,
        tool_kind=ToolKind.TURNING,
        diameter=diameter,
        texture=Texture.CORNER_PER_REVOLUTION if tool.corner_radius else Texture.NONE,
        corner_radius=tool.corner_radius or 0.0,
    )


def greatest_depth(run: ToolPathRun, met: PathContacts) -> float | None:
    """Greatest depth of a path's passes, else of its holes, mm; None if it meets nothing.

    Parameters
    ----------
    met : PathContacts
        Contacts of the path with the stock.
    """
    stations = met.stations
    is_pass = (stations.kind == StationKind.MILLING) | (stations.kind == StationKind.TURNING)
    if is_pass.any():
        return float(stations.axial_depth[is_pass].max())
    is_hole = stations.kind == StationKind.DRILLING
    if not is_hole.any():
        return None
    # A station describes the stretch before it, down to its place.
    low = run.segments.position(stations.segment, stations.station)[is_hole, 2]
    return float((low + met.length[is_hole]).max() - low.min())


def path_diameter(program: Program, step: ResolvedWorkingstep) -> float:
    """Greatest diameter that the path of a turning workingstep reaches at a feed, mm."""
    radii: list[float] = []
    path = workingstep_path(program, step)
    at = path.start
    for move in path.steps:
        if isinstance(move, Move):
            if move.feed is not None:
                radii += [abs(at[0]), abs(move.end[0])]
            at = move.end
    if not radii:
        raise PathError("no move of the path runs at a feed", entity=str(step.ref))
    return 2.0 * max(radii)
