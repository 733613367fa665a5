"""The tool grades of one kind of tool from its TOML file.

A file has one ``[edge.<cutting material>]`` table for what the whole tool has in common and
one ``[[grade]]`` row per cutting material and ISO group for its windows.
"""

from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Annotated, Literal

from simulator.files.material_file import Rake, SpeedWindow
from simulator.files.toml_file import FileTable, KeyFault, quantity, read_toml, require_window
from simulator.spec import CuttingMaterial, ToolGrade, ToolKind
from simulator.tool_windows import DepthWindow, DrillPoint, FeedWindow, ReamingAllowance
from stepnc_model.units import rad_from_deg

ANY_GROUP = "*"
"""the grade serves every ISO group"""

GradeGroup = Literal["P", "M", "K", "N", "S", "H", "*"]
"""ISO 513 group that a grade serves"""

GradeFeedRatio = Annotated[float, quantity(1e-4, 0.2)]
GradeFeed = Annotated[float, quantity(1e-4, 10, "mm")]
DepthRatio = Annotated[float, quantity(0.001, 20)]
Depth = Annotated[float, quantity(0.01, 200, "mm")]
ChipThickness = Annotated[float, quantity(1e-4, 0.1, "mm")]
YoungsModulus = Annotated[float, quantity(50_000, 1_000_000, "N/mm²")]
BendingStrength = Annotated[float, quantity(50, 5_000, "N/mm²")]
Helix = Annotated[float, quantity(0, 75, "°")]
ThrustShare = Annotated[float, quantity(0.2, 1.5)]
ChiselRatio = Annotated[float, quantity(0, 0.4)]
WidthRatio = Annotated[float, quantity(0.05, 1)]
SlotFactor = Annotated[float, quantity(0.1, 1)]
LargestDiameter = Annotated[float, quantity(0.1, 2000, "mm")]
PilotRatio = Annotated[float, quantity(0.1, 1)]
LandWidth = Annotated[float, quantity(0.1, 20, "mm")]


class PointTable(FileTable, frozen=True, kw_only=True):
    """Point of a drill, with a source of its own."""

    thrust_share: ThrustShare
    chisel_ratio: ChiselRatio
    source: str


class FeedWindowTable(FileTable, frozen=True, kw_only=True):
    """Engagement at which the feeds hold, with a source of its own."""

    width_ratio: WidthRatio
    slot_factor: SlotFactor
    source: str


class DepthWindowTable(FileTable, frozen=True, kw_only=True):
    """Engagement at which the depths hold, with a source of its own."""

    width_ratio: WidthRatio
    slot_ratio: DepthRatio
    source: str


class SizesTable(FileTable, frozen=True, kw_only=True):
    """Diameters for which ratios of the diameter hold, with a source of its own."""

    largest_diameter_mm: LargestDiameter
    source: str


class PilotTable(FileTable, frozen=True, kw_only=True):
    """Pilot of a centre drill over its body, with a source of its own."""

    ratio: PilotRatio
    source: str


class AllowanceRow(FileTable, frozen=True, kw_only=True):
    """One ``[[allowance]]`` row: what a reamer up to a diameter takes off the diameter."""

    up_to_mm: LargestDiameter
    min_mm: GradeFeed
    max_mm: GradeFeed
    source: str


class LandTable(FileTable, frozen=True, kw_only=True):
    """Parallel land of the inserts, with a source of its own."""

    width_mm: LandWidth
    source: str


class EdgeTable(FileTable, frozen=True, kw_only=True):
    """Common data of all grades of a cutting material."""

    min_chip_thickness_mm: ChipThickness
    rake_angle_deg: Rake | None = None
    youngs_modulus_n_mm2: YoungsModulus
    bending_strength_n_mm2: BendingStrength
    helix_deg: Helix = 0.0
    source: str
    point: PointTable | None = None
    feed_window: FeedWindowTable | None = None
    parallel_land: LandTable | None = None
    depth_window: DepthWindowTable | None = None
    sizes: SizesTable | None = None
    pilot: PilotTable | None = None


class EdgeTables(FileTable, frozen=True, kw_only=True):
    """Edges by cutting material."""

    hss: EdgeTable | None = None
    carbide: EdgeTable | None = None
    ceramic: EdgeTable | None = None

    def of(self, material: CuttingMaterial) -> EdgeTable | None:
        """Edge of a cutting material."""
        edges = {
            CuttingMaterial.HSS: self.hss,
            CuttingMaterial.CARBIDE: self.carbide,
            CuttingMaterial.CERAMIC: self.ceramic,
        }
        return edges[material]


class GradeRow(SpeedWindow, frozen=True, kw_only=True):
    """One ``[[grade]]`` row; its cutting speeds replace those of the work material."""

    cutting_material: CuttingMaterial
    iso_group: GradeGroup
    min_feed_ratio: GradeFeedRatio | None = None
    max_feed_ratio: GradeFeedRatio | None = None
    min_feed_mm: GradeFeed | None = None
    max_feed_mm: GradeFeed | None = None
    max_depth_ratio: DepthRatio | None = None
    max_depth_mm: Depth | None = None
    source: str

    def __post_init__(self) -> None:
        require_window(self, "min_feed_ratio", "max_feed_ratio")
        require_window(self, "min_feed_mm", "max_feed_mm")
        require_window(self, "min_cutting_speed_m_min", "max_cutting_speed_m_min")
        if (self.speeds[0] is None) != (self.speeds[1] is None):
            raise ValueError("a cutting-speed window that replaces the material's has two ends")


class GradeFile(FileTable, frozen=True, kw_only=True):
    """A whole file of tool grades."""

    title: str
    edge: EdgeTables
    grade: tuple[GradeRow, ...] = ()
    allowance: tuple[AllowanceRow, ...] = ()

    def __post_init__(self) -> None:
        for at, row in enumerate(self.grade, start=1):
            if self.edge.of(row.cutting_material) is None:
                message = f"there is no [edge.{row.cutting_material}] table"
                raise KeyFault(f"grade[{at}].cutting_material", message)


def read_grades(path: Path, kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Grades of a kind of tool from a TOML file, in canonical units.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    file = read_toml(path, GradeFile)
    edges = ((row, file.edge.of(row.cutting_material)) for row in file.grade)
    return tuple(_grade(row, edge, kind) for row, edge in edges if edge is not None)


def read_tools(path: Path, kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Tools of a kind without windows, one of each cutting material; as :func:`read_grades`."""
    edges = read_toml(path, GradeFile).edge
    found = ((material, edges.of(material)) for material in CuttingMaterial)
    return tuple(_bare(material, edge, kind) for material, edge in found if edge is not None)


def _bare(material: CuttingMaterial, edge: EdgeTable, kind: ToolKind) -> ToolGrade:
    """Tool without windows: what it has in common for all groups."""
    row = GradeRow(cutting_material=material, iso_group="*", source="no windows")
    bare = _grade(row, edge, kind)
    name = f"{material} {kind.replace('_', ' ')}"
    return replace(bare, name=name, iso_group="", source=edge.source)


def _grade(row: GradeRow, edge: EdgeTable, kind: ToolKind) -> ToolGrade:
    """Grade of a row with what its tool has in common."""
    point, feeds, rake = edge.point, edge.feed_window, edge.rake_angle_deg
    return ToolGrade(
        name=f"{row.cutting_material} {kind.replace('_', ' ')} {row.iso_group}",
        tool_kind=kind,
        cutting_material=row.cutting_material,
        iso_group=row.iso_group,
        min_feed_ratio=row.min_feed_ratio,
        max_feed_ratio=row.max_feed_ratio,
        min_feed=row.min_feed_mm,
        max_feed=row.max_feed_mm,
        min_cutting_speed=row.speeds[0],
        max_cutting_speed=row.speeds[1],
        max_depth_ratio=row.max_depth_ratio,
        max_depth=row.max_depth_mm,
        min_chip_thickness=edge.min_chip_thickness_mm,
        youngs_modulus=edge.youngs_modulus_n_mm2,
        bending_strength=edge.bending_strength_n_mm2,
        rake_angle=None if rake is None else rad_from_deg(rake),
        source=f"{row.source}; {edge.source}",
        helix_angle=rad_from_deg(edge.helix_deg),
        point=None
        if point is None
        else DrillPoint(thrust_share=point.thrust_share, chisel_ratio=point.chisel_ratio),
        feed_window=None
        if feeds is None
        else FeedWindow(width_ratio=feeds.width_ratio, slot_factor=feeds.slot_factor),
        parallel_land=0.0 if edge.parallel_land is None else edge.parallel_land.width_mm,
        depth_window=None
        if edge.depth_window is None
        else DepthWindow(
            width_ratio=edge.depth_window.width_ratio, slot_ratio=edge.depth_window.slot_ratio
        ),
        largest_diameter=inf if edge.sizes is None else edge.sizes.largest_diameter_mm,
        pilot_ratio=1.0 if edge.pilot is None else edge.pilot.ratio,
    )


def read_allowances(path: Path) -> tuple[ReamingAllowance, ...]:
    """Allowances of reamers by diameter, the smallest first."""
    rows = sorted(read_toml(path, GradeFile).allowance, key=lambda row: row.up_to_mm)
    return tuple(
        ReamingAllowance(
            up_to=row.up_to_mm, least=row.min_mm, greatest=row.max_mm, source=row.source
        )
        for row in rows
    )
