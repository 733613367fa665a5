"""A plan beside its run as figures: what was promised, what was found, and the bound."""

from dataclasses import dataclass
from math import inf

PASSED = 1.01
"""found over bound, above which a bound counts as passed"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One promise and what became of it, in the user's unit."""

    key: str
    """in JSON, with the unit"""
    heading: str
    promised: float
    found: float
    bound: float = inf

    @property
    def ratio(self) -> float | None:
        """Found over promised; None of nothing."""
        return self.found / self.promised if self.promised > 0.0 else None

    @property
    def is_passed(self) -> bool:
        """Whether the found value is above its bound."""
        return self.found > PASSED * self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmedStep:
    """One workingstep."""

    id: str
    figures: tuple[Figure, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Confirmation:
    """All workingsteps of a plan."""

    steps: tuple[ConfirmedStep, ...]

    @property
    def passed(self) -> tuple[str, ...]:
        """A sentence for each bound that the run passed."""
        return tuple(
            f"{step.id}: {figure.heading} {figure.found:.4g} passes its bound of "
            f"{figure.bound:.4g}"
            for step in self.steps
            for figure in step.figures
            if figure.is_passed
        )
