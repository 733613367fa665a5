"""Model-reference adaptive control (MRAC) of the cutting force, in logarithms.

The reference model says how a deviation ``η = ln(F/F_ref)`` should decay, ``η_{k+1} = λ·η_k``
with ``λ = exp(−1/T_c)``, T_c at most the lag of the drives. The plant behaves as
``η_{k+1} = a·η_k + b·ln u_k + c`` with ``a = exp(−1/T)`` and ``b = p·(1 − a)`` from its lag and
exponent, and c, the load of the cut, unknown. The law ``ln u = θ_0 − θ_1·η`` would make it
follow the model if its parameters were ``θ_1 = (a − λ)/b`` and ``θ_0 = −c/b``; deviations of
the parameters show as the model's error ``ε = η_{k+1} − λ·η_k``, and the normalised gradient
with ``φ = (1, −η_k)``, ``θ ← θ − γ·ε·φ/(b·(1 + φ·φ))`` [1]_, makes a Lyapunov function of the
parameters' errors fall for 0 < γ < 2 [2]_.

Against bursts and drift θ_1 is bounded and leaks back to its nominal value, and θ_0 is bounded
to the band. What the guard did not apply is taken out of ε, ``b·(ln u − wanted)``.

References
----------
.. [1] G. C. Goodwin, P. J. Ramadge, P. E. Caines, "Discrete-time multivariable adaptive
   control", IEEE Trans. Automatic Control 25 (1980), 449-456: projection algorithm.
.. [2] K. J. Åström, B. Wittenmark, "Adaptive Control", 2nd ed., 1995, chapter 5.
"""

from dataclasses import dataclass, field
from math import exp, log

from controller.laws.axes import Axes, moved, resting, shortfall, standing, within
from controller.laws.law import Plant, Situation

GAIN_BAND = (0.5, 2.0)
"""Range of θ_1 over its nominal value."""
LEAK = 0.05
"""Share by which θ_1 returns to its nominal value per revolution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelReferenceState:
    """State of the model-reference control law."""

    axes: Axes
    deviation: float
    """Deviation η of the previous revolution."""
    bias: float
    """Adaptive parameter θ_0."""
    gain: float
    """Adaptive parameter θ_1."""
    wanted: float
    """Logarithm of the override that the law requested."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelReference:
    """Model-reference adaptive control law."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 2.0
    """Time constant T_c of the reference model, revolutions."""
    adaptation: float = 0.9
    """Adaptation gain γ, between 0 and 2."""

    def begin(self, override: float) -> ModelReferenceState:
        """Initial state, as if the force were at its set point."""
        axes = resting(override)
        rest = log(axes.last)
        return ModelReferenceState(
            axes=axes, deviation=0.0, bias=rest, gain=self._nominal(), wanted=rest
        )

    def decide(
        self, state: ModelReferenceState, at: Situation
    ) -> tuple[ModelReferenceState, float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        override = standing(at)
        axes = moved(state.axes, override, lag=self.plant.lag)
        deviation = -shortfall(axes, at, exponent=self.plant.exponent)
        bias, gain = self._adapted(state, deviation, let_through=log(override))
        bias = log(within(exp(bias), at))
        wanted = bias - gain * deviation
        found = ModelReferenceState(
            axes=axes, deviation=deviation, bias=bias, gain=gain, wanted=wanted
        )
        return found, within(exp(wanted), at)

    def _adapted(
        self, state: ModelReferenceState, deviation: float, *, let_through: float
    ) -> tuple[float, float]:
        """Updated θ_0 and θ_1 after one more revolution."""
        sensitivity = self._sensitivity()
        error = deviation - self._model() * state.deviation
        error -= sensitivity * (let_through - state.wanted)
        step = self.adaptation * error / (sensitivity * (2.0 + state.deviation**2))
        nominal = self._nominal()
        gain = state.gain + step * state.deviation + LEAK * (nominal - state.gain)
        low, high = sorted(bound * nominal for bound in GAIN_BAND)
        return state.bias - step, min(max(gain, low), high)

    def _sensitivity(self) -> float:
        """Change of ln F after one revolution over the change of ln u."""
        return self.plant.exponent * (1.0 - exp(-1.0 / self.plant.lag))

    def _nominal(self) -> float:
        """Nominal θ_1 for the assumed plant."""
        return (exp(-1.0 / self.plant.lag) - self._model()) / self._sensitivity()

    def _model(self) -> float:
        """Decay factor λ of the reference model, which is never slower than the drives."""
        return exp(-1.0 / min(self.closing, self.plant.lag))
