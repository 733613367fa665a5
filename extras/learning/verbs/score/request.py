"""Request of ``score``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, FileUse, Request


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreRequest(Request):
    """Request to score a model on measured runs, and to watch them for drift."""

    false_alarm: Annotated[
        float,
        Interval(ge=0.001, le=0.5),
        About(
            "probability of an alarm where nothing has changed",
            name="false alarm",
            flag="--false-alarm",
            metavar="P",
        ),
    ] = 0.01
    seed: Annotated[
        int,
        Interval(ge=0, le=2**32 - 1),
        About("seed of the bootstrap", flag="--seed"),
    ] = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreFiles(Request):
    """Files of ``score``."""

    model: Annotated[
        Path,
        About("model of `stepnc learn`, .skops", use=FileUse.INPUT, metavar="MODEL"),
    ]
    runs: Annotated[
        Path,
        About(
            "measured runs in their order: settings and target, .parquet or .csv",
            use=FileUse.INPUT, metavar="RUNS",
        ),
    ]  # fmt: skip


REQUEST, FILES = ScoreRequest, ScoreFiles
