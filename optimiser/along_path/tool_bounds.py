"""Bounds along the path of a tool of which only the tool table is known, as for NC code.

What a STEP-NC program says of a workingstep is not known: roughness and tolerance apply where
the user says that a tool finishes.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isinf

from optimiser.along_path.caps import CapName, CutBounds
from optimiser.bounds.chip_load import catalogue_feed
from optimiser.bounds.limits import depth_at_shoulder
from optimiser.bounds.plunge_feed import permitted_plunge
from optimiser.bounds.roughness import surface_limits
from optimiser.bounds.speed_limits import SourcedBound, cutting_speed_window
from optimiser.bounds.tolerance import GREATEST_AT_WALL
from optimiser.cuts.conditions import BarGrip, CuttingConditions, PermittedDeflection
from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.errors import Infeasible
from optimiser.optimise import DEFAULT_QUALITY
from optimiser.safety import safety_factor
from optimiser.solver.problem import BoundSide, Limit, LimitName, Setting
from simulator.library import find_window
from simulator.removal.cutter import ENDS, THREADS, Cutter, Insert
from simulator.spec import Machine, ToolGrade, ToolKind, WorkMaterial
from simulator.tools.tool_table import TableTool, grade_of_table_tool, why_unsuited
from simulator.work_holding import Holding
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.tool import Tool
from stepnc_model.units import um_from_mm

TEXTURES = {
    ToolKind.FACEMILL: (Texture.CORNER_PER_REVOLUTION,),
    ToolKind.ENDMILL: (Texture.CORNER_PER_TOOTH, Texture.WALL),
    ToolKind.TURNING: (Texture.CORNER_PER_REVOLUTION,),
    ToolKind.BORING_BAR: (Texture.CORNER_PER_REVOLUTION,),
}
"""Surfaces that a finishing tool may leave; all of them must keep the roughness."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownOfJob:
    """Facts about a job beyond the tool table."""

    force_factor: float = 1.0
    """Accepted correction of k_c for the tool."""
    roughness_quantile: float = 0.5
    """Share of surfaces that must keep the roughness."""
    finishing_speed: float = 0.0
    """Least cutting speed of the tool, mm/s; 0 if it is not known: the roughest surface."""
    is_dry: bool = True
    """Whether the tool has no coolant, or it is not known."""
    safety_factor: float | None = None
    """k_c at the planned quantile over its accepted correction; None: by the material."""
    holding: Holding | None = None
    grip: BarGrip | None = None
    """Where a chuck grips the bar."""


NOTHING_KNOWN = KnownOfJob()


def bounds_of_tool(  # noqa: PLR0913 (a tool, its machine and material, and what is asked of it)
    tool: TableTool,
    machine: Machine,
    material: WorkMaterial,
    *,
    quantile: float,
    is_finishing: bool,
    roughness: float | None,
    job: KnownOfJob = NOTHING_KNOWN,
) -> CutBounds | None:
    """Bounds of a tool in a material; None for threading, whose feed is its pitch.

    Parameters
    ----------
    quantile : float
        Quantile of k_c at which loads keep their bounds.
    is_finishing : bool
        Whether the tool leaves final surfaces.
    roughness : float or None, mm
        Roughness Ra of final surfaces; None: general machining.
    job : KnownOfJob
        Accepted correction of the tool, and the work-holding.
    """
    if tool.kind in THREADS:
        return None
    spread = material.spread
    is_margin = not machine.only_stated_limits and spread is not None
    customary = safety_factor(spread, quantile) if is_margin and spread else 1.0
    grade = grade_of_table_tool(tool, material)
    if machine.only_stated_limits and not material.iso_group:
        grade = None
    cut = _cut(tool, grade, is_finishing=is_finishing)
    at = CuttingConditions(
        machine=machine,
        material=material if tool.max_feed is None else _without_feeds(material),
        cutting_material=tool.cutting_material,
        grade=grade,
        roughness=(roughness or DEFAULT_QUALITY) if is_finishing else None,
        deflection=PermittedDeflection(value=GREATEST_AT_WALL)
        if is_finishing
        else PermittedDeflection(),
        centre_cutting=tool.centre_cutting,
        force_factor=job.force_factor,
        safety_factor=customary if job.safety_factor is None else job.safety_factor,
        holding=None if machine.only_stated_limits else job.holding,
        grip=job.grip,
        roughness_quantile=job.roughness_quantile,
        finishing_speed=job.finishing_speed,
        is_dry=job.is_dry,
    )
    surface = _surface_feed(cut, at)
    return CutBounds(
        cut=cut,
        at=at,
        fixed=() if surface is None else ((CapName.ROUGHNESS, surface),),
        plunge=permitted_plunge(cut, at),
        deepest=depth_at_shoulder(cut, at),
        keeps_programmed=is_unsourced(cut, at) or not _is_promised(cut, at),
        is_held_along=at.holding is not None,
    )


def bounds_of_all(bounds: Sequence[CutBounds]) -> CutBounds:
    """Bounds of a tool of which something is guessed.

    Parameters
    ----------
    bounds : sequence of CutBounds
        Bounds of each tool that it may be, the one with the fewest teeth first: its feed of
        plunges is the least.
    """
    return replace(
        bounds[0],
        plausible=tuple(bounds[1:]),
        plunge=min((each.plunge for each in bounds if each.plunge is not None), default=None),
        keeps_programmed=any(each.keeps_programmed for each in bounds),
    )


def is_unsourced(cut: Cut, at: CuttingConditions) -> bool:
    """True if no source gives a greatest feed."""
    return not at.machine.only_stated_limits and catalogue_feed(cut, at) is None


def is_unable(tool: TableTool, machine: Machine, material: WorkMaterial) -> bool:
    """True if a tool cannot cut a material at all: no limit says how fast it should."""
    is_stated = machine.only_stated_limits
    return not is_stated and why_unsuited(tool.cutting_material, material) != ""


def window_findings(
    tools: Iterable[TableTool], machine: Machine, material: WorkMaterial
) -> Iterator[Finding]:
    """Findings on tools whose windows are not those of the material's group.

    Parameters
    ----------
    tools : iterable of TableTool
        Tools that cut.
    """
    for tool in tools:
        if tool.kind in THREADS or machine.only_stated_limits:
            continue
        grade = grade_of_table_tool(tool, material)
        is_never = is_unable(tool, machine, material)
        text = f"tool '{tool.id}' "
        if is_never:
            text += f"keeps its feeds: {why_unsuited(tool.cutting_material, material)}"
        elif grade is None or not (grade.has_feeds or material.max_feed_per_tooth):
            text += "raises no feed: no source says how far; give max_feed_mm in its table"
        elif grade.borrowed:
            text += f"has {grade.borrowed}"
        else:
            continue
        yield Finding(severity=Severity.ERROR if is_never else Severity.WARNING, message=text)


def cutting_speed_bound(
    tool: TableTool, machine: Machine, material: WorkMaterial
) -> SourcedBound:
    """Greatest cutting speed of a tool in a material, mm/s, and where it comes from."""
    if machine.only_stated_limits:
        return SourcedBound()
    if tool.max_cutting_speed is not None:
        return SourcedBound(bound=tool.max_cutting_speed, origin="its row of the tool table")
    grade = grade_of_table_tool(tool, material)
    at = CuttingConditions(
        machine=machine,
        material=material,
        cutting_material=tool.cutting_material,
        grade=grade,
        roughness=None,
    )
    bound = cutting_speed_window(at)[1]
    if grade is None or bound is None:
        return SourcedBound()
    is_own = bound == grade.max_cutting_speed
    window = find_window(material, tool.kind, tool.cutting_material)
    of_material = f"{tool.cutting_material} in {material.title}"
    if window is not None and not is_own:
        return SourcedBound(bound=bound, origin=of_material)
    return SourcedBound(bound=bound, origin=grade.borrowed or grade.source)


def _without_feeds(material: WorkMaterial) -> WorkMaterial:
    """Material without feeds of its own, which the vendor's take the place of."""
    return replace(material, max_feed_per_tooth=None, max_feed_per_tooth_ratio=None)


def _cut(tool: TableTool, grade: ToolGrade | None, *, is_finishing: bool) -> Cut:
    """Cut of a tool of the table; its setting has no meaning."""
    shape, known = tool.shape, _tool(tool, tool.shape)
    helix = tool.helix_angle
    if helix is None:
        helix = 0.0 if grade is None else grade.helix_angle
    return Cut(
        kind=_kind(tool),
        tool=known,
        tool_kind=tool.kind,
        diameter=shape.diameter if isinstance(shape, Cutter) else 0.0,
        # Feeds of a block raise no window that is borrowed from another group.
        programmed=Setting(feed=1e-6, depth=1.0, passes=1, speed=1.0),
        length=0.0,
        total_depth=1.0,
        is_depth_free=False,
        helix_angle=helix,
        corner_radius=_corner(shape),
        depth_bound=known.cutting_edge_length,
        parallel_land=grade.parallel_land if grade and tool.kind is ToolKind.FACEMILL else 0.0,
        is_finishing=is_finishing,
    )


def _kind(tool: TableTool) -> CutKind:
    if isinstance(tool.shape, Insert):
        return CutKind.TURNING if tool.shape.width is None else CutKind.GROOVING
    return CutKind.DRILLING if tool.kind in ENDS else CutKind.MILLING


def _corner(shape: Cutter | Insert) -> float:
    return shape.nose_radius if isinstance(shape, Insert) else shape.corner_radius


def _tool(tool: TableTool, shape: Cutter | Insert) -> Tool:
    """Tool with the data that the cutting physics needs."""
    if isinstance(shape, Insert):
        return Tool(
            id=tool.id,
            keyword="",
            corner_radius=shape.nose_radius,
            cutting_edge_angle=shape.cutting_edge_angle,
            width=shape.width,
            has_wiper=tool.has_wiper,
        )
    return Tool(
        id=tool.id,
        keyword="",
        diameter=shape.diameter,
        teeth=tool.teeth,
        corner_radius=shape.corner_radius,
        cutting_edge_length=None if isinf(shape.edge_length) else shape.edge_length,
        overhang=shape.overhang,
        cutting_edge_angle=shape.cutting_edge_angle,
        point_angle=shape.point_angle,
        centre_cutting=tool.centre_cutting,
    )


def _surfaces(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limits of all surfaces that a tool may leave."""
    for texture in TEXTURES.get(cut.tool_kind, ()):
        yield from surface_limits(replace(cut, texture=texture), at)


def _is_promised(cut: Cut, at: CuttingConditions) -> bool:
    """True unless the roughness of a surface stands on the programmed feed alone."""
    return all(limit.stands_for is None for limit in _surfaces(cut, at))


def _surface_feed(cut: Cut, at: CuttingConditions) -> float | None:
    """Greatest feed per tooth that keeps the roughness of all surfaces, mm; None: any."""
    feeds = [
        limit.feed_at_bound(1.0, 1.0)
        for limit in _surfaces(cut, at)
        if limit.sense is BoundSide.AT_MOST and limit.stands_for is None
    ]
    least = min(feeds, default=None)
    if least is not None and least <= 0.0:
        wanted = at.roughness or 0.0
        raise Infeasible(
            f"tool '{cut.tool.id}': no feed leaves a roughness of Ra {um_from_mm(wanted):g} µm",
            limits=(LimitName.ROUGHNESS,),
        )
    return least
