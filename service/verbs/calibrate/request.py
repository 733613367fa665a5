"""Request of ``calibrate``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse
from service.requests.runs import MotionRequest
from service.simulation.run_files import CodeOfRun
from simulator.spec import CuttingMaterial


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationRequest(MotionRequest):
    """Request to fit a machine to its runs, or Taylor's law to tool lives."""

    life: Annotated[
        tuple[str, ...],
        About(
            "tool life of T min at V m/min, as 120:25; two or more fit Taylor's law",
            flag="--life", metavar="V:T",
        ),
    ] = ()  # fmt: skip
    edge: Annotated[
        CuttingMaterial,
        About(
            "edge material of the tool lives: hss, carbide or ceramic", name="edge material",
            flag="--edge",
        ),
    ] = CuttingMaterial.CARBIDE  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationFiles(CodeOfRun):
    """Files of ``calibrate``."""

    runs: Annotated[
        tuple[Path, ...],
        About("measured runs of the program", use=FileUse.INPUT, metavar="RUN.csv"),
    ] = ()
    tool_life: Annotated[
        Path | None,
        About(
            "file with pairs as those of --life, columns speed_m_min and life_min",
            flag="--tool-life", use=FileUse.INPUT, metavar="CSV",
        ),
    ] = None  # fmt: skip
    file: Annotated[
        Path | None,
        About(
            "the program that was run, STEP-NC or NC code", flag="--program", use=FileUse.INPUT,
            metavar="FILE",
        ),
    ] = None  # fmt: skip
    output: Annotated[
        Path | None,
        About(
            "write the calibrated machine, or the [[tool_life]] table of a material",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = CalibrationRequest, CalibrationFiles
