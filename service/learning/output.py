"""Results of ``learn``, ``predict`` and ``score`` as text, JSON and page."""

from dataclasses import asdict
from typing import Any

from service.learning.learn import CurvePoint, LearnResult, ScoredModel
from service.learning.learned import LearnedModel
from service.learning.predict import PredictResult
from service.learning.score import ScoreResult
from service.learning.scores import Score
from service.learning.table import unit_of
from service.rendering.columns import Column
from service.rendering.pages import plot, rendered
from service.rendering.records import dump, plain
from service.rendering.text import print_line, print_table


def score_columns(unit: str) -> tuple[Column[ScoredModel], ...]:
    """Columns of the scores; errors in the unit of the target."""
    name: Column[ScoredModel] = Column(
        heading="model", is_key=True, is_words=True, value=lambda row: row.name
    )
    return (name, *_scores_columns(unit))


def curve_columns(unit: str) -> tuple[Column[CurvePoint], ...]:
    """Columns of a learning curve."""
    rows: Column[CurvePoint] = Column(heading="rows", is_key=True, value=lambda row: row.rows)
    return (rows, *_scores_columns(unit))


def _scores_columns(unit: str) -> tuple[Column[Any], ...]:
    return (
        Column(heading="R²", is_right=True, value=lambda row: _fraction(row.scores.r2)),
        Column(heading=f"MAE {unit}", is_right=True, value=lambda row: _text(row.scores.mae)),
        Column(heading=f"RMSE {unit}", is_right=True, value=lambda row: _text(row.scores.rmse)),
        Column(heading="MAPE %", is_right=True, value=lambda row: _text(row.scores.mape)),
    )


def _fraction(score: Score | None) -> str:
    if score is None:
        return "–"
    return f"{score.value:.5f} ({score.low:.5f} to {score.high:.5f})"


def _text(score: Score) -> str:
    return f"{score.value:.3g} ({score.low:.3g} to {score.high:.3g})"


def headline(result: LearnResult) -> str:
    """What was learned, in one line."""
    model = result.model
    return (
        f"{_named(model)}: trained with {model.rows} rows, tested with the next {result.test}"
    )


def _named(model: LearnedModel) -> str:
    """Target and kind of a model."""
    on = " on the physics" if model.physics else ""
    return f"{model.target} by {model.kind.value}{on}"


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


def factor_text(result: LearnResult) -> str:
    """Factor on k_c and offset of the idle power, with intervals; empty if not known."""
    found = result.factor
    if found is None:
        return ""
    wide, off = 1.96 * found.factor_error, 1.96 * found.offset_error
    return (
        f"k_c × {found.factor:.4f} ± {wide:.2g} and idle power {found.offset:+.4g} ± {off:.2g} "
        f"W beside the physics, by least squares of {found.runs} rows (95 %)"
    )


def print_learned(result: LearnResult) -> None:
    """Print the scores of a model beside its baselines."""
    print_line(headline(result))
    print_table(score_columns(unit_of(result.model.target)), result.scored)
    if text := ceiling_text(result):
        print_line(text)
    if text := factor_text(result):
        print_line(text)
    if result.curve:
        print_line("learning curve, of the same test rows")
        print_table(curve_columns(unit_of(result.model.target)), result.curve)
    print_line(f"trained box: {', '.join(box_lines(result))}")
    print_line("in brackets: 95 % interval by bootstrap of the test rows")


def learned_json(result: LearnResult) -> str:
    """Return the scores as JSON."""
    model = result.model
    return dump({
        "model": model.kind.value,
        "target": model.target,
        "physics": model.physics or None,
        "train": model.rows,
        "test": result.test,
        "scores": {each.name: plain(asdict(each.scores)) for each in result.scored},
        "ceiling": None if result.ceiling is None else plain(asdict(result.ceiling)),
        "trained_box": {
            name: [model.low[name], model.high[name]] for name in model.features.numbers
        },
        "curve": [{"rows": each.rows, **plain(asdict(each.scores))} for each in result.curve],
        "force_factor": None if result.factor is None else plain(asdict(result.factor)),
        "manifest_sha256": model.manifest or None,
        "warnings": result.warnings,
    })


def learned_page(result: LearnResult) -> str:
    """Return the scores as a self-contained page with the scatter of the test rows."""
    from service.learning.figures import (  # noqa: PLC0415 (slow to import)
        curve_figure,
        scatter_figure,
    )

    unit = unit_of(result.model.target)
    curve = plot(curve_figure(result.curve, unit), "curve") if result.curve else ""
    return rendered(
        "learning.html.jinja",
        headline=headline(result),
        columns=score_columns(unit),
        scored=result.scored,
        ceiling=ceiling_text(result) or factor_text(result),
        box=box_lines(result),
        warnings=result.warnings,
        word="measured" if result.model.physics else "simulated",
        scatter=plot(scatter_figure(result), "scatter"),
        curve=curve,
        curve_columns=curve_columns(unit),
        points=result.curve,
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


def score_headline(result: ScoreResult) -> str:
    """What was scored, in one line."""
    return f"{_named(result.model)}: {len(result.rows)} measured runs"


def drift_lines(result: ScoreResult) -> list[str]:
    """Diagnosis of the residuals, with its evidence."""
    drift, rows = result.drift, result.rows
    rate = f"{100.0 * drift.false_alarm:g} % false alarms"
    sums = f"sum {drift.statistic:.3g}, bound {drift.bound:.3g} ({rate})"
    if drift.alarm is None:
        lines = [f"no drift: {sums}"]
    else:
        lines = [f"drift: {sums}, exceeded at row {rows[drift.alarm]}"]
        since = f"measured over predicted since row {rows[drift.since]}: "
        before = "" if drift.before is None else f"; before: {_share(drift.before)}"
        lines.append(since + _share(drift.after) + before)
    lines.append(
        f"the test of the model left {100.0 * drift.expected:+.2f} %, standard deviation "
        f"{100.0 * drift.spread:.2g} %"
    )
    lines += [
        f"goes with {each.name}: correlation {each.correlation:+.2f}, "
        f"{100.0 * each.change:+.3g} % from least to greatest (chance {each.chance:.2g})"
        for each in drift.associations
    ]
    if not drift.associations:
        lines.append("goes with no setting and not with the order of the runs")
    return lines


def _share(score: Score) -> str:
    low, high = 100.0 * score.low, 100.0 * score.high
    return f"{100.0 * score.value:+.2f} % ({low:+.2f} to {high:+.2f})"


def print_scored(result: ScoreResult) -> None:
    """Print the scores of a model on measured runs, and the diagnosis."""
    print_line(score_headline(result))
    if result.left_out:
        row, text = result.left_out[0]
        print_line(f"left out: {len(result.left_out)} runs, first row {row}: {text}")
    print_table(score_columns(unit_of(result.model.target)), result.scored)
    for line in drift_lines(result):
        print_line(line)
    print_line("in brackets: 95 % interval by bootstrap of the runs")


def scored_json(result: ScoreResult) -> str:
    """Return the scores of a model on measured runs as JSON."""
    model, drift, rows = result.model, result.drift, result.rows
    return dump({
        "model": model.kind.value,
        "target": model.target,
        "physics": model.physics or None,
        "runs": len(rows),
        "left_out": [{"row": row, "reason": text} for row, text in result.left_out],
        "scores": {each.name: plain(asdict(each.scores)) for each in result.scored},
        "drift": {
            "is_alarm": drift.alarm is not None,
            **plain(asdict(drift)),
            "alarm": None if drift.alarm is None else rows[drift.alarm],
            "since": rows[drift.since],
        },
    })
