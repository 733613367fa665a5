"""Rules for the automatic acceptance of a proposed correction."""

from dataclasses import dataclass
from enum import StrEnum
from math import exp, log

from stepnc_model.outcome import LearnedCorrection
from stepnc_model.plurals import counted


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptanceBounds:
    """Conditions on which a proposed correction is accepted automatically."""

    least_confidence: float = 0.8
    fewest_outcomes: int = 3
    greatest_change: float = 0.25
    """Greatest relative change of the factor, up or down, from the last accepted one."""
    least_factor: float = 0.5
    greatest_factor: float = 2.0


class ObjectionGround(StrEnum):
    """Property of a proposal that an objection concerns."""

    CONFIDENCE = "confidence"
    OUTCOMES = "outcomes"
    CHANGE = "change"
    RANGE = "range"


@dataclass(frozen=True, slots=True, kw_only=True)
class Objection:
    """Violated condition that keeps a proposal from automatic acceptance."""

    ground: ObjectionGround
    message: str
    """Sentence with the value and its bound."""

    def __str__(self) -> str:
        return self.message


def objections(
    proposed: LearnedCorrection,
    accepted: LearnedCorrection | None,
    *,
    bounds: AcceptanceBounds | None = None,
) -> tuple[Objection, ...]:
    """Reasons why a proposal must not be accepted automatically; empty if it may.

    Parameters
    ----------
    accepted : LearnedCorrection or None
        Correction in force; None: none was accepted yet, and only the range limits the change
        from the catalogue.
    bounds : AcceptanceBounds, optional

    Raises
    ------
    ValueError
        If the two are of different contexts.
    """
    if accepted is not None and accepted.context != proposed.context:
        raise ValueError(
            f"{accepted.context} is not the context of the proposal, {proposed.context}"
        )
    keep = bounds or AcceptanceBounds()
    factor = exp(proposed.log_centre)
    grounds = {
        ObjectionGround.CONFIDENCE: ""
        if proposed.confidence >= keep.least_confidence
        else f"confidence {proposed.confidence:.3f} below {keep.least_confidence:g}",
        ObjectionGround.OUTCOMES: ""
        if proposed.outcomes >= keep.fewest_outcomes
        else f"learned from {counted(proposed.outcomes, 'outcome')}, "
        f"fewer than {keep.fewest_outcomes}",
        ObjectionGround.CHANGE: ""
        if accepted is None
        else _leap(factor, exp(accepted.log_centre), keep.greatest_change),
        ObjectionGround.RANGE: ""
        if keep.least_factor <= factor <= keep.greatest_factor
        else f"factor {factor:.2f} outside {keep.least_factor:g} to {keep.greatest_factor:g}",
    }
    return tuple(
        Objection(ground=ground, message=message)
        for ground, message in grounds.items()
        if message
    )


def _leap(factor: float, accepted: float, greatest: float) -> str:
    """Text on a factor that changes too much, compared in logarithms; empty if it does not."""
    if abs(log(factor / accepted)) <= log(1.0 + greatest):
        return ""
    share = f"{100.0 * greatest:g} %"
    return f"factor {factor:.2f} differs by more than {share} from the accepted {accepted:.2f}"
