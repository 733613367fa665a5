"""Tools that a file only names, described by the user."""

from dataclasses import dataclass

from stepnc_model.entities.enums import HandOfToolType


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenInsert:
    """Turning or grooving insert that a user describes; angles in rad."""

    cutting_edge_angle: float
    """Cutting edge angle κ_r."""
    trailing_angle: float
    """Angle κ_r' of the minor edge."""
    width: float | None = None
    """Width of a grooving blade, mm; None for a turning insert."""
    hand: HandOfToolType = HandOfToolType.RIGHT


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenTool:
    """Rotating tool or turning insert that a user describes."""

    number: int
    id: str
    body: str
    """EXPRESS name of its body, or of a turning tool, in capitals, such as ``ENDMILL``."""
    diameter: float
    """Diameter, mm; 0 for an insert."""
    teeth: int
    corner_radius: float = 0.0
    """Corner radius, mm."""
    edge_length: float | None = None
    """Length of the cutting edge, mm; None: not known."""
    overhang: float | None = None
    """Distance from the tip to the holder, mm; None: not known."""
    point_angle: float | None = None
    """Included angle of the point, rad; None: not known."""
    insert: GivenInsert | None = None
    """Shape of a turning or grooving insert; None for a rotating tool."""
    edge_material: str = ""
    """Name of the cutting material."""

    def is_named(self, name: str) -> bool:
        """True if a file's name of a tool is the id or the number of this one."""
        return name in {self.id, str(self.number), f"T{self.number}"}
