"""Machines, materials and tool grades as parameters without behaviour.

Units: mm, s, N, W, rad, rev/s; torque N·mm; stress and specific force N/mm². ``None`` means
that the source gives no value; a limit without a value is not applied.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf

from simulator.cost_rates import CostRates
from simulator.planner_settings import USUAL, PlannerSettings
from simulator.surface_law import SurfaceSpread
from simulator.tool_windows import DepthWindow, DrillPoint, FeedWindow
from simulator.work_holding import Holding


class MachineKind(StrEnum):
    """Kind of machine, by whether the tool or the workpiece rotates."""

    MILL = "mill"
    LATHE = "lathe"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindlePoint:
    """Point of the spindle's power and torque curve (continuous duty, S1)."""

    speed: float
    """Spindle speed, rev/s, positive."""
    power: float
    """Available motor power at this speed, W."""
    torque: float | None = None
    """Available torque at the spindle nose, N·mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle:
    """Main drive of a machine.

    Between two points of the curve power and torque are interpolated in logarithms, so that
    constant torque and constant power are straight lines. Below the first point the torque is
    constant if the point has one (power proportional to speed), otherwise the power is
    constant; above the last point the power is constant. One point without torque means
    constant power.
    """

    curve: tuple[SpindlePoint, ...]
    """Points of the curve, ascending in speed, at least one."""
    efficiency: float
    """Cutting power over motor power, 0 < η ≤ 1."""
    min_speed: float | None
    """Lowest spindle speed, rev/s."""
    max_speed: float | None
    """Highest spindle speed, rev/s."""
    acceleration: float | None
    """Acceleration of the spindle, rev/s²."""
    inertia: float | None = None
    """Moment of inertia at the spindle, kg·m²; ``None``: ramps need no additional power."""
    idle_power: float = 0.0
    """Motor power without cutting that is independent of speed, W."""
    idle_power_per_speed: float = 0.0
    """Idle power proportional to speed, W per rev/s: friction with constant torque."""
    idle_power_per_speed_squared: float = 0.0
    """Idle power proportional to speed squared, W per (rev/s)²: viscous friction."""
    regeneration: float = 0.0
    """Share of the braking power returned to the mains; 0 for a braking resistor."""
    delay: float | None = None
    """Time constant with which the power follows the cut, s; ``None``: unknown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisDrive:
    """Drive of one linear axis: servomotor, gear, feed screw and guide.

    The screw turns once per lead; the motor turns ``gear_ratio`` times as fast.
    """

    lead: float
    """Travel per revolution of the screw, mm."""
    table_mass: float
    """Mass moved by the axis without the workpiece, kg."""
    workpiece_mass: float = 0.0
    """Mass of the workpiece, kg; 0 if the axis does not carry it."""
    screw_mass: float = 0.0
    """Mass of the screw, kg."""
    screw_diameter: float = 0.0
    """Diameter of the screw, mm."""
    coupling_inertia: float = 0.0
    """Moment of inertia of the coupling at the motor shaft, kg·m²."""
    motor_inertia: float = 0.0
    """Moment of inertia of the motor, kg·m²."""
    guide_friction: float = 0.0
    """Coefficient of friction of the guide."""
    bearing_friction: float = 0.0
    """Coefficient of friction of the screw bearing at the screw diameter."""
    preload: float = 0.0
    """Preload of the bearing, N."""
    viscous: float = 0.0
    """Viscous friction at the motor shaft, N·mm·s/rad."""
    gear_ratio: float = 1.0
    """Turns of the motor per turn of the screw."""
    efficiency: float = 1.0
    """Mechanical over electrical power of the motor, 0 < η ≤ 1."""
    regeneration: float = 0.0
    """Share of the braking power returned to the mains; 0 for a braking resistor."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """Linear axis of a machine."""

    name: str
    """Name of the axis: X, Y or Z."""
    travel: tuple[float, float]
    """Lower and upper end of travel, mm; infinite if the source does not give one."""
    rapid: float
    """Rapid speed, mm/s."""
    max_feed: float
    """Greatest feed, mm/s."""
    acceleration: float
    """Greatest acceleration, mm/s²."""
    jerk: float | None = None
    """Greatest jerk, mm/s³."""
    drive: AxisDrive | None = None
    """Drive of the axis; ``None``: unknown, the axis needs no power."""


class ModeDirection(StrEnum):
    """Axis of the machine along which a structure vibrates."""

    X = "x"
    Y = "y"
    Z = "z"
    XY = "xy"
    """Equal in x and y: a round tool in a spindle, measured once."""


class VibratingPart(StrEnum):
    """Part of the machine that was excited in the tap test."""

    TOOL = "tool"
    WORKPIECE = "workpiece"


@dataclass(frozen=True, slots=True, kw_only=True)
class VibrationMode:
    """Mode of vibration measured by a tap test at the tool point or the workpiece.

    The mode of a tool is valid for this tool in its holder, in this spindle, at this overhang.
    """

    part: VibratingPart
    direction: ModeDirection
    natural_frequency: float
    """Natural frequency, Hz."""
    damping_ratio: float
    """Damping ratio ζ, share of the critical damping, 0 < ζ < 1."""
    stiffness: float
    """Modal stiffness k, N/mm."""
    source: str
    tool: str = ""
    """Id of the tool as named in programs; empty: any tool with the diameter."""
    tool_diameter: float | None = None
    """Diameter of the tool, mm; ``None``: any diameter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HandlingState:
    """State of the machine in which a batch or a part is set up or ejected."""

    time: float
    """Mean time in the state, s."""
    power: float
    """Total electrical power of the machine in the state, W."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Handling:
    """States of the machine between batches and between parts."""

    batch_setup: HandlingState
    part_setup: HandlingState
    part_ejection: HandlingState
    batch_ejection: HandlingState
    time_scatter: float = 0.0
    """Half-width of the uniform relative scatter of the times, 0 to 1."""
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerDeviation:
    """Random deviation of the power that the motors draw, drawn once for each movement.

    A movement is the motion of one NC block. Its power is multiplied by 1 plus a uniform random
    number between minus and plus the half-width.
    """

    feed: float
    """Half-width in feed movements, 0 to 1."""
    traverse: float
    """Half-width in rapid movements, 0 to 1."""
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """Machine tool with its drives, limits and powers."""

    name: str
    title: str
    kind: MachineKind
    spindle: Spindle
    axes: tuple[Axis, ...]
    rapid: float | None
    """Rapid speed of the slowest axis, mm/s; ``None``: unlimited."""
    max_feed: float | None
    """Greatest feed of the feed drive, mm/s."""
    max_cutting_force: float | None
    """Greatest permitted cutting force, N."""
    max_axial_depth: float | None
    """Greatest depth of cut that the machine permits, mm."""
    block_time: float | None
    """Processing time of the control per block, s."""
    base_power: float
    """Constant power of the machine in any state, W."""
    coolant_power: float
    """Power of the coolant pump, W."""
    tool_change: float
    """Chip-to-chip time of a tool change, s."""
    source: str
    remarks: tuple[str, ...] = ()
    modes: tuple[VibrationMode, ...] = ()
    """Measured modes of vibration; without them stability is not limited."""
    holdings: tuple[Holding, ...] = ()
    """Work-holding devices; without them the holding force is not limited."""
    only_stated_limits: bool = False
    """Whether only the limits stated by the source apply, as for machines from papers: no
    safety factor, stability, tolerance, helix, engagement or work-holding limits in
    addition."""
    block_time_source: str = ""
    """Source of the block time, where it is another than that of the machine."""
    least_block: float | None = None
    """Least length of a block that a program should have, mm; ``None``: not stated."""
    least_feed_change: float | None = None
    """Least change of the feed that is worth a word, over the lesser feed; ``None``: not
    stated."""
    handling: Handling | None = None
    """States between parts and batches; ``None``: unknown."""
    deviation: PowerDeviation | None = None
    """Random deviation of motor powers; ``None``: unknown."""
    planner: PlannerSettings = USUAL
    """Planner of its LinuxCNC, if it has one."""
    costs: CostRates | None = None
    """Rates of machine and edges; ``None``: not stated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Kienzle:
    """Constants of Kienzle's law, k_c = k_c1.1 · h^(−m_c)."""

    k_c11: float
    """Specific cutting force k_c1.1 at b = h = 1 mm, N/mm²."""
    m_c: float
    """Exponent m_c, 0 ≤ m_c < 1; 0 for the constant k_s of El-Hofy."""
    rake_angle: float | None = None
    """Rake angle γ₀ of the tool used for measuring, rad; ``None``: no rake correction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearEdge:
    """Constants of the linear-edge law, F_t = K_tc·b·h + K_te·b; likewise radial and axial."""

    k_tc: float
    """Tangential cutting coefficient K_tc, N/mm²."""
    k_te: float
    """Tangential edge coefficient K_te, N/mm."""
    k_rc: float = 0.0
    k_re: float = 0.0
    k_ac: float = 0.0
    k_ae: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Taylor:
    """Constants of Taylor's tool life law, v_c · T^n = C."""

    exponent: float
    """Exponent n, dimensionless, 0 < n < 1."""
    constant: float
    """Constant C: the cutting speed for a life of one minute, in mm/s."""
    feed_exponent: float = 0.8
    """Exponent x of the feed, T ~ f^-x; customary value, ± 0.3."""
    depth_exponent: float = 0.3
    """Exponent y of the depth, T ~ a^-y; customary value, ± 0.2."""
    feed: float = 0.2
    """Feed per revolution or tooth at which C holds, mm."""
    depth: float = 2.0
    """Depth at which C holds, mm."""


class CuttingMaterial(StrEnum):
    """Material of the cutting edge."""

    HSS = "hss"
    CARBIDE = "carbide"
    CERAMIC = "ceramic"


class ToolConstruction(StrEnum):
    """Construction of a tool, solid or with inserts; cutting speeds of carbide depend on it."""

    SOLID = "solid"
    INDEXABLE = "indexable"


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingWindow:
    """Permitted cutting speeds of a cutting material in a work material, with tool life."""

    cutting_material: CuttingMaterial
    min_cutting_speed: float | None
    """Lowest cutting speed, mm/s."""
    max_cutting_speed: float | None
    """Highest cutting speed, mm/s."""
    taylor: Taylor | None
    tool_body: ToolConstruction | None = None
    """Construction for which the window is valid; ``None``: both."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkMaterial:
    """Work material with its cutting force constants and cutting-speed windows."""

    name: str
    """Name of the file in the library, ``c45``."""
    title: str
    """Name in catalogues, ``AISI 1045``."""
    iso_group: str
    """ISO group P, M, K, N, S or H; empty if there is none."""
    equivalents: tuple[str, ...]
    """Other names and standard numbers."""
    hardness_hb: float | None
    density: float | None
    """Density, g/cm³."""
    tensile_strength: float | None
    """Tensile strength, N/mm²."""
    kienzle: Kienzle
    linear_edge: LinearEdge | None
    windows: tuple[CuttingWindow, ...]
    min_feed_per_tooth_ratio: float | None
    """Least feed per tooth of end mills over the cutter diameter."""
    max_feed_per_tooth_ratio: float | None
    max_feed_per_tooth: float | None
    """Greatest feed per tooth, mm, if the source gives an absolute value."""
    source: str
    remarks: tuple[str, ...] = ()
    feed_force: Kienzle | None = None
    """Constants (k_f1.1, m_f) in turning, m_f may exceed 1; ``None``: usual share of F_c."""
    back_force: Kienzle | None = None
    """Constants (k_p1.1, m_p) in turning; ``None``: usual share of F_c."""
    spread: float | None = None
    """Relative spread of k_c: σ of ln k_c is ln(1 + spread); ``None``: k_c is exact."""
    youngs_modulus: float | None = None
    """Young's modulus, N/mm², for the bending of bars; ``None``: unknown."""
    surface: SurfaceSpread | None = None
    """Law of Ra that own measurements taught; ``None``: the spread between studies."""


class ToolKind(StrEnum):
    """Kinds of tools that share feed windows."""

    ENDMILL = "endmill"
    FACEMILL = "facemill"
    DRILL = "drill"
    CENTER_DRILL = "center_drill"
    COUNTERSINK = "countersink"
    REAMER = "reamer"
    BORING_BAR = "boring_bar"
    TAP = "tap"
    TURNING = "turning"
    GROOVING = "grooving"
    THREADING = "threading"


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolGrade:
    """Strength of a kind of tool of one cutting material, and its windows in an ISO group.

    Stiffness, strength and geometry belong to the tool whatever it cuts; feeds, speeds and
    depths belong to the group.

    Feeds are per tooth for milling, and per revolution for all other tools.
    """

    name: str
    tool_kind: ToolKind
    cutting_material: CuttingMaterial
    iso_group: str
    """ISO group P, M, K, N, S or H; ``*`` for all."""
    min_feed_ratio: float | None
    """Least feed per tooth (or revolution) over the tool diameter."""
    max_feed_ratio: float | None
    min_feed: float | None
    """Least feed per tooth (or revolution) as an absolute value, mm."""
    max_feed: float | None
    """Greatest feed per tooth (or revolution) as an absolute value, mm."""
    min_cutting_speed: float | None
    """Lowest cutting speed, mm/s; takes precedence over the material's window."""
    max_cutting_speed: float | None
    """Highest cutting speed, mm/s; takes precedence over the material's window."""
    max_depth_ratio: float | None
    """Greatest axial depth over the tool diameter."""
    max_depth: float | None
    """Greatest axial depth as an absolute value, mm."""
    min_chip_thickness: float
    """Chip thickness below which the edge rubs, mm."""
    youngs_modulus: float
    """Young's modulus of the tool, N/mm²."""
    bending_strength: float
    """Permissible bending stress of the shank, N/mm²."""
    rake_angle: float | None
    """Rake angle, rad."""
    source: str
    helix_angle: float = 0.0
    """Helix angle λ_s, rad; 0 for straight edges."""
    point: DrillPoint | None = None
    """Point geometry; ``None`` if the source does not give it."""
    feed_window: FeedWindow | None = None
    """Engagement for which feeds are valid; ``None``: any engagement."""
    parallel_land: float = 0.0
    """Length b_s of the edge parallel to the face, mm; 0: the corner generates the surface."""
    depth_window: DepthWindow | None = None
    """Engagement for which depths are valid; ``None``: any engagement."""
    largest_diameter: float = inf
    """Diameter up to which ratios of the diameter hold, mm; beyond it they end."""
    pilot_ratio: float = 1.0
    """Diameter that cuts over the diameter of the body."""
    borrowed: str = ""
    """Why the windows are those of another group; empty: they are the tool's own."""

    def size(self, diameter: float) -> float:
        """Diameter in mm to which ratios of the diameter apply, for a diameter of the body."""
        return min(self.pilot_ratio * diameter, self.largest_diameter)

    @property
    def has_feeds(self) -> bool:
        """True if a source gives a greatest feed."""
        return self.max_feed is not None or self.max_feed_ratio is not None


class Certainty(StrEnum):
    """Certainty with which a material was matched."""

    EXACT = "exact"
    GUESS = "guess"


@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialMatch:
    """Material found for a program, and how it was found."""

    material: WorkMaterial
    certainty: Certainty
    reason: str
    """Sentence for the user: "'ST-50' is read as E295 / St50-2: it is one of its names"."""
