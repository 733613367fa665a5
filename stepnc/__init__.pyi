"""Functions of ``stepnc``, made by ``python -m tests.tree.python_stub``."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

from service.verbs.result import Result as Result
from stepnc_model.errors import StepNcError as StepNcError

from service.verbs.blockfit.result import BlockFitResult as BlockFitResult
from service.verbs.blocktest.result import BlockTestResult as BlockTestResult
from service.verbs.cycletime.result import CycleTimeResult as CycleTimeResult

def blockfit(
    log: str | Path,
    *,
    program: str | Path | None = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    dialect: str | Path = ...,
    zero: str | Path = ...,
    machine: str | Path = ...,
) -> BlockFitResult: ...
def blocktest(
    *,
    output: str | Path,
    machine: str | Path = ...,
    dialect: str | Path = ...,
    unit: Literal['in', 'mm'] = ...,
    spacing: float | Iterable[float] | None = ...,
    radius: float | Iterable[float] | None = ...,
    feed: float | None = ...,
    lines: int = ...,
) -> BlockTestResult: ...
def cycletime(
    file: str | Path,
    log: str | Path | None = ...,
    *,
    most_repeats: int | None = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    dialect: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir'] = ...,
    deviation_mm: float = ...,
) -> CycleTimeResult: ...