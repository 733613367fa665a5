"""Functions of ``stepnc``, made by ``python -m tests.tree.python_stub``."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

from service.verbs.result import Result as Result
from stepnc_model.errors import StepNcError as StepNcError

from service.verbs.blockfit.result import BlockFitResult as BlockFitResult
from service.verbs.blocktest.result import BlockTestResult as BlockTestResult
from service.verbs.calibrate.result import CalibrationResult as CalibrationResult
from service.verbs.calibrate.tool_life import ToolLifeResult as ToolLifeResult
from service.verbs.cycletime.result import CycleTimeResult as CycleTimeResult
from service.verbs.learn.result import LearnResult as LearnResult
from service.verbs.optimise.result import OptimiseResult as OptimiseResult
from service.verbs.predict.result import PredictResult as PredictResult
from service.verbs.score.result import ScoreResult as ScoreResult
from service.verbs.taptest.result import TapTestResult as TapTestResult
from service.verbs.verify.result import VerificationResult as VerificationResult

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
def calibrate(
    runs: str | Path | Iterable[str | Path] = ...,
    *,
    tool_life: str | Path | None = ...,
    program: str | Path | None = ...,
    nc: str | Path | None = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    most_repeats: int | None = ...,
    output: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir'] = ...,
    filter_s: str | Path = ...,
    deviation_mm: float = ...,
    life: str | Path | Iterable[str | Path] = ...,
    edge: Literal['hss', 'carbide', 'ceramic'] = ...,
    dialect: str | Path = ...,
) -> CalibrationResult | ToolLifeResult: ...
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
def learn(
    dataset: str | Path,
    *,
    output: str | Path | None = ...,
    outcome: str | Path | None = ...,
    program: str | Path | None = ...,
    report: str | Path | None = ...,
    target: str | Path = ...,
    model: str | Path = ...,
    train: int = ...,
    test: int = ...,
    seed: int = ...,
    is_on_physics: bool = ...,
    has_curve: bool = ...,
) -> LearnResult: ...
def optimise(
    file: str | Path,
    *,
    output: str | Path | None = ...,
    in_place: bool = ...,
    holding: str | Path | None = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    most_repeats: int | None = ...,
    kb: str | Path = ...,
    feeds_csv: str | Path | None = ...,
    dry_run: bool = ...,
    report: str | Path | None = ...,
    cluster: str | Path = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    mode: Literal['TC', 'QC', 'EC'] = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    roughness_um: float | None = ...,
    free: Literal['feed', 'depth', 'speed'] | Iterable[Literal['feed', 'depth', 'speed']] = ...,
    workingsteps: str | Path | Iterable[str | Path] = ...,
    profile: Literal['optimisation', 'standard'] = ...,
    records: Literal['all', 'none'] = ...,
    nc_control: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    is_exact_path: bool = ...,
    has_pareto: bool = ...,
    tool_change_s: float = ...,
    has_corrections: bool = ...,
    is_confirmed: bool = ...,
    safety: float = ...,
    centre_cutting: Mapping[str, bool] = ...,
    ignore_record: bool = ...,
    keep_going: bool = ...,
    allow_plunge: bool = ...,
    is_along_path: bool = ...,
    levels: int | None = ...,
    motion: Literal['exact-stop', 'junction', 'fir'] = ...,
    is_jerk_limited: bool = ...,
    smooth_share: float | None = ...,
    writes_toolpaths: bool = ...,
    stock_margin_mm: float = ...,
    corner_tolerance_mm: float = ...,
    max_feed_mm_min: float | None = ...,
    greatest_rise: float = ...,
    least_feed_mm_min: float | None = ...,
    finish: str | Path | Iterable[str | Path] = ...,
    keep: str | Path | Iterable[str | Path] = ...,
    is_unrolled: bool = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    is_marked: bool = ...,
) -> OptimiseResult: ...
def predict(
    model: str | Path,
    table: str | Path | None = ...,
    *,
    feed_mm_s: float | None = ...,
    spindle_rad_s: float | None = ...,
    depth_mm: float | None = ...,
    tool_diameter_mm: float | None = ...,
    flank_wear_mm: float | None = ...,
    total_power_exact_w: float | None = ...,
    energy_exact_j: float | None = ...,
    part: str | Path | None = ...,
    machine: str | Path | None = ...,
    material: str | Path | None = ...,
) -> PredictResult: ...
def score(
    model: str | Path,
    runs: str | Path,
    *,
    false_alarm: float = ...,
    seed: int = ...,
) -> ScoreResult: ...
def taptest(
    response: str | Path,
    *,
    output: str | Path | None = ...,
    direction: Literal['x', 'y', 'z', 'xy'],
    tool: str | Path = ...,
    tool_diameter_mm: float | None = ...,
    workpiece: bool = ...,
    modes: int | None = ...,
    source: str | Path = ...,
    machine: str | Path = ...,
) -> TapTestResult: ...
def verify(
    log: str | Path,
    *,
    program: str | Path | None = ...,
    tools: str | Path | None = ...,
    required: str | Path = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    zero: str | Path = ...,
    tolerance_mm: float = ...,
    cell_mm: float | None = ...,
    has_deflection: bool = ...,
) -> VerificationResult: ...