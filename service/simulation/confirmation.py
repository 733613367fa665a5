"""Figures that compare a plan with its simulated run: predicted and found value, and bound."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

from simulator.removal.difference import StockDifference

PASSED = 1.01
"""Ratio of found value to bound above which the bound counts as exceeded."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """Predicted value of a plan and the value found in its run, in the displayed unit."""

    key: str
    """Key in JSON, including the unit."""
    heading: str
    promised: float
    simulated: float
    """Value found with the nominal k_c."""
    bound: float = inf
    at_quantile: float | None = None
    """Value found with the k_c at the quantile of the plan; None where it is the same."""

    @property
    def ratio(self) -> float | None:
        """Ratio of found to predicted value; None when the predicted value is zero."""
        return self.simulated / self.promised if self.promised > 0.0 else None

    @property
    def greatest(self) -> float:
        """Value that must keep the bound: that at the quantile."""
        return self.simulated if self.at_quantile is None else self.at_quantile

    @property
    def is_passed(self) -> bool:
        """True if the value at the quantile exceeds its bound."""
        return self.greatest > PASSED * self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmedStep:
    """Predicted and found figures of one workingstep, and the stock that it leaves."""

    id: str
    figures: tuple[Figure, ...]
    left: StockDifference | None = None
    """Stock that is left, compared with that of the program as given; None: not known."""
    is_advised: bool = True
    """Whether the workingstep runs as advised, and not as programmed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Confirmation:
    """Predicted and found figures of all workingsteps of a plan."""

    steps: tuple[ConfirmedStep, ...]
    quantile: float = 0.5
    """Quantile of k_c at which the bounds are compared."""

    @property
    def passed(self) -> tuple[str, ...]:
        """A sentence for each bound that the run exceeded, and for stock that differs."""
        return (*self._exceeded(), *self._other_stock())

    def _exceeded(self) -> Iterator[str]:
        for step in self.steps:
            for figure in step.figures:
                if figure.is_passed:
                    yield (
                        f"{step.id}: {figure.heading} {figure.greatest:.4g}"
                        f"{self._where(figure)} exceeds its bound of {figure.bound:.4g}"
                    )

    def _where(self, figure: Figure) -> str:
        if figure.at_quantile is None:
            return ""
        return f" at the {100.0 * self.quantile:g} % quantile of k_c"

    def _other_stock(self) -> Iterator[str]:
        for step in self.steps:
            if step.left is not None and step.left.is_seen:
                yield f"{step.id}: leaves {step.left.words} than the program as given"

    @property
    def nearest(self) -> tuple[str, Figure] | None:
        """Workingstep and figure that come nearest to their bound; None without bounds."""
        bounded = [
            (step.id, figure)
            for step in self.steps
            for figure in step.figures
            if figure.bound < inf
        ]
        return max(bounded, key=lambda each: each[1].greatest / each[1].bound, default=None)

    @property
    def unknown_stock(self) -> tuple[str, ...]:
        """Ids of the workingsteps after which the stock could not be compared."""
        return tuple(step.id for step in self.steps if step.left is None)
