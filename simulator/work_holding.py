"""Parameters of work-holding, without behaviour; units mm, N, kg, rev/s."""

from dataclasses import dataclass

HOLDING_SAFETY = 1.5
"""forces that a workpiece is held against over those of the cut, where nobody says: VDI 3106,
at least. With the usual margin on k_c it is 1.9; Röhm, norm RN-1391, table 5, has 2"""

CLAMPING_SAFETY = 1.5
"""clamping force at rest over the least that is counted on; VDI 3106: at least"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chuck:
    """A jaw chuck on the spindle of a lathe, as it grips a bar from outside in one setup.

    What the program says of the grip (its bar and clamping positions) need not be said again.
    """

    clamping_force: float
    """Clamping force, N, of all jaws together, at rest"""
    friction: float
    """coefficient between jaws and bar"""
    source: str
    setup: str = ""
    """id of the setup it holds; empty: any"""
    jaws: int = 3
    grip_diameter: float | None = None
    """Grip diameter, mm; ``None``: that of the bar"""
    grip_length: float | None = None
    """mm; ``None``: from the clamping position that is farthest in front to the bar's end"""
    jaw_face: float | None = None
    """Jaw face, mm along z in the setup, where the jaws end; ``None``: as just said"""
    jaw_mass: float = 0.0
    """Jaw mass, kg, of one jaw, its base included"""
    jaw_radius: float = 0.0
    """Jaw radius, mm, of the jaw's centre of gravity"""
    lost_force: float = 0.0
    """N that the chuck loses besides, or all that it loses where no mass is given …"""
    lost_at: float = 0.0
    """… at this speed, rev/s"""
    safety_factor: float = HOLDING_SAFETY
    """S_z, on the forces of the cut"""
    clamping_safety_factor: float = CLAMPING_SAFETY
    """S_sp, on the clamping force at rest"""
    has_tailstock: bool | None = None
    """whether a centre supports the front end of the bar; ``None``: as the program says"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamp:
    """A vice or clamps that hold a workpiece on a mill by friction in one setup."""

    holding_force: float
    """Holding force, N, all forces normal to the faces that hold, together"""
    friction: float
    """coefficient between the workpiece and these faces"""
    source: str
    setup: str = ""
    """id of the setup it holds; empty: any"""
    safety_factor: float = HOLDING_SAFETY
    """on the forces of the cut"""


Holding = Chuck | Clamp
