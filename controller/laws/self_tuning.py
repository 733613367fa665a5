"""Self-tuning control of the cutting force: estimates the load, then places the pole.

The plant in logarithms is ``ln F = c + p·ln v``; v is what the axes ran, measured, so the lag
of the drives does not enter the estimate (:mod:`controller.laws.load`). With it the force meets
its set point at ``ln u* = (ln F_ref − c)/p``, and the command has lead so that the axes arrive
with time constant T_c, ``u = v + κ·(u* − v)``, :func:`~controller.laws.axes.quickening`:
indirect self-tuning with pole placement [1]_. The exponent is bounded to usual materials.

References
----------
.. [1] K. J. Åström, B. Wittenmark, "Adaptive Control", 2nd ed., 1995, chapter 3.
"""

from dataclasses import dataclass, field, replace
from math import exp, log

from controller.laws.axes import (
    FARTHEST,
    Axes,
    moved,
    quickening,
    ran,
    resting,
    sent,
    standing,
    within,
)
from controller.laws.law import Plant, Situation
from controller.laws.load import LoadEstimate, first_load, learned, learned_load

EXPONENT_BAND = (0.7, 1.2)
"""Range of the estimated p over that of the plant."""
EXCITATION = 0.03
"""Least change of ln v in one revolution from which p is learnt."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfTuningState:
    """State of the self-tuning control law."""

    axes: Axes
    way: float
    """Logarithm of the override that the axes ran in the previous revolution."""
    load: LoadEstimate | None
    """Estimated load and exponent; None before any force was seen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfTuning:
    """Self-tuning control law."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 1.5
    """Time constant T_c of the closed loop, revolutions."""
    noise: float = 0.03
    """Relative standard deviation of a measured force."""

    def begin(self, override: float) -> SelfTuningState:
        """Initial state: nothing is known except the plant."""
        axes = resting(override)
        return SelfTuningState(axes=axes, way=log(axes.last), load=None)

    def decide(self, state: SelfTuningState, at: Situation) -> tuple[SelfTuningState, float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        axes = moved(state.axes, standing(at), lag=self.plant.lag)
        way = log(ran(at))
        load = self._learned(state, log(at.force), way)
        # Relative to the present position of the axes, so that a bad estimate cannot overflow.
        farther = (log(at.set_point) - load.log - load.exponent * way) / load.exponent
        goal = way + min(max(farther, -FARTHEST), FARTHEST)
        override = sent(axes, exp(goal), quickening=quickening(self.plant, self.closing))
        return SelfTuningState(axes=axes, way=way, load=load), within(override, at)

    def _learned(self, state: SelfTuningState, force: float, way: float) -> LoadEstimate:
        """Update the estimate after one more revolution; the exponent stays within its band."""
        known = {"force": force, "way": way, "noise": self.noise}
        if state.load is None:
            return first_load(**known, exponent=self.plant.exponent)
        is_excited = abs(way - state.way) > EXCITATION
        load = (learned if is_excited else learned_load)(state.load, **known)
        low, high = (bound * self.plant.exponent for bound in EXPONENT_BAND)
        exponent = min(max(load.exponent, low), high)
        # The force expected at the present override stays the same.
        kept = load.log + (load.exponent - exponent) * way
        return replace(load, log=kept, exponent=exponent)
