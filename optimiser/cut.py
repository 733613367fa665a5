"""One cut as the limits see it: geometry, tool and what is programmed, for one workingstep.

Whoever makes a :class:`Cut` (an estimate from the feature, or a tool path with the stock) knows
the part; the limits know the physics; the mathematics knows neither. Units: mm, rad, s, rev/s.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import asin, inf, pi

from optimiser.problem import Setting
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.flutes import CuttingEdges
from simulator.physics.slender_bar import BarSection
from simulator.spec import ToolKind
from stepnc_model.tool import Tool

LEAST_VOLUME = 1e-3
"""mm³; less is rounding"""


class CutKind(StrEnum):
    """Process of a cut, which selects its physics."""

    MILLING = "milling"
    DRILLING = "drilling"
    TURNING = "turning"
    GROOVING = "grooving"

    @property
    def is_turned(self) -> bool:
        """Whether the workpiece turns, not the tool."""
        return self in {CutKind.TURNING, CutKind.GROOVING}


class Texture(StrEnum):
    """Texture that the feed leaves on the finished surface."""

    CORNER_PER_REVOLUTION = "corner, one high tooth"
    """a turning insert, or the highest insert of a face mill"""
    CORNER_PER_TOOTH = "corner, all teeth equal"
    """the corner of a solid end mill"""
    WALL = "wall"
    """the side of an end mill"""
    NONE = "not described by the feed"


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalPlace:
    """A place of the path where a milling cutter cuts hard."""

    engagement: Engagement
    depth_share: float = 1.0
    """real depth over that of a pass"""
    fill: float = 1.0
    """section of the cut over that of the engagement"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlungeEngagement:
    """Engagement of a mill on its ways down into the material, with a feed of their own."""

    drilled: "tuple[Cut, ...]" = ()
    """straight down, as a drill would make it: where thrust and where power is greatest"""
    ramp: "Cut | None" = None
    """down a ramp, a helix or to and fro"""
    sine: float = 0.0
    """greatest rise of a ramp over its length"""
    reaches_axis: bool = False
    """whether material under the axis is met straight down"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReachedLoads:
    """Share of the greatest loads that the axes let happen; no limit counts on it.

    Axes that are slower at the hardest place thin its chip.
    """

    force: float = 1.0
    power: float = 1.0
    wall: float = 1.0
    """Wall of the force normal to the wall"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnedBar:
    """Shape that a turning path leaves of its bar, along z of the setup."""

    sections: tuple[BarSection, ...]
    """Sections of the bar as it is left, from the chuck's end on; mm from that end"""
    back: float
    """Back, mm, z of the chuck's end"""
    low: float
    """Low, mm, z of the cut that is nearest to the chuck"""
    high: float
    """High, mm, z of the cut that is farthest from it"""
    speed_ratio: float = 1.0
    """spindle speed where the cut is narrowest over that where the bar is widest …"""
    greatest_speed: float = inf
    """… which the spindle does not pass, rev/s"""

    def fastest(self, speed: float) -> float:
        """Greatest spindle speed in the cut, rev/s, of that where the bar is widest."""
        return max(speed, min(speed * self.speed_ratio, self.greatest_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """Cut of one workingstep."""

    kind: CutKind
    tool: Tool
    tool_kind: ToolKind
    diameter: float
    """mm at which the cutting speed is taken: of the tool, or mean one of the workpiece"""
    programmed: Setting
    length: float
    """Length, mm at cutting feed in one pass, approach and overrun included"""
    total_depth: float
    """Total depth, mm to remove, all passes together"""
    is_depth_free: bool
    """whether another number of passes would make the same part"""
    engagement: Engagement | None = None
    """Engagement of a milling cutter"""
    radial_width: float = 0.0
    """a_e of a milling cutter, width of a grooving insert"""
    depth_share: float = 1.0
    """greatest real depth over that of a pass: more where stock is left above"""
    fill: float = 1.0
    """section of the cut over that of the engagement"""
    chip_ratio: float | None = None
    """mean chip over feed per tooth; None: by the engagement, or a turning tool's edge"""
    width_ratio: float | None = None
    """greatest a_e/D along the path; None: where a milling cutter is engaged most"""
    chip_sine: float | None = None
    """greatest chip thickness over feed per tooth along the path; likewise"""
    shank: CriticalPlace | None = None
    """where the force across an end mill's axis is greatest; None: where it is engaged most"""
    wall: CriticalPlace | None = None
    """where the force normal to the wall that it makes is; None: where it is engaged most"""
    helix_angle: float = 0.0
    """Helix angle, rad, of a milling cutter's edges"""
    power_diameter: float | None = None
    """mm at which the force, at the spindle speed of the cut, takes the greatest power: the
    spindle may follow the tip, and the force acts in the middle of the cut; None: its own"""
    power_speed: float = 1.0
    """spindle speed there over that of the cut"""
    thickest: float = 1.0
    """greatest chip of a drill over that of the feed: a strategy may slow the spindle alone"""
    reached: ReachedLoads = ReachedLoads()
    load_share: float = 1.0
    """mean load over the length at cutting feed, air included, over the greatest"""
    previous_diameter: float = 0.0
    """Previous diameter, mm, of the hole before a drill, reamer or boring bar"""
    widest_drilled: float | None = None
    """mm, of the hole that the lips of a drill make where they cut most; None: its own"""
    link_length: float = 0.0
    """Link length, mm at rapid in one pass"""
    rest_time: float = 0.0
    """s in one pass beside the length at cutting feed: ramps, rapids, own feeds, waits"""
    air_length: float = 0.0
    """Air length, mm of the length that removes nothing"""
    volume: float | None = None
    """Volume, mm³ that are removed; None: not known"""
    texture: Texture = Texture.NONE
    corner_radius: float = 0.0
    """Corner radius, mm, the radius that marks the surface"""
    parallel_land: float = 0.0
    """Parallel land, mm of edge that smooths the surface instead; 0: none"""
    is_fed_inwards: bool = False
    """an insert is fed towards the axis: its feed force bends the bar, not its back force"""
    turned: TurnedBar | None = None
    """what a turning path makes of the bar; None: not known"""
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
    way_in: PlungeEngagement | None = None
    """ways down that a feed of their own may run; None: none meets material"""

    @property
    def bare(self) -> "Cut":
        """The same without what was met along its passes, and without a surface to leave."""
        return replace(
            self,
            engagement=None,
            shank=None,
            wall=None,
            depth_share=1.0,
            fill=1.0,
            chip_ratio=None,
            reached=ReachedLoads(),
            texture=Texture.NONE,
            floor=None,
            plunge=None,
            way_in=None,
        )

    @property
    def as_drill(self) -> "Cut":
        """The mill as a drill of its diameter with flat lips, in the solid."""
        tool = replace(self.tool, point_angle=pi)
        return replace(self.bare, kind=CutKind.DRILLING, tool=tool)

    @property
    def hardest(self) -> CriticalPlace | None:
        """Places of the path where a milling cutter is engaged most."""
        if self.engagement is None:
            return None
        return CriticalPlace(
            engagement=self.engagement, depth_share=self.depth_share, fill=self.fill
        )

    @property
    def mean_chip_ratio(self) -> float:
        """Mean chip over the feed per tooth of a milling cutter where it is engaged most."""
        if self.chip_ratio is not None:
            return self.chip_ratio
        if self.engagement is None:
            return 1.0
        return mean_chip_ratio(self.engagement, cutting_edge_angle=self.tool.cutting_edge_angle)

    @property
    def turning_edge_angle(self) -> float:
        """κ of the edge that turns, rad: by the mean chip as met, else as the tool has it."""
        if self.chip_ratio is None:
            return self.tool.cutting_edge_angle
        return asin(min(self.chip_ratio, 1.0))

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
            return 0.5 * (self.drilled_diameter + self.previous_diameter)
        return self.diameter

    @property
    def drilled_diameter(self) -> float:
        """Outer diameter that the lips of a drill cut, mm: less than its own by its point."""
        return self.diameter if self.widest_drilled is None else self.widest_drilled

    @property
    def is_air(self) -> bool:
        """Whether the path meets no material."""
        return self.volume is not None and self.volume <= LEAST_VOLUME
