"""``stepnc learn`` and ``stepnc predict``: models of data sets."""

import argparse
from pathlib import Path

from service.cli.options import OK, Commands, add_json


def add_learning_commands(commands: Commands) -> None:
    """Add them to ``stepnc``."""
    learn = commands.add_parser(
        "learn", help="learn a model from a data set, and measure it beside simple baselines"
    )
    learn.fill = _learn_options
    predict = commands.add_parser("predict", help="predict with a learned model")
    predict.fill = _predict_options


def _learn_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.learning import LearnRequest

    add = parser.add_argument
    add("dataset", type=Path, metavar="DATASET", help="folder, .parquet or .csv")
    add_options(parser, LearnRequest)
    add("-o", "--output", type=Path, metavar="FILE", help="write the model, .skops")
    add("--report", type=Path, metavar="HTML", help="write a self-contained page with plots")
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


def _learn(options: argparse.Namespace) -> int:
    """Run the command ``stepnc learn``."""
    from service.files import require_place, write_atomically
    from service.learning.learn import learn
    from service.learning.model_file import save_model
    from service.learning.output import learned_json, learned_page, print_learned
    from service.requests.fields import from_options
    from service.requests.learning import LearnRequest
    from service.terminal import tell, write_out

    for place in (options.output, options.report):
        if place is not None:
            require_place(place, apart_from=options.dataset)
    result = learn(options.dataset, from_options(LearnRequest, options))
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
