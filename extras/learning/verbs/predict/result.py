"""Result of ``predict``."""

from dataclasses import dataclass

from extras.learning.models import LearnedModel
from extras.learning.table import Floats, unit_of
from service.rendering.columns import Column
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.result import Result


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PredictResult(Result):
    """Predictions of a model."""

    model: LearnedModel
    values: Floats
    """(N,), in the unit of the target's name"""

    def view(self) -> ResultView:
        """Return the predictions, one line each."""
        target, values = self.model.target, self.values.tolist()
        column: Column[float] = Column(key=target, value=lambda value: value)
        return ResultView([
            *(TextLine(text=f"{target} {each:.6g} {unit_of(target)}") for each in values),
            Fact(key="model", value=self.model.kind.value),
            Fact(key="target", value=target),
            Fact(key="values", value=values),
            Table(
                key="predictions", columns=(column,), rows=values, is_shown=False,
                is_in_json=False,
            ),
        ])  # fmt: skip
