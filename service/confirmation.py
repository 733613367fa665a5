"""Figures that compare a plan with its simulated run: predicted and found value, and bound."""

from dataclasses import dataclass
from math import inf

PASSED = 1.01
"""Ratio of found value to bound above which the bound counts as exceeded."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """Predicted value of a plan and the value found in its run, in the displayed unit."""

    key: str
    """Key in JSON, including the unit."""
    heading: str
    promised: float
    found: float
    bound: float = inf

    @property
    def ratio(self) -> float | None:
        """Ratio of found to predicted value; None when the predicted value is zero."""
        return self.found / self.promised if self.promised > 0.0 else None

    @property
    def is_passed(self) -> bool:
        """Whether the found value exceeds its bound."""
        return self.found > PASSED * self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmedStep:
    """Predicted and found figures of one workingstep."""

    id: str
    figures: tuple[Figure, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Confirmation:
    """Predicted and found figures of all workingsteps of a plan."""

    steps: tuple[ConfirmedStep, ...]

    @property
    def passed(self) -> tuple[str, ...]:
        """Return a sentence for each bound that the run exceeded."""
        return tuple(
            f"{step.id}: {figure.heading} {figure.found:.4g} exceeds its bound of "
            f"{figure.bound:.4g}"
            for step in self.steps
            for figure in step.figures
            if figure.is_passed
        )
