"""Request of ``validate``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from extras.calibration.verbs.calibrate.request import EdgeMaterial, Only, WearCriterion
from service.requests.advice import MaterialName
from service.requests.fields import About, FileUse, Request
from simulator.spec import CuttingMaterial


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidateRequest(Request):
    """Request to predict measured cuts."""

    material: MaterialName = ""
    only: Only = ()
    edge: EdgeMaterial = CuttingMaterial.CARBIDE
    wear_criterion_mm: WearCriterion = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidateFiles(Request):
    """Files of ``validate``."""

    table: Annotated[
        Path,
        About(
            "table of measured cuts", flag="--table", use=FileUse.INPUT, metavar="CUTS.csv",
        ),
    ]  # fmt: skip


REQUEST, FILES = ValidateRequest, ValidateFiles
