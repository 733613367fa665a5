"""Request of ``calibrate``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import MostRepeats, ToolsUnit
from service.requests.given import Name
from service.requests.runs import MotionRequest
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
    dialect: Annotated[
        Name,
        About(
            "dialect of the NC code: linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical",
            flag="--dialect", metavar="NAME",
        ),
    ] = ""  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationFiles(Request):
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
    program: Annotated[
        Path | None,
        About(
            "the STEP-NC program that was run", flag="--program", use=FileUse.INPUT,
            metavar="FILE",
        ),
    ] = None  # fmt: skip
    nc: Annotated[
        Path | None,
        About(
            "the NC code that was run, instead of the program's own", flag="--nc",
            use=FileUse.INPUT, metavar="CODE",
        ),
    ] = None  # fmt: skip
    tools: Annotated[
        Path | None,
        About(
            "tool table, for NC code without a program: TOML or CSV, LinuxCNC's tool.tbl, a "
            "library of Fusion (.json, .tools), HSMWorks (.hsmlib) or FreeCAD (.fctl)",
            flag="--tools", use=FileUse.INPUT, metavar="TABLE",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    most_repeats: MostRepeats = None
    output: Annotated[
        Path | None,
        About(
            "write the calibrated machine, or the [[tool_life]] table of a material",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = CalibrationRequest, CalibrationFiles
