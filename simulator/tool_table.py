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

TURNED = {ToolKind.TURNING, ToolKind.GROOVING, ToolKind.THREADING}
INSERT_KEYS = {"nose_radius_mm", "cutting_edge_angle_deg", "width_mm", "hand"}
CUTTER_KEYS = {
    "diameter_mm",
    "corner_radius_mm",
    "taper_angle_deg",
    "point_angle_deg",
    "edge_length_mm",
    "holder_diameter_mm",
    "overhang_mm",
}
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


class ToolRow(FileTable, frozen=True, kw_only=True):
    """One ``[[tool]]`` row."""

    number: Number
    kind: ToolKind
    id: str | None = None
    cutting_material: CuttingMaterial = CuttingMaterial.CARBIDE
    teeth: Teeth = 1.0
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
    width_mm: Diameter | None = None
    hand: TurningHand = TurningHand.RIGHT

    def __post_init__(self) -> None:
        require_whole(self, "number")
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

    def insert(self) -> Insert:
        """Shape of a turning tool."""
        return Insert(
            nose_radius=self.nose_radius_mm,
            cutting_edge_angle=rad_from_deg(self.cutting_edge_angle_deg),
            width=self.width_mm,
            hand=HandOfToolType[self.hand.name],
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
            teeth=int(self.teeth),
            edge_length=self.edge_length_mm or inf,
            is_drill=self.kind in ENDS,
            holder=holder,
        )


class ToolFile(FileTable, frozen=True, kw_only=True):
    """A whole tool table."""

    tool: tuple[ToolRow, ...] = ()

    def __post_init__(self) -> None:
        numbers = [row.number for row in self.tool]
        for at, number in enumerate(numbers, start=1):
            if numbers.count(number) > 1:
                raise KeyFault(f"tool[{at}].number", f"T{number:g} is there twice")


def read_tool_table(path: Path) -> tuple[TableTool, ...]:
    """Tools of a TOML file.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range, or a number is there twice.
    """
    rows = read_toml(path, ToolFile).tool
    if not rows:
        raise LibraryError("has no [[tool]]", path=str(path))
    return tuple(_tool(row) for row in rows)


def _tool(row: ToolRow) -> TableTool:
    number, helix = int(row.number), row.helix_deg
    return TableTool(
        number=number,
        id=f"{row.kind} T{number}" if row.id is None else row.id,
        kind=row.kind,
        cutting_material=row.cutting_material,
        teeth=int(row.teeth),
        shape=row.insert() if row.kind in TURNED else row.cutter(),
        helix_angle=None if helix is None else rad_from_deg(helix),
        centre_cutting=row.centre_cutting,
        has_wiper=row.wiper,
    )
