"""Machines, materials and tool grades as parameters without behaviour.

Units: mm, s, N, W, rad, rev/s; torque N·mm; stress and specific force N/mm². ``None`` means
that the source gives no value, and a limit without a value does not limit.
"""

from dataclasses import dataclass
from enum import StrEnum

from simulator.work_holding import Holding


class MachineKind(StrEnum):
    """Kind of machine by what turns: the tool or the workpiece."""

    MILL = "mill"
    LATHE = "lathe"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindlePoint:
    """One point of the spindle's power and torque curve (continuous duty, S1)."""

    speed: float
    """Speed, rev/s, positive"""
    power: float
    """motor power available at that speed, W"""
    torque: float | None = None
    """torque available at the spindle nose, N·mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle:
    """Main drive.

    Between two points of the curve power and torque are interpolated in logarithms, so that
    constant torque and constant power are straight lines. Below the first point the torque
    stays constant where the point has one (power in proportion to speed), else the power does;
    above the last point the power stays constant. One point without torque: constant power.
    """

    curve: tuple[SpindlePoint, ...]
    """ascending in speed, at least one point"""
    efficiency: float
    """cutting power over motor power, 0 < η ≤ 1"""
    min_speed: float | None
    """Min speed, rev/s"""
    max_speed: float | None
    """Max speed, rev/s"""
    acceleration: float | None
    """Acceleration, rev/s²"""
    inertia: float | None = None
    """Inertia, kg·m², at the spindle; ``None``: ramps draw no power of their own"""
    idle_power: float = 0.0
    """motor power in W, turning without cutting, independent of speed"""
    idle_power_per_speed: float = 0.0
    """Idle power per speed, W per rev/s: friction of constant torque"""
    idle_power_per_speed_squared: float = 0.0
    """Idle power per speed squared, W per (rev/s)²: viscous friction"""
    regeneration: float = 0.0
    """share of the braking power that returns to the mains; 0: a braking resistor"""
    delay: float | None = None
    """Delay, s, time constant with which the power follows the cut; ``None``: not known"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisDrive:
    """Servomotor, gear, feed screw and guide of one linear axis.

    The screw turns once per lead, the motor ``gear_ratio`` times as fast.
    """

    lead: float
    """Lead, mm per revolution of the screw"""
    table_mass: float
    """Table mass, kg, all that the axis moves apart from the workpiece"""
    workpiece_mass: float = 0.0
    """Workpiece mass, kg, 0 where the workpiece does not ride on the axis"""
    screw_mass: float = 0.0
    """Screw mass, kg"""
    screw_diameter: float = 0.0
    """Screw diameter, mm"""
    coupling_inertia: float = 0.0
    """Coupling inertia, kg·m², on the motor's shaft"""
    motor_inertia: float = 0.0
    """Motor inertia, kg·m²"""
    guide_friction: float = 0.0
    """coefficient of the guide"""
    bearing_friction: float = 0.0
    """coefficient of the screw's bearing, at the screw's diameter"""
    preload: float = 0.0
    """Preload, N, in the bearing"""
    viscous: float = 0.0
    """N·mm·s/rad, on the motor's shaft"""
    gear_ratio: float = 1.0
    """turns of the motor per turn of the screw"""
    efficiency: float = 1.0
    """mechanical over electrical power of the motor, 0 < η ≤ 1"""
    regeneration: float = 0.0
    """share of the braking power that returns to the mains; 0: a braking resistor"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One linear axis."""

    name: str
    """X, Y or Z"""
    travel: tuple[float, float]
    """Travel, mm; an end that the source does not give is infinite"""
    rapid: float
    """Rapid, mm/s"""
    max_feed: float
    """Max feed, mm/s"""
    acceleration: float
    """Acceleration, mm/s²"""
    jerk: float | None = None
    """Jerk, mm/s³"""
    drive: AxisDrive | None = None
    """``None``: unknown; the axis draws no power of its own"""


class ModeDirection(StrEnum):
    """Axis of the machine along which a structure gives."""

    X = "x"
    Y = "y"
    Z = "z"
    XY = "xy"
    """x and y alike: a round tool in a spindle, measured once"""


class VibratingPart(StrEnum):
    """Part of the machine that was hit in the tap test."""

    TOOL = "tool"
    WORKPIECE = "workpiece"


@dataclass(frozen=True, slots=True, kw_only=True)
class VibrationMode:
    """One mode of a structure as a tap test shows it at the tool point or the workpiece.

    A tool's mode holds for the tool in its holder in this spindle, at this overhang.
    """

    part: VibratingPart
    direction: ModeDirection
    natural_frequency: float
    """Natural frequency, Hz"""
    damping_ratio: float
    """ζ, share of the critical damping, 0 < ζ < 1"""
    stiffness: float
    """modal stiffness k, N/mm"""
    source: str
    tool: str = ""
    """id of the tool as programs name it; empty: any tool of the diameter"""
    tool_diameter: float | None = None
    """Tool diameter, mm; ``None``: whatever the tool's diameter is"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """One machine tool."""

    name: str
    title: str
    kind: MachineKind
    spindle: Spindle
    axes: tuple[Axis, ...]
    rapid: float | None
    """Rapid, mm/s, of the slowest axis; ``None``: not limited"""
    max_feed: float | None
    """Max feed, mm/s, the feed mechanism"""
    max_cutting_force: float | None
    """Max cutting force, N"""
    max_axial_depth: float | None
    """Max axial depth, mm, depth of cut that the machine permits"""
    block_time: float | None
    """Block time, s, the control's processing time of one block"""
    base_power: float
    """Base power, W, whatever the machine does"""
    coolant_power: float
    """Coolant power, W"""
    tool_change: float
    """Tool change, s, chip to chip"""
    source: str
    remarks: tuple[str, ...] = ()
    modes: tuple[VibrationMode, ...] = ()
    """measured ones; without them stability sets no bound"""
    holdings: tuple[Holding, ...] = ()
    """how workpieces are held; without them nothing of it is bounded"""
    only_stated_limits: bool = False
    """whether the limits that its source states are all there are, as those of a paper: no
    safety factor, no stability, tolerance, helix, engagement or work-holding beside them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Kienzle:
    """k_c = k_c1.1 · h^(−m_c)."""

    k_c11: float
    """K c11, N/mm²"""
    m_c: float
    """0 ≤ m_c < 1; 0 is the constant k_s of El-Hofy"""
    rake_angle: float | None = None
    """rad, γ₀ of the tool the values were measured with; ``None``: no rake correction"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearEdge:
    """F_t = K_tc·b·h + K_te·b and likewise radial and axial."""

    k_tc: float
    """K tc, N/mm²"""
    k_te: float
    """K te, N/mm"""
    k_rc: float = 0.0
    k_re: float = 0.0
    k_ac: float = 0.0
    k_ae: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Taylor:
    """v_c · T^n = C."""

    exponent: float
    """n, dimensionless, 0 < n < 1"""
    constant: float
    """C as a cutting speed in mm/s for a life of one minute"""


class CuttingMaterial(StrEnum):
    """Material of the cutting edge."""

    HSS = "hss"
    CARBIDE = "carbide"
    CERAMIC = "ceramic"


class ToolConstruction(StrEnum):
    """Mounting of the cutting edge; the speeds of carbide differ with it."""

    SOLID = "solid"
    INDEXABLE = "indexable"


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingWindow:
    """Permitted speeds and feeds of a cutting material in a work material."""

    cutting_material: CuttingMaterial
    min_cutting_speed: float | None
    """Min cutting speed, mm/s"""
    max_cutting_speed: float | None
    """Max cutting speed, mm/s"""
    taylor: Taylor | None
    tool_body: ToolConstruction | None = None
    """``None``: the window serves both"""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkMaterial:
    """One work material."""

    name: str
    """file name in the library, ``c45``"""
    title: str
    """what a catalogue calls it, ``AISI 1045``"""
    iso_group: str
    """P, M, K, N, S or H; empty when it has none"""
    equivalents: tuple[str, ...]
    """other names and standard numbers"""
    hardness_hb: float | None
    density: float | None
    """g/cm³"""
    tensile_strength: float | None
    """Tensile strength, N/mm²"""
    kienzle: Kienzle
    linear_edge: LinearEdge | None
    windows: tuple[CuttingWindow, ...]
    min_feed_per_tooth_ratio: float | None
    """f_z over the cutter's diameter, end mills"""
    max_feed_per_tooth_ratio: float | None
    max_feed_per_tooth: float | None
    """Max feed per tooth, mm, absolute, where the source gives one"""
    source: str
    remarks: tuple[str, ...] = ()
    feed_force: Kienzle | None = None
    """(k_f1.1, m_f) of turning, m_f may exceed 1; ``None``: the usual share of F_c"""
    back_force: Kienzle | None = None
    """(k_p1.1, m_p) of turning, likewise"""
    spread: float | None = None
    """of k_c: σ of ln k_c is ln(1 + spread); ``None``: k_c is taken to be exact"""
    youngs_modulus: float | None = None
    """Youngs modulus, N/mm², of a bar that bends; ``None``: not known"""


class ToolKind(StrEnum):
    """Families of tools that share feed windows."""

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
class DrillPoint:
    """Point of a tool that cuts on its end."""

    thrust_share: float
    """thrust of the lips over their tangential force times sin κ"""
    chisel_ratio: float
    """c/D, length of the chisel edge over the diameter; 0: it has none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedWindow:
    """At which engagement the feeds per tooth of a milling cutter hold."""

    width_ratio: float
    """greatest a_e/D for which they are meant"""
    slot_factor: float
    """factor on them in a full slot"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolGrade:
    """Feed windows and strength of one kind of tool in one cutting material and ISO group.

    Feeds are per tooth for milling, per revolution for everything else.
    """

    name: str
    tool_kind: ToolKind
    cutting_material: CuttingMaterial
    iso_group: str
    """P, M, K, N, S, H; ``*`` for all"""
    min_feed_ratio: float | None
    """least feed per tooth (or revolution) over the tool's diameter"""
    max_feed_ratio: float | None
    min_feed: float | None
    """Min feed, mm, absolute"""
    max_feed: float | None
    """Max feed, mm, absolute"""
    min_cutting_speed: float | None
    """Min cutting speed, mm/s; overrides the material's window"""
    max_cutting_speed: float | None
    """Max cutting speed, mm/s"""
    max_depth_ratio: float | None
    """greatest axial depth over the tool's diameter"""
    max_depth: float | None
    """Max depth, mm, absolute"""
    min_chip_thickness: float
    """Min chip thickness, mm, below which the edge rubs"""
    youngs_modulus: float
    """Youngs modulus, N/mm²"""
    bending_strength: float
    """Bending strength, N/mm², permissible bending stress of the shank"""
    rake_angle: float | None
    """Rake angle, rad"""
    source: str
    helix_angle: float = 0.0
    """λ_s, rad; 0: straight edges"""
    point: DrillPoint | None = None
    """``None``: the source says nothing of it"""
    feed_window: FeedWindow | None = None
    """``None``: feeds hold at any engagement"""
    parallel_land: float = 0.0
    """b_s, mm of edge parallel to the face; 0: the corner makes the surface"""


class Certainty(StrEnum):
    """Certainty with which a material was matched."""

    EXACT = "exact"
    GUESS = "guess"


@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialMatch:
    """A material and how it was found."""

    material: WorkMaterial
    certainty: Certainty
    reason: str
    """one sentence for the user: "'ST-50' read as E295 / St50-2 by its equivalent name" """
