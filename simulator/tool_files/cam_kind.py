"""Kinds of tools as CAM systems of one family, Fusion and HSMWorks, name them."""

from simulator.spec import ToolKind

KINDS = {
    "flat end mill": ToolKind.ENDMILL,
    "end mill": ToolKind.ENDMILL,
    "bull nose end mill": ToolKind.ENDMILL,
    "ball end mill": ToolKind.ENDMILL,
    "tapered mill": ToolKind.ENDMILL,
    "chamfer mill": ToolKind.ENDMILL,
    "face mill": ToolKind.FACEMILL,
    "drill": ToolKind.DRILL,
    "center drill": ToolKind.CENTER_DRILL,
    "spot drill": ToolKind.CENTER_DRILL,
    "counter sink": ToolKind.COUNTERSINK,
    "counter bore": ToolKind.COUNTERSINK,
    "reamer": ToolKind.REAMER,
    "boring bar": ToolKind.BORING_BAR,
    "boring head": ToolKind.BORING_BAR,
    "tap right hand": ToolKind.TAP,
    "tap left hand": ToolKind.TAP,
    "thread mill": ToolKind.TAP,
    "turning general": ToolKind.TURNING,
    "turning boring": ToolKind.TURNING,
    "turning threading": ToolKind.THREADING,
    "turning grooving": ToolKind.GROOVING,
}
"""Kinds by the names of the file. The cut of taps and thread mills is not modelled."""

POINTED = {ToolKind.DRILL, ToolKind.CENTER_DRILL, ToolKind.COUNTERSINK}
"""Kinds whose point has an angle."""

PER_TOOTH = {ToolKind.ENDMILL, ToolKind.FACEMILL}
"""Kinds whose feed window is per tooth; that of all others is per revolution."""

FLAT = "counter bore"
"""Name of the countersink without a point."""


def kind_named(name: str) -> ToolKind | None:
    """Kind of a name; None for holders, probes and forms that the map cannot represent."""
    return KINDS.get(" ".join(name.lower().replace("_", " ").split()))
