"""The tool grades of one kind of tool from its TOML file.

A file has one ``[edge.<cutting material>]`` table for what the whole tool has in common and
one ``[[grade]]`` row per cutting material and ISO group for its windows.
"""

from simulator.material_file import ISO_GROUPS, RAKE, speed_window
from simulator.spec import CuttingMaterial, DrillPoint, FeedWindow, ToolGrade, ToolKind
from simulator.toml_file import Range, Table
from stepnc_model.units import rad_from_deg

ANY_GROUP = "*"
"""the grade serves every ISO group"""

FEED_RATIO = Range(low=1e-4, high=0.2)
FEED = Range(low=1e-4, high=10, unit="mm")
DEPTH_RATIO = Range(low=0.001, high=20)
DEPTH = Range(low=0.01, high=200, unit="mm")
CHIP_THICKNESS = Range(low=1e-4, high=0.1, unit="mm")
YOUNGS_MODULUS = Range(low=50_000, high=1_000_000, unit="N/mm²")
BENDING_STRENGTH = Range(low=50, high=5_000, unit="N/mm²")
HELIX = Range(low=0, high=75, unit="°")
THRUST_SHARE = Range(low=0.2, high=1.5)
CHISEL_RATIO = Range(low=0, high=0.4)
WIDTH_RATIO = Range(low=0.05, high=1)
SLOT_FACTOR = Range(low=0.1, high=1)
LAND = Range(low=0.1, high=20, unit="mm")


def read_grades(table: Table, kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Grades of a file's root table, in canonical units.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    edges = table.table("edge")
    shared = {
        material: edges.table(material) for material in CuttingMaterial if material in edges
    }
    grades = []
    for row in table.tables("grade"):
        material = row.choice("cutting_material", CuttingMaterial)
        if material not in shared:
            raise row.error("cutting_material", f"there is no [edge.{material}] table")
        grades.append(_grade(row, edge=shared[material], kind=kind, material=material))
    table.text("title")
    table.finish()
    return tuple(grades)


def _grade(row: Table, *, edge: Table, kind: ToolKind, material: CuttingMaterial) -> ToolGrade:
    """One ``[[grade]]`` row with what its tool has in common."""
    group = _group(row)
    low_ratio, high_ratio = row.window("min_feed_ratio", "max_feed_ratio", allowed=FEED_RATIO)
    low_feed, high_feed = row.window("min_feed_mm", "max_feed_mm", allowed=FEED)
    low_speed, high_speed = speed_window(row)
    if (low_speed is None) != (high_speed is None):
        raise row.error("", "a cutting-speed window that replaces the material's has two ends")
    rake = edge.optional_number("rake_angle_deg", RAKE)
    return ToolGrade(
        name=f"{material} {kind.replace('_', ' ')} {group}",
        tool_kind=kind,
        cutting_material=material,
        iso_group=group,
        min_feed_ratio=low_ratio,
        max_feed_ratio=high_ratio,
        min_feed=low_feed,
        max_feed=high_feed,
        min_cutting_speed=low_speed,
        max_cutting_speed=high_speed,
        max_depth_ratio=row.optional_number("max_depth_ratio", DEPTH_RATIO),
        max_depth=row.optional_number("max_depth_mm", DEPTH),
        min_chip_thickness=edge.number("min_chip_thickness_mm", CHIP_THICKNESS),
        youngs_modulus=edge.number("youngs_modulus_n_mm2", YOUNGS_MODULUS),
        bending_strength=edge.number("bending_strength_n_mm2", BENDING_STRENGTH),
        rake_angle=None if rake is None else rad_from_deg(rake),
        source=f"{row.text('source')}; {edge.text('source')}",
        helix_angle=rad_from_deg(edge.optional_number("helix_deg", HELIX) or 0.0),
        point=_point(edge),
        feed_window=_feed_window(edge),
        parallel_land=_parallel_land(edge),
    )


def _point(edge: Table) -> DrillPoint | None:
    """Point of a drill, with a source of its own."""
    if "point" not in edge:
        return None
    point = edge.table("point")
    point.text("source")
    return DrillPoint(
        thrust_share=point.number("thrust_share", THRUST_SHARE),
        chisel_ratio=point.number("chisel_ratio", CHISEL_RATIO),
    )


def _feed_window(edge: Table) -> FeedWindow | None:
    """Engagement of the feeds, with a source of its own."""
    if "feed_window" not in edge:
        return None
    window = edge.table("feed_window")
    window.text("source")
    return FeedWindow(
        width_ratio=window.number("width_ratio", WIDTH_RATIO),
        slot_factor=window.number("slot_factor", SLOT_FACTOR),
    )


def _parallel_land(edge: Table) -> float:
    """Width of the inserts' parallel land in mm, with a source of its own; 0 without one."""
    if "parallel_land" not in edge:
        return 0.0
    land = edge.table("parallel_land")
    land.text("source")
    return land.number("width_mm", LAND)


def _group(row: Table) -> str:
    """ISO 513 group of a row, or the mark for any."""
    group = row.text("iso_group")
    if group not in {*ISO_GROUPS, ANY_GROUP}:
        known = ", ".join((*ISO_GROUPS, ANY_GROUP))
        raise row.error("iso_group", f"'{group}' is none of {known}")
    return group
