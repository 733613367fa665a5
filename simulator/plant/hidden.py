"""Behaviour of the machine of the closed loop that its controller may not know.

Units mm, s.
"""

from dataclasses import dataclass
from enum import StrEnum

from simulator.physics.domain import require_not_negative, require_positive


class HiddenQuantity(StrEnum):
    """Quantity that may change while the program runs."""

    DEPTH = "depth"
    """factor on the axial depth"""
    HARDNESS = "hardness"
    """factor on k_c"""
    TOOTH = "tooth"
    """number of the tooth that breaks, of the tool that cuts"""
    SILENCE = "silence"
    """s during which no sample arrives"""
    LINE = "line"
    """any number: from then on the machine does not answer"""


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenChange:
    """One change while the program runs."""

    time: float
    """Time, s of the run at which it happens"""
    what: HiddenQuantity
    value: float
    """as :class:`HiddenQuantity` says; a factor replaces the one before it"""


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenTruth:
    """The truth behind the plan.

    Raises
    ------
    ValueError
        When a number is beyond its bounds.
    """

    force_factor: float = 1.0
    """on k_c, from the start"""
    wear_rate: float = 0.0
    """Wear rate, mm of flank wear in a second of cutting, each tool for itself"""
    flank_wear: float = 0.0
    """Flank wear, mm, of each tool when the program starts"""
    eccentricity: float = 0.0
    """Eccentricity, mm, of the cutter's axis off the spindle's"""
    servo_lag: float = 0.06
    """s, time constant with which the feed follows the override: three revolutions at 3000
    rpm; customary, calibrate it"""
    changes: tuple[HiddenChange, ...] = ()

    def __post_init__(self) -> None:
        require_positive(self.force_factor, "factor on k_c", "")
        require_not_negative(self.wear_rate, "wear rate", "mm/s")
        require_not_negative(self.flank_wear, "flank wear", "mm")
        require_not_negative(self.eccentricity, "eccentricity", "mm")
        require_positive(self.servo_lag, "servo lag", "s")
