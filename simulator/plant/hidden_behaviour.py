"""Hidden behaviour of the machine in the closed loop, unknown to the controller.

Units mm, s.
"""

from dataclasses import dataclass
from enum import StrEnum

from simulator.physics.domain import require_not_negative, require_positive


class HiddenQuantity(StrEnum):
    """Hidden quantity that may change while the program runs."""

    DEPTH = "depth"
    """Factor on the axial depth."""
    HARDNESS = "hardness"
    """Factor on k_c."""
    TOOTH = "tooth"
    """Number of the tooth that breaks, on the tool that is cutting."""
    SILENCE = "silence"
    """Duration, in s, during which no sample arrives."""
    OVERRIDE = "override"
    """Override that the axes run from now on, whatever is commanded."""
    LINE = "line"
    """Loss of the connection: the machine stops answering; the value is ignored."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenChange:
    """Change of a hidden quantity while the program runs."""

    time: float
    """Time of the run at which the change happens, s."""
    what: HiddenQuantity
    value: float
    """Value as described in :class:`HiddenQuantity`; a factor replaces the previous one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenTruth:
    """Hidden true behaviour of the machine and its tools.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    force_factor: float = 1.0
    """Factor on k_c from the start."""
    wear_rate: float = 0.0
    """Growth of flank wear per second of cutting, for each tool separately, mm/s."""
    flank_wear: float = 0.0
    """Flank wear of each tool when the program starts, mm."""
    eccentricity: float = 0.0
    """Offset of the cutter's axis from the spindle axis, mm."""
    servo_lag: float = 0.06
    """Time constant with which the feed follows the override, s: three revolutions at 3000 rpm;
    customary, to be calibrated."""
    changes: tuple[HiddenChange, ...] = ()

    def __post_init__(self) -> None:
        require_positive(self.force_factor, "factor on k_c", "")
        require_not_negative(self.wear_rate, "wear rate", "mm/s")
        require_not_negative(self.flank_wear, "flank wear", "mm")
        require_not_negative(self.eccentricity, "eccentricity", "mm")
        require_positive(self.servo_lag, "servo lag", "s")
