"""Requests to learn from a data set, to predict, and to score measured runs."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, Request

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
class PredictRequest(Request):
    """Settings of one part to predict."""

    feed_mm_s: Annotated[
        float | None, About("feed, mm/s", unit="mm/s", flag="--feed-mm-s", metavar="V")
    ] = None
    spindle_rad_s: Annotated[
        float | None,
        About("spindle speed, rad/s", unit="rad/s", flag="--spindle-rad-s", metavar="V"),
    ] = None
    depth_mm: Annotated[
        float | None, About("depth of a pass, mm", unit="mm", flag="--depth-mm", metavar="V")
    ] = None
    tool_diameter_mm: Annotated[
        float | None,
        About("tool diameter, mm", unit="mm", flag="--tool-diameter-mm", metavar="V"),
    ] = None
    flank_wear_mm: Annotated[
        float | None, About("flank wear, mm", unit="mm", flag="--flank-wear-mm", metavar="V")
    ] = None
    total_power_exact_w: Annotated[
        float | None,
        About(
            "total power by the physics, W, for a model on it",
            unit="W",
            flag="--total-power-exact-w",
            metavar="V",
        ),
    ] = None
    energy_exact_j: Annotated[
        float | None,
        About(
            "energy by the physics, J, for a model on it",
            unit="J",
            flag="--energy-exact-j",
            metavar="V",
        ),
    ] = None
    part: Annotated[
        str | None, About("program, if the model has several", flag="--part", metavar="NAME")
    ] = None
    machine: Annotated[
        str | None, About("machine, if the model has several", flag="--machine", metavar="NAME")
    ] = None
    material: Annotated[
        str | None,
        About("material, if the model has several", flag="--material", metavar="NAME"),
    ] = None


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
