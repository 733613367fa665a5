"""Settings of the control loop, for the whole run and for each workingstep.

Units: mm, s, N.
"""

from dataclasses import dataclass, field
from math import inf

from controller.guard import OverrideBand
from controller.orders import Criterion
from controller.reference import Reference
from controller.signals.preview import LOOK_AHEAD


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopSettings:
    """Settings of the control loop for the whole run.

    Raises
    ------
    ValueError
        When a number is out of range.
    """

    criterion: Criterion = Criterion.TC
    is_on: bool = True
    is_held: bool = False
    """Whether the operator holds the feed."""
    most: float = inf
    """Greatest override that the operator allows."""
    power_factor: float = 1.0
    """Share of the motor's power that may be used."""
    set_point: float | None = None
    """Set point of the force in place of the plan's bound, N; None: by the plan."""
    band: OverrideBand = field(default_factory=OverrideBand)
    look_ahead: int = LOOK_AHEAD
    """Look-ahead of the law, revolutions; 0: no preview."""
    servo_lag: float = 0.06
    """Lag of the feed drives assumed by the loop, s; the machine's own may differ."""
    chips: float = 10.0
    """Revolution mean force above which there are chips, N: a multiple of its noise."""

    def __post_init__(self) -> None:
        for thing, value in (
            ("power factor", self.power_factor),
            ("set point", 1.0 if self.set_point is None else self.set_point),
            ("servo lag", self.servo_lag),
            ("chip force threshold", self.chips),
        ):
            if not 0.0 < value < inf:
                raise ValueError(f"{thing} {value:g} must be positive and finite")
        if not self.most > 0.0:
            raise ValueError(f"greatest override {self.most:g} must be positive")
        if self.look_ahead < 0:
            raise ValueError(f"look-ahead {self.look_ahead} must be at least 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopStep:
    """Data of one workingstep that the control loop needs.

    Raises
    ------
    ValueError
        When the exponent is not positive and finite.
    """

    reference: Reference
    exponent: float = 0.8
    """Exponent p of force over feed."""
    tool: str = ""
    """Id of the tool in this workingstep."""
    taught: float | None = None
    """Factor on k_c that the sharp tool has taught in this cut; None: none was taught."""
    diameter: float = 0.0
    """Diameter at which the cutting speed drives the force, mm; 0: not known."""

    def __post_init__(self) -> None:
        if not 0.0 < self.exponent < inf:
            raise ValueError(f"exponent {self.exponent:g} must be positive and finite")


AROUND = LoopStep(
    reference=Reference(workingstep="", inhibition="it belongs to no workingstep")
)
"""Placeholder for everything outside the workingsteps."""
