"""A tool table: tools by their numbers, for NC code that comes without a STEP-NC program.

For a program that has its own tools it says what ISO 14649 has no attribute for.

One ``[[tool]]`` table a tool, units in the keys; what is absent is customary.

Windows of feed, speed and depth of a tool in a work material.

Where no source gives windows for the ISO group of the material, those of the nearest group that
is harder to cut take their place: its feeds, speeds and depths are smaller. A material that
names no group is taken as the hardest to cut of the groups that its data do not exclude. So a
material of which little is known gets the smallest windows.

Grade of a tool of a tool table: that of the library, with what the table says instead.

References
----------
.. [1] ISO 513: group H is hardened steel and chilled cast iron.
.. [2] ISO 4957: high-speed steels have 64 to 67 HRC after hardening and tempering.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from math import inf
from pathlib import Path
from typing import Annotated

from simulator.errors import LibraryError
from simulator.files.material_file import SpeedWindow
from simulator.files.toml_file import (
    FileTable,
    KeyFault,
    changed_keys,
    quantity,
    read_toml,
    require_together,
    require_whole,
    require_window,
)
from simulator.library import bare_tool, find_grade, load_material, material_names
from simulator.removal.cutter import ENDS, Cutter, Holder, Insert
from simulator.spec import CuttingMaterial, ToolGrade, ToolKind, WorkMaterial
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg

Number = Annotated[float, quantity(1, 1e6)]
Diameter = Annotated[float, quantity(0.01, 2_000, "mm")]
Length = Annotated[float, quantity(0, 2_000, "mm")]
Teeth = Annotated[float, quantity(1, 500)]
EdgeAngle = Annotated[float, quantity(0, 179, "°")]
HelixAngle = Annotated[float, quantity(0, 75, "°")]
TaperAngle = Annotated[float, quantity(0, 80, "°")]
PointAngle = Annotated[float, quantity(30, 180, "°")]
TrailingAngle = Annotated[float, quantity(0, 89, "°")]
VendorFeed = Annotated[float, quantity(1e-4, 10, "mm")]

TURNED = {ToolKind.TURNING, ToolKind.GROOVING, ToolKind.THREADING}
INSERT_KEYS = {
    "nose_radius_mm",
    "cutting_edge_angle_deg",
    "trailing_angle_deg",
    "width_mm",
    "inside",
    "max_depth_mm",
}
CUTTER_KEYS = {
    "diameter_mm",
    "corner_radius_mm",
    "taper_angle_deg",
    "point_angle_deg",
    "edge_length_mm",
    "holder_diameter_mm",
    "overhang_mm",
}
SEVERAL_EDGES = {ToolKind.ENDMILL, ToolKind.FACEMILL} | ENDS
"""Kinds of tools whose number of teeth no custom tells."""

CUSTOMARY_TRAILING_DEG = 5.0
"""what remains beside κ_r = 95° of the 80° of form C of ISO 1832"""

CUSTOMARY_POINT_DEG = {ToolKind.DRILL: 118.0, ToolKind.COUNTERSINK: 90.0}


class ToolHand(StrEnum):
    """Hands of tools as the file spells them."""

    RIGHT = "right"
    LEFT = "left"
    NEUTRAL = "neutral"


@dataclass(frozen=True, slots=True, kw_only=True)
class TableTool:
    """One tool of the table."""

    number: int
    id: str
    kind: ToolKind
    cutting_material: CuttingMaterial
    teeth: int
    shape: Cutter | Insert
    helix_angle: float | None = None
    """Helix angle, rad; None: that of the grade"""
    centre_cutting: bool | None = None
    """whether the edges of a mill reach its axis; None: not said"""
    hand: HandOfToolType = HandOfToolType.RIGHT
    """Hand of the tool; a rotating tool that cuts both ways is neutral"""
    has_wiper: bool = False
    """whether a flat beside the nose of a turning insert smooths the surface"""
    grade: str = ""
    """The vendor's name of the grade; empty: not said"""
    min_feed: float | None = None
    """Least feed that the vendor recommends, mm per tooth of mills, else per revolution"""
    max_feed: float | None = None
    """Greatest feed that the vendor recommends, mm per tooth of mills, else per revolution"""
    max_depth: float | None = None
    """Greatest depth of cut of an insert that the vendor recommends, mm"""
    min_cutting_speed: float | None = None
    """Least cutting speed that the vendor recommends, mm/s"""
    max_cutting_speed: float | None = None
    """Greatest cutting speed that the vendor recommends, mm/s"""


class ToolRow(SpeedWindow, frozen=True, kw_only=True):
    """One ``[[tool]]`` row; its windows of feed and speed are those of the vendor."""

    number: Number
    kind: ToolKind
    id: str | None = None
    cutting_material: CuttingMaterial = CuttingMaterial.CARBIDE
    teeth: Teeth | None = None
    helix_deg: HelixAngle | None = None
    centre_cutting: bool | None = None
    wiper: bool = False
    diameter_mm: Diameter | None = None
    corner_radius_mm: Length = 0.0
    taper_angle_deg: TaperAngle = 0.0
    point_angle_deg: PointAngle | None = None
    edge_length_mm: Length = 0.0
    holder_diameter_mm: Diameter | None = None
    overhang_mm: Diameter | None = None
    nose_radius_mm: Length = 0.0
    cutting_edge_angle_deg: EdgeAngle = 90.0
    trailing_angle_deg: TrailingAngle = CUSTOMARY_TRAILING_DEG
    width_mm: Diameter | None = None
    hand: ToolHand = ToolHand.RIGHT
    inside: bool = False
    grade: str = ""
    min_feed_mm: VendorFeed | None = None
    max_feed_mm: VendorFeed | None = None
    max_depth_mm: Diameter | None = None

    def __post_init__(self) -> None:
        require_window(self, "min_cutting_speed_m_min", "max_cutting_speed_m_min")
        require_together(self, "min_cutting_speed_m_min", "max_cutting_speed_m_min")
        require_window(self, "min_feed_mm", "max_feed_mm")
        require_whole(self, "number")
        if self.teeth is not None:
            require_whole(self, "teeth")
        require_together(self, "holder_diameter_mm", "overhang_mm")
        self._require_keys_of_its_kind()
        if self.wiper and self.kind is not ToolKind.TURNING:
            raise KeyFault("wiper", f"is of turning inserts, not of kind {self.kind}")
        if self.kind is ToolKind.GROOVING and self.width_mm is None:
            raise KeyFault("width_mm", "missing; a grooving blade has a width")
        if self.kind in TURNED:
            self.insert()  # refuses what fits no blade
        elif self.diameter_mm is None:
            raise KeyFault("diameter_mm", "missing; expected a number, 0.01 to 2000 mm")
        elif 2.0 * self.corner_radius_mm > self.diameter_mm:
            radius, most = self.corner_radius_mm, 0.5 * self.diameter_mm
            message = f"{radius:g} mm exceeds half the diameter, {most:g} mm"
            raise KeyFault("corner_radius_mm", message)

    def _require_keys_of_its_kind(self) -> None:
        """Refuse dimensions of an insert on a cutter, and of a cutter on an insert."""
        others = CUTTER_KEYS if self.kind in TURNED else INSERT_KEYS
        for key in others.intersection(changed_keys(self)):
            known = sorted(set(self.__struct_fields__) - others)
            message = f"unknown key of kind {self.kind}; known here: {', '.join(known)}"
            raise KeyFault(key, message)

    @property
    def edges(self) -> int:
        """Number of teeth; one where the row gives none."""
        return 1 if self.teeth is None else int(self.teeth)

    @property
    def lacks_teeth(self) -> bool:
        """True if the number of teeth is unknown of a tool that usually has several."""
        return self.teeth is None and self.kind in SEVERAL_EDGES

    def insert(self) -> Insert:
        """Shape of a turning tool."""
        return Insert(
            nose_radius=self.nose_radius_mm,
            cutting_edge_angle=rad_from_deg(self.cutting_edge_angle_deg),
            trailing_angle=rad_from_deg(self.trailing_angle_deg),
            width=self.width_mm,
            hand=HandOfToolType[self.hand.name],
            is_inside=self.inside,
        )

    def cutter(self) -> Cutter:
        """Shape of a rotating tool."""
        point, holder = self.point_angle_deg, None
        if point is None:
            point = CUSTOMARY_POINT_DEG.get(self.kind, 180.0)
        if self.holder_diameter_mm is not None and self.overhang_mm is not None:
            holder = Holder(diameter=self.holder_diameter_mm, overhang=self.overhang_mm)
        return Cutter(
            diameter=self.diameter_mm or 0.0,
            corner_radius=self.corner_radius_mm,
            taper_angle=rad_from_deg(self.taper_angle_deg),
            point_angle=rad_from_deg(point),
            teeth=self.edges,
            edge_length=self.edge_length_mm or inf,
            is_drill=self.kind in ENDS,
            holder=holder,
        )


def tool_of_row(row: ToolRow) -> TableTool:
    """Tool of a row, in canonical units."""
    number, helix = int(row.number), row.helix_deg
    return TableTool(
        number=number,
        id=f"{row.kind} T{number}" if row.id is None else row.id,
        kind=row.kind,
        cutting_material=row.cutting_material,
        teeth=row.edges,
        shape=row.insert() if row.kind in TURNED else row.cutter(),
        helix_angle=None if helix is None else rad_from_deg(helix),
        centre_cutting=row.centre_cutting,
        hand=HandOfToolType[row.hand.name],
        has_wiper=row.wiper,
        grade=row.grade,
        min_feed=row.min_feed_mm,
        max_feed=row.max_feed_mm,
        max_depth=row.max_depth_mm,
        min_cutting_speed=row.speeds[0],
        max_cutting_speed=row.speeds[1],
    )


def reaches_centre(tool: TableTool) -> bool | None:
    """True if the edges of a mill reach its axis; None if neither table nor form tells it."""
    if tool.centre_cutting is not None or not isinstance(tool.shape, Cutter):
        return tool.centre_cutting
    if tool.kind is ToolKind.FACEMILL:
        return False
    is_ball = tool.shape.corner_radius >= 0.5 * tool.shape.diameter
    return True if is_ball else None


class ToolFile(FileTable, frozen=True, kw_only=True):
    """A whole tool table."""

    tool: tuple[ToolRow, ...] = ()

    def __post_init__(self) -> None:
        numbers = [row.number for row in self.tool]
        for at, number in enumerate(numbers, start=1):
            if numbers.count(number) > 1:
                raise KeyFault(f"tool[{at}].number", f"T{number:g} is there twice")


def read_tool_rows(path: Path) -> tuple[ToolRow, ...]:
    """Rows of a TOML file.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range, or a number is there twice.
    """
    rows = read_toml(path, ToolFile).tool
    if not rows:
        raise LibraryError("has no [[tool]]", path=str(path))
    return rows


GROUPS = "NKPMSH"
"""ISO groups, the easiest to cut first: in this order feeds and depths of the library fall."""

HARD = "H"
"""Group of hardened steel and chilled iron: nothing is too hard for it."""

BEYOND = 1.2
"""Factor by which a value may lie beyond those of the library's materials of a group: the
spread of k_c between catalogues."""

DENSITY_BEYOND = 1.05
"""The same factor for the density, which depends on the alloy alone."""

CHIP = 0.1
"""Chip thickness at which specific cutting forces are compared, mm."""


def grade_for(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, material: WorkMaterial
) -> ToolGrade | None:
    """Tool for a material: with its own windows, else the nearest on the safe side, else none.

    Returns
    -------
    ToolGrade or None
        None if the library has no such tool. Borrowed windows say so; a tool without windows
        has no greatest feed.
    """
    groups = possible_groups(material)
    hardest = groups[-1]
    for group in GROUPS[GROUPS.index(hardest) :]:
        grade = _grade(tool_kind, cutting_material, group)
        if grade is not None:
            return replace(grade, borrowed=_why(grade, material, group))
    easier = reversed(groups[:-1])
    for grade in (_grade(tool_kind, cutting_material, group) for group in easier):
        if grade is not None:
            return replace(grade, borrowed=_why(grade, material, grade.iso_group))
    return bare_tool(tool_kind, cutting_material)


def _grade(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, group: str
) -> ToolGrade | None:
    """Grade of a kind of tool for one ISO group; None if there is none."""
    try:
        return find_grade(tool_kind, cutting_material, group)
    except LibraryError:
        return None


def _why(grade: ToolGrade, material: WorkMaterial, group: str) -> str:
    """Reason why windows of a group are used; empty if it is that of the material."""
    if material.iso_group == group:
        return ""
    if material.iso_group:
        return (
            f"the windows of ISO group {group}, the nearest that is harder to cut: no source "
            f"gives {grade.cutting_material} in group {material.iso_group}"
        )
    groups = possible_groups(material)
    of = f"the hardest to cut of {', '.join(groups)}" if len(groups) > 1 else "as its data say"
    return f"the windows of ISO group {group}, {of}: material '{material.name}' names no group"


def why_unsuited(cutting_material: CuttingMaterial, material: WorkMaterial) -> str:
    """Reason why an edge cannot cut a material at all; empty if it can.

    High-speed steel is hardly harder than group H [1]_, [2]_.
    """
    if cutting_material is not CuttingMaterial.HSS or possible_groups(material) != (HARD,):
        return ""
    return (
        f"high-speed steel (64 to 67 HRC) does not cut {material.title}, ISO group H: use "
        "carbide, ceramic or CBN"
    )


def possible_groups(material: WorkMaterial) -> tuple[str, ...]:
    """ISO groups that a material may belong to, the easiest to cut first.

    That of its file, else those that hardness, strength, density and specific cutting force do
    not exclude; all if no group fits.
    """
    if material.iso_group:
        return (material.iso_group,)
    values = _values(material)
    fitting = tuple(group for group in GROUPS if _fits(group, values))
    return fitting or tuple(GROUPS)


def _fits(group: str, values: tuple[float | None, ...]) -> bool:
    """True if no known value lies beyond those of the group."""
    ranges = _ranges()[group]
    return all(
        value is None or low <= value <= high
        for value, (low, high) in zip(values, ranges, strict=True)
    )


def _values(material: WorkMaterial) -> tuple[float | None, ...]:
    """Hardness, tensile strength, density and specific cutting force of a material."""
    law = material.kienzle
    force = law.k_c11 * CHIP**-law.m_c
    return material.hardness_hb, material.tensile_strength, material.density, force


@cache
def _ranges() -> dict[str, tuple[tuple[float, float], ...]]:
    """Ranges of the values of each group, from the materials of the library."""
    known: dict[str, list[tuple[float | None, ...]]] = {group: [] for group in GROUPS}
    for name in material_names():
        material = load_material(name)
        if material.iso_group:
            known[material.iso_group].append(_values(material))
    return {
        group: tuple(
            _range(column, group, place) for place, column in enumerate(zip(*rows, strict=True))
        )
        for group, rows in known.items()
    }


def _range(column: tuple[float | None, ...], group: str, place: int) -> tuple[float, float]:
    """Least and greatest value of a property in a group, widened; unbounded if unknown."""
    values = [value for value in column if value is not None]
    if not values:
        return 0.0, inf
    beyond = DENSITY_BEYOND if place == 2 else BEYOND
    high = inf if group == HARD and place != 2 else beyond * max(values)
    return min(values) / beyond, high


def grade_of_table_tool(tool: TableTool, material: WorkMaterial) -> ToolGrade | None:
    """Grade of a tool in a material.

    The vendor's windows of feed, speed and depth, helix angle and name of the grade replace
    those of the library where the table gives them.

    Returns
    -------
    ToolGrade or None
        None if the library has no grade of this kind for the material.
    """
    grade = grade_for(tool.kind, tool.cutting_material, material)
    if grade is None:
        return None
    if tool.helix_angle is not None:
        grade = replace(grade, helix_angle=tool.helix_angle)
    if tool.grade:
        grade = replace(grade, name=tool.grade)
    if tool.min_feed is not None or tool.max_feed is not None:
        # A window in mm takes the place of one relative to the diameter.
        grade = replace(
            grade,
            min_feed_ratio=None,
            max_feed_ratio=None,
            min_feed=tool.min_feed,
            max_feed=tool.max_feed,
            borrowed="" if tool.max_feed is not None else grade.borrowed,
        )
    if tool.max_depth is not None:
        grade = replace(grade, max_depth=tool.max_depth)
    if tool.min_cutting_speed is not None or tool.max_cutting_speed is not None:
        grade = replace(
            grade,
            min_cutting_speed=tool.min_cutting_speed,
            max_cutting_speed=tool.max_cutting_speed,
        )
    return grade
