"""Request of ``learn``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, FileUse, Request
from service.requests.files import Report

KINDS = "mlp, gp, forest, boosting or power-law"


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnRequest(Request):
    """Request to learn a model."""

    target: Annotated[
        str, About("column to learn, with its unit", flag="--target", metavar="COLUMN")
    ] = "total_power_w"
    model: Annotated[str, About(KINDS, flag="--model", metavar="MODEL")] = "mlp"
    train: Annotated[
        int,
        Interval(ge=10, le=10_000_000),
        About("rows that train the model, the first ones", flag="--train", metavar="ROWS"),
    ] = 500
    test: Annotated[
        int,
        Interval(ge=10, le=10_000_000),
        About("rows that test it, the next ones", flag="--test", metavar="ROWS"),
    ] = 300
    seed: Annotated[
        int,
        Interval(ge=0, le=2**32 - 1),
        About("seed of the model and of the bootstrap", flag="--seed"),
    ] = 1
    is_on_physics: Annotated[
        bool,
        About(
            "learn the factor of the target over its column without deviation: "
            "for measured targets beside what the physics says of the same settings",
            flag="--on-physics",
        ),
    ] = False
    has_curve: Annotated[
        bool, About("train with fewer rows as well, for a learning curve", flag="--curve")
    ] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnFiles(Request):
    """Files of ``learn``."""

    dataset: Annotated[
        Path, About("folder, .parquet or .csv", use=FileUse.INPUT, metavar="DATASET")
    ]
    output: Annotated[
        Path | None,
        About(
            "write the model, .skops", flag="--output", short="-o", use=FileUse.OUTPUT,
            metavar="FILE",
        ),
    ] = None  # fmt: skip
    outcome: Annotated[
        Path | None,
        About(
            "with --on-physics: write the factor on k_c for `stepnc kbe add`",
            flag="--outcome", use=FileUse.OUTPUT, metavar="JSON",
        ),
    ] = None  # fmt: skip
    program: Annotated[
        Path | None,
        About(
            "STEP-NC program of the runs, whose tool the factor belongs to",
            flag="--program", use=FileUse.INPUT, metavar="PART",
        ),
    ] = None  # fmt: skip
    report: Report = None


REQUEST, FILES = LearnRequest, LearnFiles
