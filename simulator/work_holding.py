"""Parameters of work-holding devices, without behaviour; units mm, N, kg, rev/s."""

from dataclasses import dataclass

HOLDING_SAFETY = 1.5
"""Default safety factor on the cutting force for holding a workpiece: the minimum of VDI
3106. With the usual margin on k_c it is 1.9; Röhm, norm RN-1391, table 5, uses 2."""

CLAMPING_SAFETY = 1.5
"""Default safety factor on the clamping force at rest: the minimum of VDI 3106."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chuck:
    """Jaw chuck of a lathe that grips a bar from outside in one setup.

    Data of the grip that the program contains (bar and clamping positions) may be omitted.
    """

    clamping_force: float
    """Total clamping force of all jaws at rest, N."""
    friction: float
    """Coefficient of friction between jaws and bar."""
    source: str
    setup: str = ""
    """Id of the setup in which it is used; empty: any."""
    jaws: int = 3
    grip_diameter: float | None = None
    """Diameter of the grip, mm; ``None``: that of the bar."""
    grip_length: float | None = None
    """Length of the grip, mm; ``None``: from foremost clamping position to the bar's end."""
    jaw_face: float | None = None
    """Position along z in the setup where the jaws end, mm; ``None``: as for grip_length."""
    jaw_mass: float = 0.0
    """Mass of one jaw including its base, kg."""
    jaw_radius: float = 0.0
    """Radius of the centre of gravity of a jaw, mm."""
    lost_force: float = 0.0
    """Clamping force lost at the speed ``lost_at``, besides that from the jaw mass, N."""
    lost_at: float = 0.0
    """Spindle speed to which ``lost_force`` refers, rev/s."""
    safety_factor: float = HOLDING_SAFETY
    """Safety factor S_z on the cutting force."""
    clamping_safety_factor: float = CLAMPING_SAFETY
    """Safety factor S_sp on the clamping force at rest."""
    has_tailstock: bool | None = None
    """Whether a tailstock supports the front end; ``None``: as stated in the program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamp:
    """Vice or clamps that hold a workpiece on a mill by friction in one setup."""

    holding_force: float
    """Total normal force on the holding faces, N."""
    friction: float
    """Coefficient of friction between the workpiece and these faces."""
    source: str
    setup: str = ""
    """Id of the setup in which it is used; empty: any."""
    safety_factor: float = HOLDING_SAFETY
    """Safety factor on the cutting force."""


Holding = Chuck | Clamp
