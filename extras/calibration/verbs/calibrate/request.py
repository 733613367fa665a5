"""Request of ``calibrate``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from extras.calibration.model.cut_laws import LawKind
from service.requests.fields import About, FileUse
from service.requests.runs import MotionRequest
from service.simulation.run_files import CodeOfRun
from simulator.spec import CuttingMaterial

EdgeMaterial = Annotated[
    CuttingMaterial,
    About(
        "edge material of the tool lives: hss, carbide or ceramic", name="edge material",
        flag="--edge",
    ),
]  # fmt: skip
Only = Annotated[
    tuple[LawKind, ...],
    About(
        "quantities of a table to use: forces,roughness,life (default: all that it holds)",
        flag="--only", metavar="WORDS",
    ),
]  # fmt: skip
WearCriterion = Annotated[
    float,
    Interval(ge=0.01, le=5.0),
    About(
        "flank wear at which an edge of a table is worn out", unit="mm", name="wear criterion",
        flag="--wear-criterion-mm", metavar="MM",
    ),
]  # fmt: skip


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
    edge: EdgeMaterial = CuttingMaterial.CARBIDE
    only: Only = ()
    wear_criterion_mm: WearCriterion = 0.3
    anyway: Annotated[
        bool,
        About(
            "write a law of a table that predicts worse than a simpler rule", flag="--anyway"
        ),
    ] = False


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
    table: Annotated[
        Path | None,
        About(
            "table of measured cuts: forces, roughness and tool life of --material",
            flag="--table", use=FileUse.INPUT, metavar="CUTS.csv",
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
            "write the calibrated machine or material, or a [[tool_life]] table",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = CalibrationRequest, CalibrationFiles
