"""``stepnc learn``, ``stepnc predict`` and ``stepnc score``: models of data sets."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.options import LIMIT_EXCEEDED, OK, Commands, add_json
from service.requests.fields import output_path
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from service.learning.learn import LearnResult


def add_learning_commands(commands: Commands) -> None:
    """Add them to ``stepnc``."""
    learn = commands.add_parser(
        "learn", help="learn a model from a data set, and measure it beside simple baselines"
    )
    learn.fill = _learn_options
    predict = commands.add_parser("predict", help="predict with a learned model")
    predict.fill = _predict_options
    score = commands.add_parser(
        "score", help="score a learned model on measured runs, and watch them for drift"
    )
    score.fill = _score_options


def _learn_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.learning import LearnRequest

    add = parser.add_argument
    add("dataset", type=Path, metavar="DATASET", help="folder, .parquet or .csv")
    add_options(parser, LearnRequest)
    add("-o", "--output", type=output_path, metavar="FILE", help="write the model, .skops")
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with plots",
    )
    add(
        "--outcome",
        type=output_path,
        metavar="JSON",
        help="with --on-physics: write the factor on k_c for `stepnc kbe add`",
    )
    add(
        "--program",
        type=Path,
        metavar="PART",
        help="STEP-NC program of the runs, whose tool the factor belongs to",
    )
    add_json(parser)
    parser.set_defaults(run=_learn)


def _predict_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.learning import PredictRequest

    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="model of `stepnc learn`, .skops")
    add("table", type=Path, nargs="?", metavar="TABLE", help="rows, .parquet or .csv")
    add_options(parser, PredictRequest)
    add_json(parser)
    parser.set_defaults(run=_predict)


def _score_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.learning import ScoreRequest

    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="model of `stepnc learn`, .skops")
    add(
        "runs",
        type=Path,
        metavar="RUNS",
        help="measured runs in their order: settings and target, .parquet or .csv",
    )
    add_options(parser, ScoreRequest)
    add_json(parser)
    parser.set_defaults(run=_score)


def _learn(options: argparse.Namespace) -> int:
    """Run the command ``stepnc learn``."""
    from service.files import require_places, write_atomically
    from service.learning.learn import learn
    from service.learning.model_file import save_model
    from service.learning.output import learned_json, learned_page, print_learned
    from service.requests.fields import from_options
    from service.requests.learning import LearnRequest
    from service.terminal import tell, write_out

    require_places([options.output, options.report, options.outcome])
    if (options.outcome is None) is not (options.program is None):
        raise StepNcError("--outcome and --program belong together")
    if options.outcome is not None and not options.is_on_physics:
        raise StepNcError("--outcome: a factor on k_c needs --on-physics")
    result = learn(options.dataset, from_options(LearnRequest, options))
    if options.outcome is not None:
        _write_outcome(result, options)
    for text in result.warnings:
        tell(f"scikit-learn: {text}")
    if options.output is not None:
        save_model(result.model, options.output)
        tell(f"model: {options.output}")
    if options.report is not None:
        write_atomically(options.report, learned_page(result).encode())
        tell(f"report: {options.report}")
    if options.json:
        write_out(learned_json(result))
    else:
        print_learned(result)
    return OK


def _write_outcome(result: "LearnResult", options: argparse.Namespace) -> None:
    """Write the factor on k_c for the knowledge base."""
    from service.learning.outcome import write_outcome
    from service.terminal import tell

    if result.factor is None:
        raise StepNcError(
            f"{options.dataset}: no factor on k_c: it needs the target total_power_w and a "
            "column cutting_power_w that varies"
        )
    write_outcome(options.outcome, result.factor, program=options.program, names=result.names)
    tell(f"outcome: {options.outcome}; `stepnc kbe add {options.outcome}` takes it")


def _predict(options: argparse.Namespace) -> int:
    """Run the command ``stepnc predict``."""
    from service.learning.output import predicted_json, print_predicted
    from service.learning.predict import predict
    from service.requests.fields import from_options
    from service.requests.learning import PredictRequest
    from service.terminal import write_out

    result = predict(options.model, from_options(PredictRequest, options), table=options.table)
    if options.json:
        write_out(predicted_json(result))
    else:
        print_predicted(result)
    return OK


def _score(options: argparse.Namespace) -> int:
    """Run the command ``stepnc score``; an alarm is an exceeded bound."""
    from service.learning.output import print_scored, scored_json
    from service.learning.score import score
    from service.requests.fields import from_options
    from service.requests.learning import ScoreRequest
    from service.terminal import write_out

    result = score(options.model, options.runs, from_options(ScoreRequest, options))
    if options.json:
        write_out(scored_json(result))
    else:
        print_scored(result)
    return OK if result.drift.alarm is None else LIMIT_EXCEEDED
