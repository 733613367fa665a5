"""A tool table: tools by their numbers, for NC code that comes without a STEP-NC program.

For a program that has its own tools it says what ISO 14649 has no attribute for.

One ``[[tool]]`` table a tool, units in the keys; what is absent is customary.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf
from pathlib import Path
from typing import Annotated

from simulator.errors import LibraryError
from simulator.material_file import SpeedWindow
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.removal.tool_shape import ENDS
from simulator.spec import CuttingMaterial, ToolKind
from simulator.toml_file import (
    FileTable,
    KeyFault,
    given_keys,
    quantity,
    read_toml,
    require_together,
    require_whole,
    require_window,
)
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
    "hand",
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


class TurningHand(StrEnum):
    """Hands of turning tools as the file spells them."""

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
    overhang_mm: Length | None = None
    nose_radius_mm: Length = 0.0
    cutting_edge_angle_deg: EdgeAngle = 90.0
    trailing_angle_deg: TrailingAngle = CUSTOMARY_TRAILING_DEG
    width_mm: Diameter | None = None
    hand: TurningHand = TurningHand.RIGHT
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
        for key in others.intersection(given_keys(self)):
            known = sorted(set(self.__struct_fields__) - others)
            message = f"unknown key of kind {self.kind}; known here: {', '.join(known)}"
            raise KeyFault(key, message)

    @property
    def edges(self) -> int:
        """Number of teeth; one where the row gives none."""
        return 1 if self.teeth is None else int(self.teeth)

    @property
    def lacks_teeth(self) -> bool:
        """Whether the number of teeth is unknown of a tool that usually has several."""
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
        has_wiper=row.wiper,
        grade=row.grade,
        min_feed=row.min_feed_mm,
        max_feed=row.max_feed_mm,
        max_depth=row.max_depth_mm,
        min_cutting_speed=row.speeds[0],
        max_cutting_speed=row.speeds[1],
    )


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
