"""Functions of ``stepnc``, made by ``python -m tests.tree.python_stub``."""

from collections.abc import Iterable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Literal

from service.verbs.result import Result as Result
from stepnc_model.errors import StepNcError as StepNcError

from extras.agent.verbs.record.result import RecordingResult as RecordingResult
from extras.calibration.verbs.blockfit.result import BlockFitResult as BlockFitResult
from extras.calibration.verbs.blocktest.result import BlockTestResult as BlockTestResult
from extras.calibration.verbs.calibrate.cuts import CutsResult as CutsResult
from extras.calibration.verbs.calibrate.cuts import CutsResult as CutsResult
from extras.calibration.verbs.calibrate.result import CalibrationResult as CalibrationResult
from extras.calibration.verbs.calibrate.tool_life import ToolLifeResult as ToolLifeResult
from extras.calibration.verbs.taptest.result import TapTestResult as TapTestResult
from extras.factory.verbs.factory.result import ShopResult as ShopResult
from extras.learning.verbs.dataset.result import DatasetReport as DatasetReport
from extras.learning.verbs.learn.result import LearnResult as LearnResult
from extras.learning.verbs.predict.result import PredictResult as PredictResult
from extras.learning.verbs.score.result import ScoreResult as ScoreResult
from extras.verification.verbs.verify.result import VerificationResult as VerificationResult
from service.verbs.canonical.result import CanonicalResult as CanonicalResult
from service.verbs.check.result import CodeContents as CodeContents
from service.verbs.check.result import ProgramContents as ProgramContents
from service.verbs.compare.result import ComparisonResult as ComparisonResult
from service.verbs.control.result import ControlResult as ControlResult
from service.verbs.convert.result import ConvertResult as ConvertResult
from service.verbs.cycletime.result import CycleTimeResult as CycleTimeResult
from service.verbs.kbe.add.result import AddResult as AddResult
from service.verbs.kbe.content import ContentResult as ContentResult
from service.verbs.kbe.content import ContentResult as ContentResult
from service.verbs.kbe.content import ContentResult as ContentResult
from service.verbs.kbe.corrections.result import CorrectionsResult as CorrectionsResult
from service.verbs.kbe.corrections.result import CorrectionsResult as CorrectionsResult
from service.verbs.kbe.corrections.result import CorrectionsResult as CorrectionsResult
from service.verbs.kbe.corrections.result import CorrectionsResult as CorrectionsResult
from service.verbs.kbe.export.result import ExportResult as ExportResult
from service.verbs.kbe.list.result import OutcomesResult as OutcomesResult
from service.verbs.kbe.read.result import RecordedResult as RecordedResult
from service.verbs.kbe.review.result import ReviewReport as ReviewReport
from service.verbs.kbe.show.result import RunResult as RunResult
from service.verbs.kbe.table.result import EvaluationResult as EvaluationResult
from service.verbs.kbe.table.result import SummaryResult as SummaryResult
from service.verbs.kbe.write.result import WriteResult as WriteResult
from service.verbs.keys.create.result import NewKeyResult as NewKeyResult
from service.verbs.keys.list.result import KeysResult as KeysResult
from service.verbs.keys.revoke.result import RevokedResult as RevokedResult
from service.verbs.library import EntryResult as EntryResult
from service.verbs.library import EntryResult as EntryResult
from service.verbs.library import ListingResult as ListingResult
from service.verbs.library import ListingResult as ListingResult
from service.verbs.optimise.result import OptimiseResult as OptimiseResult
from service.verbs.post.result import PostResult as PostResult
from service.verbs.result import ServedResult as ServedResult
from service.verbs.result import ServedResult as ServedResult
from service.verbs.result import ServedResult as ServedResult
from service.verbs.setup.result import SetupResult as SetupResult
from service.verbs.simulate.result import SimulateResult as SimulateResult
from service.verbs.toolpath.result import CodePathResult as CodePathResult
from service.verbs.toolpath.result import ToolPathResult as ToolPathResult

def agent(
    file: str | Path | None = ...,
    *,
    nc: str | Path | None = ...,
    dialect: str | Path = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    setup: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    device: str | Path | None = ...,
    schema_files: str | Path | None = ...,
    runs: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
    filter_s: str | Path = ...,
    deviation_mm: float = ...,
    program_id: str | Path | None = ...,
    advice_id: str | Path | None = ...,
    pace: float = ...,
    keep_going: bool = ...,
    seed: int = ...,
    rate_hz: float = ...,
    force: Literal['mean', 'tooth'] = ...,
    kc_factor: float = ...,
    runout_um: float = ...,
    has_wear: bool = ...,
    has_lag: bool = ...,
    has_power_deviation: bool = ...,
    noise: Literal['none', 'normal', 'uniform'] = ...,
    missing: float = ...,
    zero: str | Path = ...,
    schema: Literal['1.3', '2.0', '2.7'] = ...,
    names: Literal['modern', 'papers'] = ...,
    part: str | Path = ...,
    batch: str | Path = ...,
    speed: float = ...,
    is_looped: bool = ...,
    buffer: int = ...,
    port: int = ...,
    host: str | Path = ...,
    host_names: str | Path | Iterable[str | Path] = ...,
    shdr_port: int | None = ...,
    allows_put: bool = ...,
    mqtt: str | Path | None = ...,
    adapters: str | Path | Iterable[str | Path] = ...,
) -> ServedResult: ...
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
    file: str | Path | None = ...,
    nc: str | Path | None = ...,
    dialect: str | Path = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    setup: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    tool_life: str | Path | None = ...,
    table: str | Path | None = ...,
    output: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
    filter_s: str | Path = ...,
    deviation_mm: float = ...,
    life: str | Path | Iterable[str | Path] = ...,
    edge: Literal['hss', 'carbide', 'ceramic'] = ...,
    only: Literal['forces', 'roughness', 'life'] | Iterable[Literal['forces', 'roughness', 'life']] = ...,
    wear_criterion_mm: float = ...,
    anyway: bool = ...,
) -> CalibrationResult | CutsResult | ToolLifeResult: ...
def canonical(
    file: str | Path,
    *,
    tools: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    is_lathe: bool = ...,
    keep_going: bool = ...,
) -> CanonicalResult: ...
def check(
    file: str | Path,
    *,
    tools: str | Path | None = ...,
    name: str | Path = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
) -> ProgramContents | CodeContents: ...
def compare(
    plans: str | Path | Iterable[str | Path],
    *,
    output: str | Path | None = ...,
    format: Literal['text', 'csv', 'json', 'html', 'parquet'] | None = ...,
) -> ComparisonResult: ...
def control(
    file: str | Path | None = ...,
    *,
    nc: str | Path | None = ...,
    dialect: str | Path = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    setup: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    band: str | Path = ...,
    recorded: str | Path | None = ...,
    loads: str | Path | None = ...,
    teach: bool = ...,
    cut_log: str | Path | None = ...,
    linuxcnc: str | Path = ...,
    virtual_load: bool = ...,
    load_pin: str | Path = ...,
    load_unit: Literal['%', 'A', 'W', 'N'] = ...,
    rated: float = ...,
    load_limit: float = ...,
    kb: str | Path = ...,
    by: str | Path = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
    filter_s: str | Path = ...,
    deviation_mm: float = ...,
    program_id: str | Path | None = ...,
    advice_id: str | Path | None = ...,
    pace: float = ...,
    keep_going: bool = ...,
    seed: int = ...,
    mode: Literal['TC', 'QC'] = ...,
    law: Literal['pi', 'log-pi', 'fuzzy', 'self-tuning', 'mrac', 'mpc', 'none'] = ...,
    has_preview: bool = ...,
    look_ahead: int = ...,
    disturbances: str | Path | Iterable[str | Path] = ...,
    force_set_point_n: float | None = ...,
    override_low_percent: float = ...,
    override_high_percent: float = ...,
    sensor: Literal['dynamometer', 'components', 'power'] = ...,
    has_corrections: bool = ...,
    is_recorded: bool = ...,
) -> ControlResult: ...
def convert(
    file: str | Path,
    *,
    output: str | Path,
    to: Literal['iso14649', 'ap238'] | None = ...,
    profile: Literal['optimisation', 'standard'] | None = ...,
) -> ConvertResult: ...
def cycletime(
    file: str | Path,
    log: str | Path | None = ...,
    *,
    tools: str | Path | None = ...,
    setup: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    dialect: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
    deviation_mm: float = ...,
) -> CycleTimeResult: ...
def dataset(
    design: str | Path,
    *,
    output: str | Path,
    cluster: str | Path = ...,
    rows: int | None = ...,
    has_csv: bool = ...,
    has_programs: bool = ...,
) -> DatasetReport: ...
def factory(
    shop: str | Path,
    *,
    output: str | Path | None = ...,
    has_report: bool = ...,
    cluster: str | Path = ...,
    hours: float | None = ...,
    warm_up_hours: float | None = ...,
    seed: int = ...,
    replications: int = ...,
    sweep: str | Path | Iterable[str | Path] = ...,
    has_energy: bool = ...,
    documents: int = ...,
    is_live: bool = ...,
    speed: float = ...,
    port: int = ...,
    host: str | Path = ...,
    host_names: str | Path | Iterable[str | Path] = ...,
    buffer: int = ...,
) -> ShopResult | ServedResult: ...
def kbe_accept(
    ids: int | Iterable[int],
    *,
    kb: str | Path = ...,
    by: str | Path = ...,
) -> CorrectionsResult: ...
def kbe_add(
    file: str | Path,
    *,
    kb: str | Path = ...,
) -> AddResult: ...
def kbe_backup(
    file: str | Path,
    *,
    kb: str | Path = ...,
) -> ContentResult: ...
def kbe_check(
    *,
    kb: str | Path = ...,
) -> ContentResult: ...
def kbe_corrections(
    *,
    kb: str | Path = ...,
) -> CorrectionsResult: ...
def kbe_export(
    what: Literal['outcomes', 'corrections', 'table'],
    *,
    kb: str | Path = ...,
    output: str | Path,
    format: Literal['text', 'csv', 'json', 'html', 'parquet'] | None = ...,
    summary: bool = ...,
    machine: str | Path | None = ...,
    material: str | Path | None = ...,
    tool: str | Path | None = ...,
    feature_kind: str | Path | None = ...,
    program: str | Path | None = ...,
    run: str | Path | None = ...,
    since: datetime | str | None = ...,
    until: datetime | str | None = ...,
    grouping: Literal['feature', 'kind'] = ...,
    only: Literal['all', 'violated', 'wasted', 'with remarks', 'with trend', 'factor pending'] = ...,
    sort: Literal['name', 'grade', 'runs', 'latest', 'force', 'time', 'feed', 'roughness', 'time to win'] = ...,
) -> ExportResult: ...
def kbe_list(
    *,
    kb: str | Path = ...,
    machine: str | Path | None = ...,
    material: str | Path | None = ...,
    tool: str | Path | None = ...,
    feature_kind: str | Path | None = ...,
    program: str | Path | None = ...,
    run: str | Path | None = ...,
    since: datetime | str | None = ...,
    until: datetime | str | None = ...,
    limit: int = ...,
) -> OutcomesResult: ...
def kbe_read(
    file: str | Path,
) -> RecordedResult: ...
def kbe_restore(
    file: str | Path,
    *,
    kb: str | Path = ...,
) -> ContentResult: ...
def kbe_review(
    *,
    kb: str | Path = ...,
    by: str | Path = ...,
    auto_accept: bool = ...,
    least_confidence: float = ...,
    fewest_outcomes: int = ...,
    greatest_change: float = ...,
    machine: str | Path | None = ...,
    material: str | Path | None = ...,
    tool: str | Path | None = ...,
    feature_kind: str | Path | None = ...,
    program: str | Path | None = ...,
    run: str | Path | None = ...,
    since: datetime | str | None = ...,
    until: datetime | str | None = ...,
) -> ReviewReport: ...
def kbe_show(
    id: str | Path,
    *,
    kb: str | Path = ...,
) -> RunResult | CorrectionsResult: ...
def kbe_table(
    *,
    output: str | Path | None = ...,
    format: Literal['text', 'csv', 'json', 'html', 'parquet'] | None = ...,
    kb: str | Path = ...,
    summary: bool = ...,
    machine: str | Path | None = ...,
    material: str | Path | None = ...,
    tool: str | Path | None = ...,
    feature_kind: str | Path | None = ...,
    program: str | Path | None = ...,
    run: str | Path | None = ...,
    since: datetime | str | None = ...,
    until: datetime | str | None = ...,
    grouping: Literal['feature', 'kind'] = ...,
    only: Literal['all', 'violated', 'wasted', 'with remarks', 'with trend', 'factor pending'] = ...,
    sort: Literal['name', 'grade', 'runs', 'latest', 'force', 'time', 'feed', 'roughness', 'time to win'] = ...,
) -> EvaluationResult | SummaryResult: ...
def kbe_withdraw(
    ids: int | Iterable[int],
    *,
    kb: str | Path = ...,
    by: str | Path = ...,
) -> CorrectionsResult: ...
def kbe_write(
    file: str | Path,
    *,
    kb: str | Path = ...,
    output: str | Path | None = ...,
    run: str | Path = ...,
) -> WriteResult: ...
def keys_create(
    *,
    data: str | Path | None = ...,
    database: str | Path = ...,
    files: str | Path = ...,
    owner: str | Path,
    roles: Literal['viewer', 'planner', 'operator'] | Iterable[Literal['viewer', 'planner', 'operator']] = ...,
) -> NewKeyResult: ...
def keys_list(
    *,
    data: str | Path | None = ...,
    database: str | Path = ...,
    files: str | Path = ...,
) -> KeysResult: ...
def keys_revoke(
    id: str | Path,
    *,
    data: str | Path | None = ...,
    database: str | Path = ...,
    files: str | Path = ...,
) -> RevokedResult: ...
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
def machines(
    name: str | Path | None = ...,
) -> ListingResult | EntryResult: ...
def materials(
    name: str | Path | None = ...,
) -> ListingResult | EntryResult: ...
def optimise(
    file: str | Path,
    *,
    output: str | Path | None = ...,
    in_place: bool = ...,
    holding: str | Path | None = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    setup: str | Path | None = ...,
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
    mode: Literal['TC', 'QC', 'EC', 'CC'] = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    roughness_um: float | None = ...,
    roughness_quantile: float = ...,
    free: Literal['feed', 'depth', 'speed'] | Iterable[Literal['feed', 'depth', 'speed']] = ...,
    workingsteps: str | Path | Iterable[str | Path] = ...,
    profile: Literal['optimisation', 'standard'] | None = ...,
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
    motion: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
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
    keeps_state: str | Path | Iterable[str | Path] = ...,
    spindle: str | Path | Iterable[str | Path] = ...,
    is_unrolled: bool = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    is_marked: bool = ...,
) -> OptimiseResult: ...
def post(
    file: str | Path,
    *,
    tools: str | Path | None = ...,
    output: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    control: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'],
    cycles: bool = ...,
    exact_path: bool = ...,
    adaptive_feed: bool = ...,
    keep_going: bool = ...,
) -> PostResult: ...
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
def record(
    url: str | Path,
    *,
    output: str | Path,
    duration_s: float | None = ...,
    is_until_completed: bool = ...,
    is_buffered: bool = ...,
    is_next_run: bool = ...,
) -> RecordingResult: ...
def score(
    model: str | Path,
    runs: str | Path,
    *,
    false_alarm: float = ...,
    seed: int = ...,
) -> ScoreResult: ...
def serve(
    *,
    data: str | Path | None = ...,
    database: str | Path = ...,
    files: str | Path = ...,
    kb: str | Path = ...,
    tls_cert: str | Path | None = ...,
    tls_key: str | Path | None = ...,
    host: str | Path = ...,
    port: int = ...,
    workers: int = ...,
    jobs: int = ...,
    job_memory_gb: int = ...,
    names: str | Path | Iterable[str | Path] = ...,
    agents: str | Path | Iterable[str | Path] = ...,
    needs_keys: bool = ...,
    upload_mb: int = ...,
    rate: float | None = ...,
    log_level: Literal['debug', 'info', 'warning', 'error'] = ...,
) -> ServedResult: ...
def setup(
    file: str | Path,
    *,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    stock: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    output: str | Path | None = ...,
    dry_run: bool = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    material: str | Path = ...,
    machine: str | Path = ...,
) -> SetupResult: ...
def simulate(
    file: str | Path | None = ...,
    *,
    nc: str | Path | None = ...,
    dialect: str | Path = ...,
    tools: str | Path | None = ...,
    tools_unit: Literal['mm', 'inch'] | None = ...,
    setup: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    carbon_g_kwh: float | None = ...,
    keep_stock: str | Path | None = ...,
    mtconnect: str | Path | None = ...,
    schema: Literal['1.3', '2.0', '2.7'] = ...,
    names: Literal['modern', 'papers'] = ...,
    part: str | Path = ...,
    batch: str | Path = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    material: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir', 'linuxcnc'] = ...,
    filter_s: str | Path = ...,
    deviation_mm: float = ...,
    program_id: str | Path | None = ...,
    advice_id: str | Path | None = ...,
    pace: float = ...,
    keep_going: bool = ...,
    seed: int = ...,
    rate_hz: float = ...,
    force: Literal['mean', 'tooth'] = ...,
    kc_factor: float = ...,
    runout_um: float = ...,
    has_wear: bool = ...,
    has_lag: bool = ...,
    has_power_deviation: bool = ...,
    noise: Literal['none', 'normal', 'uniform'] = ...,
    missing: float = ...,
    zero: str | Path = ...,
) -> SimulateResult: ...
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
def toolpath(
    file: str | Path,
    *,
    tools: str | Path | None = ...,
    most_repeats: int | None = ...,
    keeps_state: str | Path | Iterable[str | Path] = ...,
    plot: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    keep_going: bool = ...,
) -> ToolPathResult | CodePathResult: ...
def validate(
    *,
    table: str | Path,
    material: str | Path = ...,
    only: Literal['forces', 'roughness', 'life'] | Iterable[Literal['forces', 'roughness', 'life']] = ...,
    edge: Literal['hss', 'carbide', 'ceramic'] = ...,
    wear_criterion_mm: float = ...,
) -> CutsResult: ...
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