"""Settings of the loop, as a whole and for each workingstep. Units mm, s, N."""

from dataclasses import dataclass, field
from math import inf

from controller.guard import OverrideBand
from controller.orders import Criterion
from controller.preview import LOOK_AHEAD
from controller.reference import Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopSettings:
    """Settings of the loop.

    Raises
    ------
    ValueError
        When a number is beyond its bounds.
    """

    criterion: Criterion = Criterion.TC
    is_on: bool = True
    power_factor: float = 1.0
    """of the motor's power"""
    set_point: float | None = None
    """N, instead of the plan's bound"""
    band: OverrideBand = field(default_factory=OverrideBand)
    look_ahead: int = LOOK_AHEAD
    """revolutions; 0: the law is told nothing of what the program knows"""
    servo_lag: float = 0.06
    """s, as the loop takes it: the machine's own may differ"""
    chips: float = 10.0
    """N, mean of a revolution above which there are chips: some times its noise"""

    def __post_init__(self) -> None:
        for thing, value in (
            ("power factor", self.power_factor),
            ("set point", 1.0 if self.set_point is None else self.set_point),
            ("servo lag", self.servo_lag),
            ("force of chips", self.chips),
        ):
            if not 0.0 < value < inf:
                raise ValueError(f"{thing} {value:g} must be positive and finite")
        if self.look_ahead < 0:
            raise ValueError(f"look-ahead {self.look_ahead} must be at least 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopStep:
    """One workingstep as the loop needs it.

    Raises
    ------
    ValueError
        When the exponent is not positive and finite.
    """

    reference: Reference
    exponent: float = 0.8
    """p of force over feed"""
    tool: str = ""
    """its id"""
    diameter: float = 0.0
    """mm at which the cutting speed drives the force; 0: not known"""

    def __post_init__(self) -> None:
        if not 0.0 < self.exponent < inf:
            raise ValueError(f"exponent {self.exponent:g} must be positive and finite")


AROUND = LoopStep(
    reference=Reference(workingstep="", inhibition="it belongs to no workingstep")
)
"""what stands before the first workingstep"""
