"""Request of ``predict``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request


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
class PredictFiles(Request):
    """Files of ``predict``."""

    model: Annotated[
        Path,
        About("model of `stepnc learn`, .skops", use=FileUse.INPUT, metavar="MODEL"),
    ]
    table: Annotated[
        Path | None, About("rows, .parquet or .csv", use=FileUse.INPUT, metavar="TABLE")
    ] = None


REQUEST, FILES = PredictRequest, PredictFiles
