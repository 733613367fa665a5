"""Tool library of FreeCAD: ``.fctl``, which numbers the tool bits of ``.fctb`` files.

Both are JSON. A tool bit has a shape and parameters with units, such as ``"5.0000 mm"`` and
``"0.375 in"``; lengths without one are millimetres. Its files lie beside the library or in
the folder ``Bit`` beside its own, as FreeCAD keeps them. A tool bit alone is number 1.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simulator.errors import LibraryError
from simulator.files.toml_file import read_text
from simulator.spec import ToolKind
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.json_text import list_in, object_in, parsed_json, shown
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
from stepnc_model.errors import Finding

BITS = "Bit"
"""Folder of tool bits, beside that of the libraries."""

KINDS = {
    "endmill": ToolKind.ENDMILL,
    "ballend": ToolKind.ENDMILL,
    "bullnose": ToolKind.ENDMILL,
    "taperedballnose": ToolKind.ENDMILL,
    "chamfer": ToolKind.ENDMILL,
    "vbit": ToolKind.ENDMILL,
    "drill": ToolKind.DRILL,
    "reamer": ToolKind.REAMER,
    "tap": ToolKind.TAP,
    "threadmill": ToolKind.TAP,
}
"""Kinds by shape, in lower case without hyphens. The cut of taps is not modelled."""

UNITS = {
    "": FileUnit.MM,
    "mm": FileUnit.MM,
    "in": FileUnit.INCH,
    "inch": FileUnit.INCH,
    '"': FileUnit.INCH,
}

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S*)\s*$")

Values = dict[str, FileValue]


def read_freecad(content: Mapping[str, Any], path: Path) -> ToolRows:
    """Read the tool bits of a library, or one tool bit.

    Parameters
    ----------
    content : mapping
        The JSON document.
    path : Path
        The file, for messages, and beside which the tool bits lie.

    Raises
    ------
    LibraryError
        With the file of the tool bit, the parameter, the value, the bound and the unit.
    """
    if "tools" not in content:
        found = _bit(content, path, number=FileValue(value=1, place="number"))
        note = assumed(f"'{content.get('name', '')}'", "a tool bit has no number: it is T1")
        return ToolRows(rows=found.rows, findings=(note, *found.findings))
    rows: list[PlacedRow] = []
    findings: list[Finding] = []
    for index, entry in enumerate(list_in(content, "tools", path, place="")):
        place = f"tools[{index}]"
        if not isinstance(entry, dict):
            raise LibraryError(f"{shown(entry)} is not an object", path=str(path), key=place)
        for key in ("nr", "path"):
            if key not in entry:
                message = "missing; a tool has a number nr and a path"
                raise LibraryError(message, path=str(path), key=f"{place}.{key}")
        number = FileValue(value=entry["nr"], place=f"{path.name}: {place}.nr")
        file = _file(entry["path"], path, f"{place}.path")
        found = _bit(parsed_json(read_text(file), file), file, number=number)
        rows += found.rows
        findings += found.findings
    return ToolRows(rows=tuple(rows), findings=tuple(findings))


def _file(name: object, library: Path, place: str) -> Path:
    """File of a tool bit, by its name alone: a library cannot lead elsewhere."""
    if not isinstance(name, str) or Path(name).name != name or name in {"", ".", ".."}:
        message = f"{shown(name)} is not the name of a file"
        raise LibraryError(message, path=str(library), key=place)
    folders = (library.parent, library.parent / BITS, library.parent.parent / BITS)
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    message = f"'{name}' is neither beside the library nor in the folder {BITS}"
    raise LibraryError(message, path=str(library), key=place)


def _bit(content: Mapping[str, Any], path: Path, *, number: FileValue) -> ToolRows:
    """Row of a tool bit, or the finding that it cannot be used."""
    stem = str(content.get("shape-type") or Path(str(content.get("shape", ""))).stem)
    shape = stem.lower().replace("-", "").replace("_", "")
    name = str(content.get("name") or path.stem)
    kind = KINDS.get(shape)
    if kind is None:
        reason = f"shape '{stem}' is not a cutter that can be represented"
        return ToolRows(rows=(), findings=(left_out(f"{path.name} '{name}'", reason),))
    parameters = {
        **object_in(content, "attribute", path, place=""),
        **object_in(content, "parameter", path, place=""),
    }
    given: Values = {
        "number": number,
        "id": FileValue(value=name, place="name"),
        "kind": FileValue(value=kind.value, place="shape"),
    }
    given |= _dimensions(parameters, shape)
    edge = edge_values(parameters.get("Material", ""), "parameter.Material")
    notes = [] if edge else ["no edge material is known: it is taken for carbide"]
    findings = tuple(assumed(f"{path.name} '{name}'", note) for note in notes)
    row = placed_row(given | edge, path)
    return ToolRows(rows=(row,), findings=findings)


def _dimensions(parameters: Mapping[str, Any], shape: str) -> Values:
    """Dimensions of a tool bit."""
    given: Values = {}

    def take(key: str, parameter: str) -> None:
        if parameter in parameters:
            given[key] = _length(parameters[parameter], f"parameter.{parameter}")

    take("diameter_mm", "Diameter")
    take("edge_length_mm", "CuttingEdgeHeight")
    if "Flutes" in parameters:
        given["teeth"] = _plain(parameters["Flutes"], "parameter.Flutes")
    if _size(parameters, "Chipload"):
        take("max_feed_mm", "Chipload")
    if shape in {"drill", "reamer"} and "TipAngle" in parameters and shape == "drill":
        given["point_angle_deg"] = _plain(parameters["TipAngle"], "parameter.TipAngle")
    if shape in {"ballend", "taperedballnose"}:
        radius = 0.5 * _size(parameters, "Diameter")
        given["corner_radius_mm"] = FileValue(value=radius, place="parameter.Diameter")
    if shape == "taperedballnose" and "TaperAngle" in parameters:
        half = _halved(parameters["TaperAngle"], "parameter.TaperAngle")
        given["taper_angle_deg"] = half
    if shape == "bullnose":
        given |= _bull_nose(parameters)
    if shape in {"chamfer", "vbit"}:
        given |= _cone(parameters)
    return given


def _bull_nose(parameters: Mapping[str, Any]) -> Values:
    """Corner radius of a bull nose; older files give the radius of the flat end instead."""
    if "CornerRadius" in parameters:
        place = "parameter.CornerRadius"
        return {"corner_radius_mm": _length(parameters["CornerRadius"], place)}
    if "FlatRadius" in parameters:
        radius = 0.5 * _size(parameters, "Diameter") - _size(parameters, "FlatRadius")
        return {"corner_radius_mm": FileValue(value=radius, place="parameter.FlatRadius")}
    return {}


def _cone(parameters: Mapping[str, Any]) -> Values:
    """Cone of a chamfer mill or V-bit: its angle is the included one."""
    if "CuttingEdgeAngle" not in parameters:
        return {}
    place = "parameter.CuttingEdgeAngle"
    if _size(parameters, "TipDiameter"):
        tip = _length(parameters["TipDiameter"], "parameter.TipDiameter")
        half = _halved(parameters["CuttingEdgeAngle"], place)
        return {"diameter_mm": tip, "taper_angle_deg": half}
    return {"point_angle_deg": _plain(parameters["CuttingEdgeAngle"], place)}


def _length(value: object, place: str) -> FileValue:
    """Length in mm; what is none stays as it is, to be refused."""
    found = _QUANTITY.match(value) if isinstance(value, str) else None
    if found is None:
        return file_length(value, place, FileUnit.MM)
    unit = UNITS.get(found[2].lower())
    if unit is None:
        return FileValue(value=value, place=place)
    return file_length(float(found[1]), place, unit)


def _size(parameters: Mapping[str, Any], key: str) -> float:
    """Length in mm; 0 if it is absent or none."""
    value = _length(parameters.get(key, 0.0), key).value
    return float(value) if isinstance(value, int | float) else 0.0


def _plain(value: object, place: str) -> FileValue:
    """Number of a count or of degrees."""
    found = _QUANTITY.match(value) if isinstance(value, str) else None
    if found is not None and found[2] in {"", "°", "deg"}:
        return FileValue(value=float(found[1]), place=place)
    return FileValue(value=value, place=place)


def _halved(value: object, place: str) -> FileValue:
    """Half of an included angle."""
    whole = _plain(value, place)
    if isinstance(whole.value, float):
        return FileValue(value=0.5 * whole.value, place=place)
    return whole
