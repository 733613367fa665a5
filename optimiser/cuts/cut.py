"""Geometry, tool and programmed setting of the cut of one workingstep.

The maker of a :class:`Cut` (an estimate from the feature, or a tool path with the stock) knows
the part; the limits know the physics; the solver knows neither. Units: mm, rad, s, rev/s.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import asin, inf, pi

from optimiser.solver.problem import Setting
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.flutes import CuttingEdges
from simulator.physics.slender_bar import BarSection
from simulator.spec import ToolKind
from stepnc_model.plurals import counted
from stepnc_model.programs.tool import Tool

LEAST_VOLUME = 1e-3
"""Least removed volume that counts as cutting, mm³; less is rounding."""


class CutKind(StrEnum):
    """Process of a cut, which selects its physics."""

    MILLING = "milling"
    DRILLING = "drilling"
    TURNING = "turning"
    GROOVING = "grooving"

    @property
    def is_turned(self) -> bool:
        """True if the workpiece rotates instead of the tool."""
        return self in {CutKind.TURNING, CutKind.GROOVING}


class Texture(StrEnum):
    """Process that forms the finished surface, which selects the roughness model."""

    CORNER_PER_REVOLUTION = "corner, one high tooth"
    """Corner of a turning insert, or of the highest insert of a face mill."""
    CORNER_PER_TOOTH = "corner, all teeth equal"
    """Corner of a solid end mill."""
    WALL = "wall"
    """Side of an end mill."""
    NONE = "not described by the feed"


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalPlace:
    """Place of the path where a milling load is greatest."""

    engagement: Engagement
    depth_share: float = 1.0
    """Real depth of cut over the nominal depth of a pass."""
    fill: float = 1.0
    """Section of the cut over the section of the full engagement arc."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlungeEngagement:
    """Engagement of a mill on ways down into the material that may have a plunge feed."""

    drilled: "tuple[Cut, ...]" = ()
    """Straight plunges modelled as drilling: those with the greatest thrust and power."""
    ramp: "Cut | None" = None
    """Milling engagement on a ramp, helix or zigzag; None without one."""
    sine: float = 0.0
    """Sine of the steepest ramp angle: descent over path length."""
    reaches_axis: bool = False
    """Whether a straight plunge meets material under the tool axis."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReachedLoads:
    """Share of the greatest loads that remains when the axes are too slow for the feed.

    No limit relies on it. Axes that are slower at the hardest place thin the chip there.
    """

    force: float = 1.0
    power: float = 1.0
    wall: float = 1.0
    """Share of the greatest force normal to the wall."""


@dataclass(frozen=True, slots=True)
class RefusedPasses:
    """Number of passes that is no candidate for a workingstep."""

    passes: int
    why: str
    """The stock that would differ, or what is missing, as the end of a sentence."""

    @property
    def words(self) -> str:
        """The reason with the number: 'in 2 passes up to 0.8 mm more would be left'."""
        return f"in {counted(self.passes, 'pass', 'passes')} {self.why}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerPlace:
    """Place of a path by its cutting power and spindle speed."""

    power: float = 1.0
    """Cutting power over the greatest along the path."""
    speed: float = 1.0
    """Spindle speed over that of the cut."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnedBar:
    """Shape of the bar after a turning path, and where it was cut, along z of the setup."""

    sections: tuple[BarSection, ...]
    """Sections of the remaining bar from the chuck end on, mm from that end."""
    back: float
    """z coordinate of the chuck end of the bar, mm."""
    low: float
    """z of the cut nearest to the chuck, mm."""
    high: float
    """z of the cut farthest from the chuck, mm."""
    speed_ratio: float = 1.0
    """Spindle speed at the smallest cut diameter over that at the largest."""
    greatest_speed: float = inf
    """Greatest spindle speed that the path reaches, rev/s."""

    def fastest(self, speed: float) -> float:
        """Greatest spindle speed in the cut, rev/s, for a speed at the largest diameter."""
        return max(speed, min(speed * self.speed_ratio, self.greatest_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """Cut of one workingstep: geometry, tool, programmed setting and hardest places."""

    kind: CutKind
    tool: Tool
    tool_kind: ToolKind
    diameter: float
    """Diameter at which the cutting speed is taken, mm: of the tool, or mean of the
    workpiece."""
    programmed: Setting
    length: float
    """Length at cutting feed in one pass, approach and overrun included, mm."""
    total_depth: float
    """Total depth to remove in all passes together, mm."""
    is_depth_free: bool
    """Whether a different number of passes would make the same part."""
    engagement: Engagement | None = None
    """Engagement arc of a milling cutter where its mean force is greatest."""
    radial_width: float = 0.0
    """Radial width a_e of a milling cutter, or width of a grooving insert, mm."""
    depth_share: float = 1.0
    """Greatest real depth over the nominal depth of a pass; above 1 where stock was left."""
    deepest_share: float = 1.0
    """Depth of the deepest place of a turning path over the nominal depth of a pass.

    A shoulder may be deeper than the pass that meets it.
    """
    fill: float = 1.0
    """Section of the cut over the section of the full engagement arc."""
    chip_ratio: float | None = None
    """Mean chip thickness over feed per tooth; None: derived from engagement or edge angle."""
    width_ratio: float | None = None
    """Greatest a_e/D along the path; None: taken from the engagement."""
    chip_sine: float | None = None
    """Greatest chip thickness over feed per tooth along the path; None: from the engagement."""
    shank: CriticalPlace | None = None
    """Place of the greatest force across an end mill's axis; None: the greatest engagement."""
    wall: CriticalPlace | None = None
    """Place of the greatest force normal to the wall; None: the greatest engagement."""
    helix_angle: float = 0.0
    """Helix angle of a milling cutter's edges, rad."""
    power_diameter: float | None = None
    """Diameter at which the force takes the greatest power at the cut's spindle speed, mm.

    The spindle may follow the tip while the force acts in the middle of the cut. None: the
    diameter on which the force acts.
    """
    torque_diameter: float | None = None
    """Diameter at which the force of a turning cut takes the greatest torque, mm; None: the
    diameter on which the force acts."""
    resolution: float = 0.0
    """Cell size of the stock map along which the cut is known, mm; 0 without a map."""
    power_places: tuple[PowerPlace, ...] = (PowerPlace(),)
    """Places of a path whose spindle follows the tip where the drive may draw most."""
    thickest: float = 1.0
    """Thickest chip of a drill over the nominal chip; above 1 where only the spindle slows."""
    reached: ReachedLoads = ReachedLoads()
    plunge_reached: float = 1.0
    """Share of the loads of straight plunges of a mill that the axes reach."""
    load_share: float = 1.0
    """Mean load over the length at cutting feed, air included, relative to the greatest
    load."""
    previous_diameter: float = 0.0
    """Diameter of the hole before a drill, reamer or boring bar, mm."""
    widest_drilled: float | None = None
    """Diameter cut by the lips of a drill where they cut most, mm; None: the tool diameter."""
    link_length: float = 0.0
    """Length of rapid moves in one pass, mm."""
    rest_time: float = 0.0
    """Time per pass not at cutting feed, s: ramps, rapids, moves with own feeds, waits."""
    air_length: float = 0.0
    """Part of the cutting-feed length that removes nothing, mm."""
    volume: float | None = None
    """Removed volume, mm³; None when not known."""
    texture: Texture = Texture.NONE
    corner_radius: float = 0.0
    """Radius that forms the surface, mm."""
    parallel_land: float = 0.0
    """Length of the parallel land that smooths the surface, mm; 0: none."""
    is_fed_inwards: bool = False
    """Whether an insert is fed towards the axis, so that its feed force bends the bar."""
    turned: TurnedBar | None = None
    """Shape of the bar after a turning path; None when not known."""
    is_finishing: bool = False
    """Whether this workingstep leaves the final surface."""
    is_finish_operation: bool = False
    """Whether the operation is a finishing operation by its type."""
    depth_bound: float | None = None
    """Greatest depth of one pass that the tool allows, mm."""
    floor: "Cut | None" = None
    """Floor that a wall-cutting operation sweeps once, at its own depth."""
    plunge: "Cut | None" = None
    """Straight plunge into solid material at the feed of the cut, modelled as drilling."""
    way_in: PlungeEngagement | None = None
    """Ways down that may have a plunge feed; None when none of them meets material."""
    refused_passes: tuple[RefusedPasses, ...] = ()
    """Numbers of passes that were tried and are no candidates."""

    @property
    def bare(self) -> "Cut":
        """Copy without the engagement met along the passes and without a finished surface."""
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
        """Copy of this cut as a flat-lipped drill of the mill's diameter in solid material."""
        tool = replace(self.tool, point_angle=pi)
        return replace(self.bare, kind=CutKind.DRILLING, tool=tool)

    @property
    def hardest(self) -> CriticalPlace | None:
        """Place of the path where the milling cutter is engaged most; None if unknown."""
        if self.engagement is None:
            return None
        return CriticalPlace(
            engagement=self.engagement, depth_share=self.depth_share, fill=self.fill
        )

    @property
    def mean_chip_ratio(self) -> float:
        """Mean chip thickness over feed per tooth where a milling cutter is engaged most."""
        if self.chip_ratio is not None:
            return self.chip_ratio
        if self.engagement is None:
            return 1.0
        return mean_chip_ratio(self.engagement, cutting_edge_angle=self.tool.cutting_edge_angle)

    @property
    def turning_edge_angle(self) -> float:
        """Cutting edge angle κ of a turning tool, rad: from the measured mean chip if known."""
        if self.chip_ratio is None:
            return self.tool.cutting_edge_angle
        return asin(min(self.chip_ratio, 1.0))

    @property
    def edges(self) -> CuttingEdges:
        """Edge geometry of a milling cutter."""
        return CuttingEdges(
            teeth=self.tool.teeth,
            diameter=self.tool.diameter,
            helix_angle=self.helix_angle,
            corner_radius=min(self.tool.corner_radius or 0.0, 0.5 * self.tool.diameter),
            cutting_edge_angle=self.tool.cutting_edge_angle,
        )

    @property
    def force_diameter(self) -> float:
        """Diameter on which the cutting force acts, mm; for a drill the middle of its lips."""
        if self.kind is CutKind.DRILLING:
            return 0.5 * (self.drilled_diameter + self.previous_diameter)
        return self.diameter

    @property
    def drilled_diameter(self) -> float:
        """Outer diameter that the lips of a drill cut, mm; smaller within its point."""
        return self.diameter if self.widest_drilled is None else self.widest_drilled

    @property
    def is_air(self) -> bool:
        """True if the path removes no material."""
        return self.volume is not None and self.volume <= LEAST_VOLUME
