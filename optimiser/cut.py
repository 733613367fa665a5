"""One cut as the limits see it: geometry, tool and what is programmed, for one workingstep.

Whoever makes a :class:`Cut` (an estimate from the feature, or a tool path with the stock) knows
the part; the limits know the physics; the mathematics knows neither. Units: mm, rad, s, rev/s.
"""

from dataclasses import dataclass
from enum import StrEnum

from optimiser.problem import Setting
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.flutes import CuttingEdges
from simulator.spec import ToolKind
from stepnc_model.tool import Tool

LEAST_VOLUME = 1e-3
"""mm³; less is rounding"""


class CutKind(StrEnum):
    """Which physics applies."""

    MILLING = "milling"
    DRILLING = "drilling"
    TURNING = "turning"
    GROOVING = "grooving"


class Texture(StrEnum):
    """How the feed marks the finished surface."""

    CORNER_PER_REVOLUTION = "corner, one high tooth"
    """a turning insert, or the highest insert of a face mill"""
    CORNER_PER_TOOTH = "corner, all teeth equal"
    """the corner of a solid end mill"""
    WALL = "wall"
    """the side of an end mill"""
    NONE = "not described by the feed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A place of the path where a milling cutter cuts hard."""

    engagement: Engagement
    depth_share: float = 1.0
    """real depth over that of a pass"""
    fill: float = 1.0
    """section of the cut over that of the engagement"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """What one workingstep cuts."""

    kind: CutKind
    tool: Tool
    tool_kind: ToolKind
    diameter: float
    """mm at which the cutting speed is taken: of the tool, or mean one of the workpiece"""
    programmed: Setting
    length: float
    """mm at cutting feed in one pass, approach and overrun included"""
    total_depth: float
    """mm to remove, all passes together"""
    is_depth_free: bool
    """whether another number of passes would make the same part"""
    engagement: Engagement | None = None
    """of a milling cutter"""
    radial_width: float = 0.0
    """a_e of a milling cutter, width of a grooving insert"""
    depth_share: float = 1.0
    """greatest real depth over that of a pass: more where stock is left above"""
    fill: float = 1.0
    """section of the cut over that of the engagement"""
    chip_ratio: float | None = None
    """mean chip over feed per tooth; None: by the engagement"""
    shank: Place | None = None
    """where the force across an end mill's axis is greatest; None: where it is engaged most"""
    wall: Place | None = None
    """where the force normal to the wall that it makes is; None: where it is engaged most"""
    helix_angle: float = 0.0
    """rad, of a milling cutter's edges"""
    load_share: float = 1.0
    """mean load over the length at cutting feed, air included, over the greatest"""
    previous_diameter: float = 0.0
    """mm, of the hole before a drill, reamer or boring bar"""
    link_length: float = 0.0
    """mm at rapid in one pass"""
    rest_time: float = 0.0
    """s in one pass beside the length at cutting feed: ramps, rapids, own feeds, waits"""
    air_length: float = 0.0
    """mm of the length that removes nothing"""
    volume: float | None = None
    """mm³ that are removed; None: not known"""
    texture: Texture = Texture.NONE
    corner_radius: float = 0.0
    """mm, the radius that marks the surface"""
    is_finishing: bool = False
    """this workingstep leaves the surface"""
    is_finish_operation: bool = False
    """the operation is a finish by its kind, not only the last on its feature"""
    depth_bound: float | None = None
    """greatest depth of one pass that the tool allows, mm"""
    floor: "Cut | None" = None
    """the floor that is swept once, at its own depth, by an operation that cuts walls"""
    plunge: "Cut | None" = None
    """what a mill drills where it goes straight down into the solid at the feed of the cut"""

    @property
    def hardest(self) -> Place | None:
        """Where a milling cutter is engaged most."""
        if self.engagement is None:
            return None
        return Place(engagement=self.engagement, depth_share=self.depth_share, fill=self.fill)

    @property
    def mean_chip_ratio(self) -> float:
        """Mean chip over the feed per tooth of a milling cutter where it is engaged most."""
        if self.chip_ratio is not None:
            return self.chip_ratio
        if self.engagement is None:
            return 1.0
        return mean_chip_ratio(self.engagement, cutting_edge_angle=self.tool.cutting_edge_angle)

    @property
    def edges(self) -> CuttingEdges:
        """Edges of a milling cutter."""
        return CuttingEdges(
            teeth=self.tool.teeth,
            diameter=self.tool.diameter,
            helix_angle=self.helix_angle,
            corner_radius=min(self.tool.corner_radius or 0.0, 0.5 * self.tool.diameter),
            cutting_edge_angle=self.tool.cutting_edge_angle,
        )

    @property
    def force_diameter(self) -> float:
        """Diameter on which the cutting force acts, mm; of a drill the middle of its lips."""
        if self.kind is CutKind.DRILLING:
            return 0.5 * (self.diameter + self.previous_diameter)
        return self.diameter

    @property
    def is_air(self) -> bool:
        """Whether the path meets no material."""
        return self.volume is not None and self.volume <= LEAST_VOLUME
