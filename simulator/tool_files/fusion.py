"""Tool library of Autodesk Fusion: exported JSON, or ``.tools``, an archive of the same JSON.

Each tool names its unit, and the file its dimensions by symbols of ISO 13399: ``DC`` diameter,
``RE`` corner radius, ``NOF`` teeth, ``LCF`` length of the edge, ``LB`` length below the holder,
``SIG`` point angle, ``TA`` taper angle. Feeds and speeds are ``start-values`` of presets, a
feed per tooth ``f_z`` or per revolution ``f_n`` and a cutting speed ``v_c`` in m/min, or in
ft/min of tools in inches.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from simulator.errors import LibraryError
from simulator.spec import ToolKind
from simulator.tool_files.cam_kind import FLAT, PER_TOOTH, POINTED, kind_named
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.json_text import list_in, object_in, shown
from simulator.tool_files.placed_row import (
    FileValue,
    PlacedRow,
    ToolRows,
    assumed,
    edge_values,
    file_length,
    left_out,
    placed_row,
)
from simulator.tools.tool_table import TURNED, ToolHand
from stepnc_model.errors import Finding
from stepnc_model.units import MM_PER_FOOT, MM_PER_M

UNITS = {"millimeters": FileUnit.MM, "inches": FileUnit.INCH}


HANDS = {"R": ToolHand.RIGHT, "L": ToolHand.LEFT, "N": ToolHand.NEUTRAL}

Values = dict[str, FileValue]


def read_fusion(content: Mapping[str, Any], path: Path) -> ToolRows:
    """Read the tools of a library.

    Parameters
    ----------
    content : mapping
        The JSON document.
    path : Path
        The file, for messages.

    Raises
    ------
    LibraryError
        With the path to the value in the document, the value, the bound and the unit.
    """
    rows: list[PlacedRow] = []
    findings: list[Finding] = []
    for index, tool in enumerate(list_in(content, "data", path, place="")):
        place = f"data[{index}]"
        if not isinstance(tool, dict):
            raise LibraryError(f"{shown(tool)} is not an object", path=str(path), key=place)
        name = str(tool.get("description") or tool.get("type") or place)
        kind = kind_named(str(tool.get("type", "")))
        if kind is None:
            reason = f"type {shown(tool.get('type'))} is not a cutter that can be represented"
            findings.append(left_out(f"{place} '{name}'", reason))
            continue
        post = object_in(tool, "post-process", path, place=place)
        if not post.get("number"):
            findings.append(left_out(f"{place} '{name}'", "it has no number of the machine"))
            continue
        given, notes = _tool(tool, kind, path, place)
        given["number"] = FileValue(value=post["number"], place=f"{place}.post-process.number")
        rows.append(placed_row(given, path, place=place))
        findings += [assumed(f"{place} '{name}'", note) for note in notes]
    return ToolRows(rows=tuple(rows), findings=tuple(findings))


def _tool(
    tool: Mapping[str, Any], kind: ToolKind, path: Path, place: str
) -> tuple[Values, list[str]]:
    """Values of a tool, and what was assumed about it."""
    unit = _unit(tool, path, place)
    notes: list[str] = []
    given: Values = {"kind": FileValue(value=kind.value, place=f"{place}.type")}
    if tool.get("description"):
        given["id"] = FileValue(value=tool["description"], place=f"{place}.description")
    edge = edge_values(tool.get("BMC", ""), f"{place}.BMC")
    if not edge:
        notes.append(f"edge material {shown(tool.get('BMC'))} is taken for carbide")
    given |= edge
    if tool.get("grade"):
        given["grade"] = FileValue(value=tool["grade"], place=f"{place}.grade")
    geometry = object_in(tool, "geometry", path, place=place)
    holder = object_in(tool, "holder", path, place=place)
    if kind in TURNED:
        given |= _insert(tool, geometry, holder, unit=unit, place=place)
    else:
        given |= _cutter(str(tool.get("type")).lower(), kind, geometry, unit=unit, place=place)
        given |= _holder(geometry, holder, path, unit=unit, place=place)
    windows, note = _windows(tool, kind, path, unit=unit, place=place)
    return given | windows, notes + note


def _unit(tool: Mapping[str, Any], path: Path, place: str) -> FileUnit:
    unit = UNITS.get(str(tool.get("unit")))
    if unit is None:
        message = f"{shown(tool.get('unit'))} is not one of {', '.join(UNITS)}"
        raise LibraryError(message, path=str(path), key=f"{place}.unit")
    return unit


def _cutter(
    name: str, kind: ToolKind, geometry: Mapping[str, Any], *, unit: FileUnit, place: str
) -> Values:
    """Dimensions of a rotating tool."""
    at = f"{place}.geometry"
    given: Values = {}

    def take(key: str, symbol: str) -> None:
        if geometry.get(symbol):
            given[key] = file_length(geometry[symbol], f"{at}.{symbol}", unit)

    take("diameter_mm", "DC")
    take("edge_length_mm", "LCF")
    if geometry.get("NOF"):
        given["teeth"] = FileValue(value=geometry["NOF"], place=f"{at}.NOF")
    if geometry.get("HA"):
        given["helix_deg"] = FileValue(value=geometry["HA"], place=f"{at}.HA")
    if kind in POINTED:
        if name == FLAT:
            given["point_angle_deg"] = FileValue(value=180.0, place=f"{place}.type")
        elif geometry.get("SIG"):
            given["point_angle_deg"] = FileValue(value=geometry["SIG"], place=f"{at}.SIG")
        return given
    if name == "chamfer mill":
        return given | _chamfer(geometry, unit, at)
    if name == "ball end mill" and isinstance(geometry.get("DC"), int | float):
        radius = file_length(0.5 * geometry["DC"], f"{at}.DC", unit)
        return given | {"corner_radius_mm": radius}
    take("corner_radius_mm", "RE")
    if name == "tapered mill" and geometry.get("TA"):
        given["taper_angle_deg"] = FileValue(value=geometry["TA"], place=f"{at}.TA")
    return given


def _chamfer(geometry: Mapping[str, Any], unit: FileUnit, at: str) -> Values:
    """Cone of a chamfer mill: from its tip's diameter, or from a point."""
    angle, tip = geometry.get("TA"), geometry.get("tip-diameter")
    if not isinstance(angle, int | float) or isinstance(angle, bool):
        return {}
    if tip:
        return {
            "diameter_mm": file_length(tip, f"{at}.tip-diameter", unit),
            "taper_angle_deg": FileValue(value=angle, place=f"{at}.TA"),
        }
    return {"point_angle_deg": FileValue(value=2.0 * angle, place=f"{at}.TA")}


def _holder(
    geometry: Mapping[str, Any],
    holder: Mapping[str, Any],
    path: Path,
    *,
    unit: FileUnit,
    place: str,
) -> Values:
    """Lowest section of the holder, at the length below it; a holder may have its own unit."""
    segments = list_in(holder, "segments", path, place=f"{place}.holder")
    lowest = segments[0] if segments and isinstance(segments[0], dict) else {}
    width = lowest.get("lower-diameter")
    if not width or not geometry.get("LB"):
        return {}
    own = UNITS.get(str(holder.get("unit")), unit)
    at = f"{place}.holder.segments[0].lower-diameter"
    return {
        "holder_diameter_mm": file_length(width, at, own),
        "overhang_mm": file_length(geometry["LB"], f"{place}.geometry.LB", unit),
    }


def _insert(
    tool: Mapping[str, Any],
    geometry: Mapping[str, Any],
    holder: Mapping[str, Any],
    *,
    unit: FileUnit,
    place: str,
) -> Values:
    """Dimensions of a turning tool."""
    given: Values = {}
    at = f"{place}.geometry"
    if geometry.get("RE"):
        given["nose_radius_mm"] = file_length(geometry["RE"], f"{at}.RE", unit)
    for symbol in ("tool_grooveWidth", "tool_insertWidth"):
        if geometry.get(symbol) and str(tool.get("type")).endswith("grooving"):
            given["width_mm"] = file_length(geometry[symbol], f"{at}.{symbol}", unit)
            break
    hand = HANDS.get(str(holder.get("HAND")).upper())
    if hand is not None:
        given["hand"] = FileValue(value=hand, place=f"{place}.holder.HAND")
    if str(tool.get("type")).endswith("boring"):
        given["inside"] = FileValue(value=True, place=f"{place}.type")
    return given


def _windows(
    tool: Mapping[str, Any], kind: ToolKind, path: Path, *, unit: FileUnit, place: str
) -> tuple[Values, list[str]]:
    """Windows of feed and speed that the presets span, and a note if there are several."""
    start = object_in(tool, "start-values", path, place=place)
    presets = list_in(start, "presets", path, place=f"{place}.start-values")
    at = f"{place}.start-values.presets"
    foot = MM_PER_FOOT / MM_PER_M if unit is FileUnit.INCH else 1.0
    feed = "f_z" if kind in PER_TOOTH else "f_n"
    feeds = {row: unit.mm(value) for row, value in _positive(presets, feed)}
    speeds = {row: foot * value for row, value in _positive(presets, "v_c")}
    given: Values = {}
    for name, values, symbol in (
        ("feed_mm", feeds, feed), ("cutting_speed_m_min", speeds, "v_c"),
    ):  # fmt: skip
        for end, choose in (("min", min), ("max", max)):
            if values:
                row = choose(values, key=values.__getitem__)
                place_of = f"{at}[{row}].{symbol}"
                given[f"{end}_{name}"] = FileValue(value=values[row], place=place_of)
    count = max(len(feeds), len(speeds))
    note = [f"its windows of feed and speed span {count} presets"] if count > 1 else []
    return given, note


def _positive(presets: list[Any], key: str) -> Iterator[tuple[int, float]]:
    """Positive values of a key, by the index of the preset."""
    for row, preset in enumerate(presets):
        value = preset.get(key) if isinstance(preset, dict) else None
        if isinstance(value, int | float) and not isinstance(value, bool) and value > 0.0:
            yield row, float(value)
