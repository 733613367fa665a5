"""Result of ``learn``: scores of a model beside its baselines, text, JSON and page."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from extras.learning.models import ForceFactor, LearnedModel
from extras.learning.scores import (
    CurvePoint,
    Score,
    ScoredModel,
    error_columns,
    model_name,
    score_columns,
)
from extras.learning.table import Floats, unit_of
from service.rendering.columns import Column
from service.rendering.view import Fact, Item, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.plurals import counted

if TYPE_CHECKING:
    import plotly.graph_objects as go

CURVE = "learning curve, of the same test rows"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LearnResult(Result):
    """A learned model with its test."""

    model: LearnedModel
    test: int
    """Rows of the test."""
    scored: tuple[ScoredModel, ...]
    """The model first, then its baselines."""
    ceiling: Score | None
    """R² of the physics without deviation: no model of the settings can expect more. None where
    the table has no physics, or the model stands on it."""
    curve: tuple[CurvePoint, ...]
    """Learning curve, by rising rows; empty if it was not asked for."""
    warnings: tuple[str, ...]
    factor: ForceFactor | None
    """Factor on k_c of the training rows; None unless the model stands on the physics, and the
    rows tell how much power is that of the cut."""
    names: Mapping[str, tuple[str, ...]]
    """Parts, machines and materials of all rows."""
    actual: Floats
    """Target of the test rows, (M,)."""
    predicted: Floats

    def view(self) -> ResultView:
        """Return the scores of the model beside its baselines, and its trained box."""
        model = self.model
        unit = unit_of(model.target)
        curve: tuple[Item, ...] = ()
        if self.curve:
            rows = Table(columns=curve_columns(unit), rows=self.curve)
            curve = (TextLine(text=CURVE), rows)
        return ResultView([
            TextLine(text=headline(self)),
            Fact(key="model", value=model.kind.value),
            Fact(key="target", value=model.target),
            Fact(key="physics", value=model.physics or None),
            Fact(key="train", value=model.rows),
            Fact(key="test", value=self.test),
            Table(columns=score_columns(unit), rows=self.scored),
            Fact(key="scores", value={each.name: asdict(each.scores) for each in self.scored}),
            *(TextLine(text=text) for text in (ceiling_text(self), factor_text(self)) if text),
            Fact(key="ceiling", value=None if self.ceiling is None else asdict(self.ceiling)),
            Fact(
                key="trained_box",
                value={
                    name: [model.low[name], model.high[name]] for name in model.features.numbers
                },
            ),
            *curve,
            Fact(
                key="curve",
                value=[{"rows": each.rows, **asdict(each.scores)} for each in self.curve],
            ),
            Fact(key="force_factor", value=self.factor and asdict(self.factor)),
            Fact(key="manifest_sha256", value=model.manifest or None),
            Fact(key="warnings", value=self.warnings),
            Table(
                key="test_rows", columns=row_columns(model.target), is_shown=False,
                is_in_json=False,
                rows=list(zip(self.actual.tolist(), self.predicted.tolist(), strict=True)),
            ),
            TextLine(text=f"trained box: {', '.join(box_lines(self))}"),
            TextLine(text="in brackets: 95 % interval by bootstrap of the test rows"),
        ])  # fmt: skip

    def figures(self) -> "tuple[go.Figure, ...]":
        """Return predicted over actual targets, and the learning curve if there is one."""
        from extras.learning.verbs.learn.figures import (  # noqa: PLC0415 (plotly)
            curve_figure,
            scatter_figure,
        )

        unit = unit_of(self.model.target)
        curve = [curve_figure(self.curve, unit)] if self.curve else []
        return (scatter_figure(self.model, self.actual, self.predicted), *curve)

    def page(self) -> str:
        """Return a self-contained page with the scatter of the test rows."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        unit = unit_of(self.model.target)
        scatter, *curve = self.figures()
        return rendered(
            "learning.html.jinja",
            headline=headline(self),
            columns=score_columns(unit),
            scored=self.scored,
            ceiling=ceiling_text(self) or factor_text(self),
            box=box_lines(self),
            warnings=self.warnings,
            word="measured" if self.model.physics else "simulated",
            scatter=plot(scatter, "scatter"),
            curve=plot(curve[0], "curve") if curve else "",
            curve_columns=curve_columns(unit),
            points=self.curve,
        )


def curve_columns(unit: str) -> tuple[Column[CurvePoint], ...]:
    """Columns of a learning curve."""
    rows: Column[CurvePoint] = Column(heading="rows", is_key=True, value=lambda row: row.rows)
    return (rows, *error_columns(unit))


def row_columns(target: str) -> tuple[Column[tuple[float, float]], ...]:
    """Columns of the test rows: actual and predicted target."""
    return (
        Column(key=target, value=lambda row: row[0]),
        Column(key=f"predicted_{target}", value=lambda row: row[1]),
    )


def headline(result: LearnResult) -> str:
    """Summary of the learned model, in one line."""
    model = result.model
    trained = f"trained with {counted(model.rows, 'row')}, tested with the next {result.test}"
    return f"{model_name(model)}: {trained}"


def ceiling_text(result: LearnResult) -> str:
    """Best score that a model of the settings can reach; empty if it is not known."""
    if result.ceiling is None:
        return ""
    return (
        f"ceiling: R² {result.ceiling.value:.5f} of the physics without deviation; the rest is "
        "random, and a greater R² is chance"
    )


def box_lines(result: LearnResult) -> tuple[str, ...]:
    """Bounds of the trained box."""
    model = result.model
    return tuple(
        f"{name} {model.low[name]:.4g} to {model.high[name]:.4g} {unit_of(name)}"
        for name in model.features.numbers
    )


def factor_text(result: LearnResult) -> str:
    """Factor on k_c and offset of the idle power, with intervals; empty if not known."""
    found = result.factor
    if found is None:
        return ""
    wide, off = 1.96 * found.factor_error, 1.96 * found.offset_error
    return (
        f"k_c × {found.factor:.4f} ± {wide:.2g} and idle power {found.offset:+.4g} ± {off:.2g} "
        f"W beside the physics, by least squares of {counted(found.runs, 'row')} (95 %)"
    )
