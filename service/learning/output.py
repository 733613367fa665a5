"""Results of ``learn`` and ``predict`` as text, JSON and page."""

from dataclasses import asdict

from service.learning.learn import LearnResult, ScoredModel
from service.learning.learned import unit_of
from service.learning.predict import PredictResult
from service.learning.scores import Score
from service.rendering.columns import Column
from service.rendering.pages import plot, rendered
from service.rendering.records import dump, plain
from service.rendering.text import print_line, print_table


def score_columns(unit: str) -> tuple[Column[ScoredModel], ...]:
    """Columns of the scores; errors in the unit of the target."""
    return (
        Column(heading="model", is_key=True, is_words=True, value=lambda row: row.name),
        Column(heading="R²", is_right=True, value=lambda row: _fraction(row.scores.r2)),
        Column(heading=f"MAE {unit}", is_right=True, value=lambda row: _text(row.scores.mae)),
        Column(heading=f"RMSE {unit}", is_right=True, value=lambda row: _text(row.scores.rmse)),
        Column(heading="MAPE %", is_right=True, value=lambda row: _text(row.scores.mape)),
    )


def _fraction(score: Score) -> str:
    return f"{score.value:.5f} ({score.low:.5f} to {score.high:.5f})"


def _text(score: Score) -> str:
    return f"{score.value:.3g} ({score.low:.3g} to {score.high:.3g})"


def headline(result: LearnResult) -> str:
    """What was learned, in one line."""
    model = result.model
    return (
        f"{model.target} by {model.kind.value}: trained with {model.rows} rows, tested with "
        f"the next {result.test}"
    )


def ceiling_text(result: LearnResult) -> str:
    """What a model of the settings can reach at most; empty if it is not known."""
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


def print_learned(result: LearnResult) -> None:
    """Print the scores of a model beside its baselines."""
    print_line(headline(result))
    print_table(score_columns(unit_of(result.model.target)), result.scored)
    if text := ceiling_text(result):
        print_line(text)
    print_line(f"trained box: {', '.join(box_lines(result))}")
    print_line("in brackets: 95 % interval by bootstrap of the test rows")


def learned_json(result: LearnResult) -> str:
    """Return the scores as JSON."""
    model = result.model
    return dump({
        "model": model.kind.value,
        "target": model.target,
        "train": model.rows,
        "test": result.test,
        "scores": {each.name: plain(asdict(each.scores)) for each in result.scored},
        "ceiling": None if result.ceiling is None else plain(asdict(result.ceiling)),
        "trained_box": {
            name: [model.low[name], model.high[name]] for name in model.features.numbers
        },
        "warnings": result.warnings,
    })


def learned_page(result: LearnResult) -> str:
    """Return the scores as a self-contained page with the scatter of the test rows."""
    from service.learning.figures import scatter_figure  # noqa: PLC0415 (slow to import)

    return rendered(
        "learning.html.jinja",
        headline=headline(result),
        columns=score_columns(unit_of(result.model.target)),
        scored=result.scored,
        ceiling=ceiling_text(result),
        box=box_lines(result),
        warnings=result.warnings,
        scatter=plot(scatter_figure(result), "scatter"),
    )


def print_predicted(result: PredictResult) -> None:
    """Print predictions, one line each."""
    unit = unit_of(result.model.target)
    for value in result.values.tolist():
        print_line(f"{result.model.target} {value:.6g} {unit}")


def predicted_json(result: PredictResult) -> str:
    """Return predictions as JSON."""
    return dump({
        "model": result.model.kind.value,
        "target": result.model.target,
        "values": result.values.tolist(),
    })
