"""Preview for any control law: feed-forward of the force that the program expects.

Force is ``F = K·g·u^p``. The program knows the course of the expected force g, so the override
that would hold the set point if K were 1, ``ff = (F_ref/g)^(1/p)``, is fed forward, with g the
greatest of all revolutions in sight: the axes are slow enough before the load comes. The inner
law commands only the factor w on it, ``u = w·ff``, and is shown the plant ``F/F_ref = K·w^p``:
constant whatever the engagement, with the one unknown K. Its axes are those of the nominal lag
(:mod:`controller.laws.axes`), and K is measured at the axes as they really ran,
``K = F/(g·v^p)``, so neither the band nor another lag affects the inner law.

Around a change of g a program and a machine never agree to the revolution. There K is only
known to lie between the values that the neighbouring g give, and the one nearest to the
previous K is used; and K falls by no more than a seventh in a revolution, because a cut that is
lighter than expected is mostly one that begins later. Where nothing is known the law works
alone, from the override at which it takes over.

The axes are slowed with lead, which needs half the look-ahead; six to eight revolutions do.

References
----------
.. [1] A. D. Spence, Y. Altintas, "CAD assisted adaptive control for milling", J. Dyn. Syst.
   Meas. Control 113 (1991), 444-450: what the program knows of the cut keeps feedback from
   meeting it unprepared.
.. [2] M. Tomizuka, "Optimal continuous finite preview problem", IEEE Trans. Automatic Control
   20 (1975), 362-365.
"""

from dataclasses import dataclass, field, replace
from math import exp, log
from typing import Generic, TypeVar

from controller.laws.axes import Axes, moved, quickening, ran, resting, sent, standing, within
from controller.laws.law import ControlLaw, Plant, Situation

S = TypeVar("S")

FARTHEST = log(1e3)
"""Greatest deviation of the feed-forward or of K from 1 that is accepted, either way, in ln."""
LEAST_FREEDOM = (0.5, 2.0)
"""Range of the factor w always available to the inner law, whatever the band leaves."""

GREATEST_FALL = 0.15
"""Greatest fall of ln K per revolution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PreviewedState(Generic[S]):
    """State of a law with preview: the inner law and its share of the override."""

    inner: S
    share: float
    """Factor w that the inner law commanded."""
    axes: Axes
    """Modelled axes of the nominal lag that follow w."""
    forward: Axes
    """Modelled axes of the nominal lag that follow the feed-forward."""
    factor: float
    """Estimated ln K, the measured over the expected force."""
    expected: float
    """Expected force g of the previous revolution, N."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainState(Generic[S]):
    """State of the inner law while there is no preview."""

    inner: S


@dataclass(frozen=True, slots=True, kw_only=True)
class Previewed(Generic[S]):
    """Control law that adds preview to an inner law."""

    law: ControlLaw[S]
    plant: Plant = field(default_factory=Plant)
    closing: float = 1.0
    """Time constant with which the axes are slowed before a load, revolutions."""

    def begin(self, override: float) -> PreviewedState[S] | PlainState[S]:
        """Initial state: the inner law alone, until the cut ahead is known."""
        return PlainState(inner=self.law.begin(override))

    def decide(
        self, state: PreviewedState[S] | PlainState[S], at: Situation
    ) -> tuple[PreviewedState[S] | PlainState[S], float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        if not at.ahead or at.expected <= 0.0 or max(at.ahead) <= 0.0:
            return self._alone(state, at)
        forward = self._forward(at)
        if isinstance(state, PlainState):
            state = self._factored(at, forward)
        axes = moved(state.axes, state.share, lag=self.plant.lag)
        through = moved(state.forward, standing(at) / state.share, lag=self.plant.lag)
        factor = self._factor(state, at)
        inner, share = self.law.decide(
            state.inner, self._inside(state, at, axes=axes, factor=factor, forward=forward)
        )
        found = PreviewedState(
            inner=inner,
            share=share,
            axes=axes,
            forward=through,
            factor=factor,
            expected=at.expected,
        )
        return found, within(share * self._slowed(found, at, forward), at)

    def _alone(
        self, state: PreviewedState[S] | PlainState[S], at: Situation
    ) -> tuple[PlainState[S], float]:
        """Decide with the inner law alone, on the real plant."""
        inner = state.inner if isinstance(state, PlainState) else self.law.begin(standing(at))
        inner, override = self.law.decide(inner, replace(at, expected=0.0, ahead=()))
        return PlainState(inner=inner), override

    def _factored(self, at: Situation, forward: float) -> PreviewedState[S]:
        """Initial state when the preview takes over, at the running override."""
        share = standing(at) / forward
        return PreviewedState(
            inner=self.law.begin(share),
            share=share,
            axes=resting(share),
            forward=resting(forward),
            factor=_held(self._measured(at) - log(at.expected)),
            expected=at.expected,
        )

    def _forward(self, at: Situation) -> float:
        """Feed-forward override for the greatest load in sight, if K were 1."""
        known = log(at.set_point) - log(max(at.ahead))
        return exp(_held(known / self.plant.exponent))

    def _measured(self, at: Situation) -> float:
        """Logarithm of the force at override 1, ln N."""
        return log(at.force) - self.plant.exponent * log(ran(at))

    def _factor(self, state: PreviewedState[S], at: Situation) -> float:
        """Logarithm of K: the value nearest to the last that the neighbours permit."""
        near = [each for each in (state.expected, at.expected, at.ahead[0]) if each > 0.0]
        measured = self._measured(at)
        low, high = measured - log(max(near)), measured - log(min(near))
        return _held(max(min(max(state.factor, low), high), state.factor - GREATEST_FALL))

    def _inside(
        self,
        state: PreviewedState[S],
        at: Situation,
        *,
        axes: Axes,
        factor: float,
        forward: float,
    ) -> Situation:
        """Situation for the inner law, which sees a constant plant."""
        low, high = LEAST_FREEDOM
        return Situation(
            force=exp(factor) * axes.mean**self.plant.exponent,
            set_point=1.0,
            override=state.share,
            actual=axes.mean,
            floor=min(at.floor / forward, low),
            ceiling=max(at.ceiling / forward, high),
        )

    def _slowed(self, state: PreviewedState[S], at: Situation, forward: float) -> float:
        """Feed-forward with lead where it slows the axes; slowing too much is harmless."""
        late = max(1.0, ran(at) / (state.axes.mean * state.forward.mean))
        axes = state.forward._replace(last=state.forward.last * late)
        if axes.last <= forward:
            return forward
        lead = quickening(self.plant, self.closing)
        return sent(axes, forward, quickening=lead)


def _held(value: float) -> float:
    """Clip a logarithm to the credible range."""
    return min(max(value, -FARTHEST), FARTHEST)
