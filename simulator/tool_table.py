"""A tool table: tools by their numbers, for NC code that comes without a STEP-NC program.

For a program that has its own tools it says what ISO 14649 has no attribute for.

One ``[[tool]]`` table a tool, units in the keys; what is absent is customary.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf, pi
from pathlib import Path

from simulator.errors import LibraryError
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.removal.tool_shape import ENDS
from simulator.spec import CuttingMaterial, ToolKind
from simulator.toml_file import Range, Table, read_toml
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg

NUMBER = Range(low=1, high=1e6)
DIAMETER = Range(low=0.01, high=2_000, unit="mm")
LENGTH = Range(low=0, high=2_000, unit="mm")
TEETH = Range(low=1, high=500)
ANGLE = Range(low=0, high=179, unit="°")
HELIX = Range(low=0, high=75, unit="°")
TAPER = Range(low=0, high=80, unit="°")
POINT = Range(low=30, high=180, unit="°")

TURNED = {ToolKind.TURNING, ToolKind.GROOVING, ToolKind.THREADING}
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


def read_tool_table(path: Path) -> tuple[TableTool, ...]:
    """Tools of a TOML file.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range, or a number is there twice.
    """
    root = read_toml(path)
    rows = root.tables("tool")
    tools = tuple(_tool(row) for row in rows)
    root.finish()
    if not tools:
        raise LibraryError("has no [[tool]]", path=str(path))
    numbers = [tool.number for tool in tools]
    for row, number in zip(rows, numbers, strict=True):
        if numbers.count(number) > 1:
            raise row.error("number", f"T{number} is there twice")
    return tools


def _tool(row: Table) -> TableTool:
    kind = row.choice("kind", ToolKind)
    number = _whole(row, "number", NUMBER)
    name = row.text("id") if "id" in row else f"{kind} T{number}"
    material = CuttingMaterial.CARBIDE
    if "cutting_material" in row:
        material = row.choice("cutting_material", CuttingMaterial)
    teeth = _whole(row, "teeth", TEETH) if "teeth" in row else 1
    helix = row.optional_number("helix_deg", HELIX)
    return TableTool(
        number=number,
        id=name,
        kind=kind,
        cutting_material=material,
        teeth=teeth,
        shape=_insert(row, kind) if kind in TURNED else _cutter(row, kind, teeth),
        helix_angle=None if helix is None else rad_from_deg(helix),
        centre_cutting=row.flag("centre_cutting") if "centre_cutting" in row else None,
        has_wiper=_has_wiper(row, kind),
    )


def _has_wiper(row: Table, kind: ToolKind) -> bool:
    if "wiper" in row and kind is not ToolKind.TURNING:
        raise row.error("wiper", f"is of turning inserts, not of kind {kind}")
    return row.flag("wiper")


def _whole(row: Table, key: str, allowed: Range) -> int:
    number = row.number(key, allowed)
    if number != int(number):
        raise row.error(key, f"{number:g} is no whole number")
    return int(number)


def _insert(row: Table, kind: ToolKind) -> Insert:
    angle = row.optional_number("cutting_edge_angle_deg", ANGLE)
    width = row.optional_number("width_mm", DIAMETER)
    if kind is ToolKind.GROOVING and width is None:
        raise row.error("width_mm", "missing; a grooving blade has a width")
    hand = row.choice("hand", TurningHand) if "hand" in row else TurningHand.RIGHT
    try:
        return Insert(
            nose_radius=row.optional_number("nose_radius_mm", LENGTH) or 0.0,
            cutting_edge_angle=pi / 2.0 if angle is None else rad_from_deg(angle),
            width=width,
            hand=HandOfToolType[hand.name],
        )
    except ValueError as error:
        raise row.error("", str(error)) from error


def _cutter(row: Table, kind: ToolKind, teeth: int) -> Cutter:
    diameter = row.number("diameter_mm", DIAMETER)
    corner = row.optional_number("corner_radius_mm", LENGTH) or 0.0
    if 2.0 * corner > diameter:
        message = f"{corner:g} mm exceeds half the diameter, {0.5 * diameter:g} mm"
        raise row.error("corner_radius_mm", message)
    point = row.optional_number("point_angle_deg", POINT)
    if point is None:
        point = CUSTOMARY_POINT_DEG.get(kind, 180.0)
    return Cutter(
        diameter=diameter,
        corner_radius=corner,
        taper_angle=rad_from_deg(row.optional_number("taper_angle_deg", TAPER) or 0.0),
        point_angle=rad_from_deg(point),
        teeth=teeth,
        edge_length=row.optional_number("edge_length_mm", LENGTH) or inf,
        is_drill=kind in ENDS,
        holder=_holder(row),
    )


def _holder(row: Table) -> Holder | None:
    if "holder_diameter_mm" not in row and "overhang_mm" not in row:
        return None
    return Holder(
        diameter=row.number("holder_diameter_mm", DIAMETER),
        overhang=row.number("overhang_mm", LENGTH),
    )
