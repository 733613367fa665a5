"""Cutting tools of a program as assets."""

import re
from collections.abc import Iterable
from math import isfinite
from xml.sax.saxutils import quoteattr

from extras.agent.model.agent import Asset
from extras.agent.model.documents import timestamp
from simulator.machine.virtual import LoadedTool
from simulator.removal.cutter import Cutter
from stepnc_model.units import deg_from_rad

KIND = "CuttingTool"


def asset_id(device: str, number: int) -> str:
    """Id of the asset of a tool in the magazine of a device."""
    return f"{device}.T{number}"


def tool_asset(tool: LoadedTool, *, device: str, uuid: str, index: int, time: int) -> Asset:
    """Asset of a tool: its identity and the lengths and angles of its edges.

    Parameters
    ----------
    device, uuid : str
        Name and uuid of the device that has it.
    index : int
        Of the device in the model.
    time : int, µs since 1970
    """
    id = asset_id(device, tool.number)
    words = (
        f"assetId={quoteattr(id)} serialNumber={quoteattr(str(tool.number))} "
        f"toolId={quoteattr(_token(tool.id))} timestamp={quoteattr(timestamp(time))} "
        f"deviceUuid={quoteattr(uuid)}"
    )
    body = (
        f"<CutterStatus><Status>{'USED' if tool.flank_wear else 'NEW'}</Status></CutterStatus>"
        f"<ProgramToolNumber>{tool.number}</ProgramToolNumber>"
        f"{_assembly(tool)}{_items(tool)}"
    )
    text = f"<{KIND} {words}><CuttingToolLifeCycle>{body}</CuttingToolLifeCycle></{KIND}>"
    return Asset(id=id, type=KIND, text=text, device=index)


def _token(text: str) -> str:
    """A text as a name token of XML, which ids of tools are: other signs become underscores."""
    return re.sub(r"[^\w.:-]", "_", text) or "_"


def _assembly(tool: LoadedTool) -> str:
    shape = tool.shape
    if not isinstance(shape, Cutter):
        return ""
    rows = [("CuttingDiameterMax", "DC", "MILLIMETER", shape.diameter)]
    if shape.holder is not None:
        rows.append(("ProtrudingLength", "LPR", "MILLIMETER", shape.holder.overhang))
    return _measurements(rows)


def _items(tool: LoadedTool) -> str:
    """Edges, all alike."""
    shape = tool.shape
    if shape is None:
        return ""
    if isinstance(shape, Cutter):
        count = shape.teeth
        rows = [
            ("CuttingEdgeLength", "L", "MILLIMETER", shape.edge_length),
            ("CornerRadius", "RE", "MILLIMETER", shape.corner_radius),
            ("PointAngle", "SIG", "DEGREE", deg_from_rad(shape.point_angle)),
        ]
    else:
        count = 1
        rows = [
            ("CornerRadius", "RE", "MILLIMETER", shape.nose_radius),
            ("ToolCuttingEdgeAngle", "KAPR", "DEGREE", deg_from_rad(shape.cutting_edge_angle)),
        ]
    span = "1" if count == 1 else f"1-{count}"
    return (
        f'<CuttingItems count="{count}"><CuttingItem indices="{span}">'
        f"{_measurements(rows)}</CuttingItem></CuttingItems>"
    )


def _measurements(rows: Iterable[tuple[str, str, str, float]]) -> str:
    inner = "".join(
        f'<{name} code="{code}" units="{units}">{value:.10g}</{name}>'
        for name, code, units, value in rows
        if isfinite(value)
    )
    return f"<Measurements>{inner}</Measurements>" if inner else ""
