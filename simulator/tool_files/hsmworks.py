"""Tool library of HSMWorks and its relatives: ``.hsmlib``, an XML document.

Each tool names its unit; ``nc`` has its number, ``body`` its dimensions, ``material`` that of
the edge, ``holder`` sections. Feeds and speeds are parameters of presets, or ``motion`` in
older files: the speed in rpm, the feed in the tool's unit per minute.
"""

import re
from collections.abc import Iterator, Mapping
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, cast

from simulator.errors import LibraryError
from simulator.spec import ToolKind
from simulator.tool_files.cam_kind import FLAT, PER_TOOTH, POINTED, kind_named
from simulator.tool_files.file_unit import FileUnit
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
from simulator.tools.tool_table import TURNED
from stepnc_model.errors import Finding
from stepnc_model.units import MM_PER_M

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

NAMESPACE = "http://www.hsmworks.com/xml/2004/cnc/tool-library"

ROOTS = ("tool-library", "tool-table")

UNITS = {"millimeters": FileUnit.MM, "inches": FileUnit.INCH}

LEAST_POINT = 30.0
"""Least angle, degrees, that counts as a point's and not as a taper's."""

_DECLARATION = re.compile(r"^\s*<\?xml[^>]*\?>[^\S\n]*")

Values = dict[str, FileValue]


def read_hsmworks(text: str, path: Path) -> ToolRows:
    """Read the tools of a library.

    Parameters
    ----------
    text : str
        The document; the encoding that it declares was that of the file.
    path : Path
        The file, for messages.

    Raises
    ------
    LibraryError
        With the line of the tool, the element, the value, the bound and the unit.
    """
    rows: list[PlacedRow] = []
    findings: list[Finding] = []
    for tool in _tools(text, path):
        line = _line(tool)
        name = _text(tool, "description") or str(tool.get("type", "tool"))
        kind = kind_named(str(tool.get("type", "")))
        if kind is None or kind in TURNED:
            reason = f"type '{tool.get('type', '')}' is not a cutter that can be represented"
            findings.append(left_out(f"'{name}'", reason, line=line))
            continue
        number = _attributes(tool, "nc").get("number", "")
        if number in {"", "0"}:
            reason = "it has no number of the machine"
            findings.append(left_out(f"'{name}'", reason, line=line))
            continue
        given, notes = _cutter(tool, kind, path, line)
        given["number"] = FileValue(value=_number(number), place="nc.number")
        given["id"] = FileValue(value=name, place="description")
        rows.append(placed_row(given, path, line=line))
        findings += [assumed(f"'{name}'", note, line=line) for note in notes]
    return ToolRows(rows=tuple(rows), findings=tuple(findings))


def _tools(text: str, path: Path) -> "list[Element]":
    """Elements of the tools."""
    from lxml import etree  # noqa: PLC0415 - slow to import, and few tables are XML

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, huge_tree=False, load_dtd=False
    )
    try:
        # A text in memory has no encoding: lxml refuses a declaration of one.
        root = etree.fromstring(_DECLARATION.sub("", text, count=1), parser)
    except etree.XMLSyntaxError as error:
        line = int(error.lineno or 0)
        raise LibraryError(f"is not XML: {error.msg}", path=str(path), line=line) from error
    name = etree.QName(root).localname
    if name not in ROOTS:
        raise LibraryError(f"root element {name}; expected {ROOTS[0]}", path=str(path))
    return [child for child in root if child.tag == f"{{{NAMESPACE}}}tool"]


def _line(tool: "Element") -> int:
    """Line of an element; 0 if it is unknown."""
    line = cast("int | None", tool.sourceline)
    return line or 0


def _attributes(tool: "Element", name: str) -> Mapping[str, str]:
    """Attributes of a child; empty without one."""
    child = tool.find(f"{{{NAMESPACE}}}{name}")
    return {} if child is None else {str(key): str(value) for key, value in child.items()}


def _text(tool: "Element", name: str) -> str:
    return str(tool.findtext(f"{{{NAMESPACE}}}{name}") or "").strip()


def _number(text: str) -> float | str:
    """Number of an attribute; a text that is none stays as it is, to be refused."""
    try:
        return float(text)
    except ValueError:
        return text


def _cutter(tool: "Element", kind: ToolKind, path: Path, line: int) -> tuple[Values, list[str]]:
    """Values of a rotating tool, and what was assumed about it."""
    unit = UNITS.get(str(tool.get("unit")))
    if unit is None:
        message = f"'{tool.get('unit')}' is not one of {', '.join(UNITS)}"
        raise LibraryError(message, path=str(path), key="tool.unit", line=line)
    body = _attributes(tool, "body")
    given: Values = {"kind": FileValue(value=kind.value, place="tool.type")}
    given |= _body(body, str(tool.get("type", "")).lower(), kind, unit)
    given |= _holder(tool, body, unit)
    material = _attributes(tool, "material").get("name", "")
    edge = edge_values(material, "material.name")
    notes = [] if edge else [f"edge material '{material}' is taken for carbide"]
    diameter, teeth = given.get("diameter_mm"), given.get("teeth")
    if diameter is not None and isinstance(diameter.value, float):
        count = teeth.value if teeth is not None and kind in PER_TOOTH else 1.0
        if isinstance(count, float) and count > 0.0:
            given |= _windows(tool, diameter.value, count, unit=unit)
    return given | edge, notes


def _body(body: Mapping[str, str], name: str, kind: ToolKind, unit: FileUnit) -> Values:
    """Dimensions of a body."""
    given: Values = {}

    def take(key: str, attribute: str) -> None:
        value = _number(body.get(attribute, "0"))
        if value != 0.0:
            given[key] = file_length(value, f"body.{attribute}", unit)

    take("diameter_mm", "diameter")
    take("edge_length_mm", "flute-length")
    if body.get("number-of-flutes", "0") != "0":
        value = _number(body["number-of-flutes"])
        given["teeth"] = FileValue(value=value, place="body.number-of-flutes")
    angle = _number(body.get("tip-angle", body.get("taper-angle", "0")))
    place = "body.tip-angle" if "tip-angle" in body else "body.taper-angle"
    if kind in POINTED:
        if name == FLAT:
            given["point_angle_deg"] = FileValue(value=180.0, place="tool.type")
        elif isinstance(angle, str) or angle >= LEAST_POINT:
            given["point_angle_deg"] = FileValue(value=angle, place=place)
        return given
    diameter = given.get("diameter_mm")
    if name == "ball end mill" and diameter is not None and isinstance(diameter.value, float):
        given["corner_radius_mm"] = FileValue(value=0.5 * diameter.value, place=diameter.place)
        return given
    if name in {"chamfer mill", "tapered mill"} and angle != 0.0:
        if name == "chamfer mill" and _number(body.get("tip-diameter", "0")) == 0.0:
            if isinstance(angle, float):
                angle = 2.0 * angle
            return given | {"point_angle_deg": FileValue(value=angle, place=place)}
        if name == "chamfer mill":
            take("diameter_mm", "tip-diameter")
        given["taper_angle_deg"] = FileValue(value=angle, place=place)
    take("corner_radius_mm", "corner-radius")
    return given


def _holder(tool: "Element", body: Mapping[str, str], unit: FileUnit) -> Values:
    """First section of the holder, at the length of the body below it."""
    section = tool.find(f"{{{NAMESPACE}}}holder/{{{NAMESPACE}}}section")
    length = _number(body.get("body-length", "0"))
    if section is None or length == 0.0 or not section.get("diameter"):
        return {}
    width = _number(str(section.get("diameter")))
    return {
        "holder_diameter_mm": file_length(width, "holder.section.diameter", unit),
        "overhang_mm": file_length(length, "body.body-length", unit),
    }


def _windows(tool: "Element", diameter: float, teeth: float, *, unit: FileUnit) -> Values:
    """Windows of feed and speed that presets span."""
    speeds, feeds = [], []
    for rpm, feed in _starts(tool):
        if rpm > 0.0:
            speeds.append(pi * diameter * rpm / MM_PER_M)
            if feed > 0.0:
                feeds.append(unit.mm(feed) / (rpm * teeth))
    given: Values = {}
    for name, values in (("feed_mm", feeds), ("cutting_speed_m_min", speeds)):
        if values:
            given[f"min_{name}"] = FileValue(value=min(values), place="presets")
            given[f"max_{name}"] = FileValue(value=max(values), place="presets")
    return given


def _starts(tool: "Element") -> Iterator[tuple[float, float]]:
    """Speed in rpm and feed in units per minute of each preset, or of the motion."""
    presets = tool.findall(f"{{{NAMESPACE}}}presets/{{{NAMESPACE}}}preset")
    for preset in presets:
        parameters = {
            str(each.get("key")): str(each.get("value"))
            for each in preset.findall(f"{{{NAMESPACE}}}parameter")
        }
        yield _start(parameters, "tool_spindleSpeed", "tool_feedCutting")
    if not presets:
        motion = _attributes(tool, "motion")
        if motion.get("feed-mode", "per-minute") == "per-minute":
            yield _start(motion, "spindle-rpm", "cutting-feedrate")


def _start(values: Mapping[str, str], speed: str, feed: str) -> tuple[float, float]:
    rpm, rate = _number(values.get(speed, "0")), _number(values.get(feed, "0"))
    return rpm if isinstance(rpm, float) else 0.0, rate if isinstance(rate, float) else 0.0
