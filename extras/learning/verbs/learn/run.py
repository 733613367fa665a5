"""Learning: a model, its scores, and those of what is simpler.

Rows are read in pieces. Trees, Gaussian processes and networks of few rows hold them all; power
laws and other networks only sums and the piece at hand.

A learned factor on k_c as an outcome for the knowledge base: the door by which plans get it.

The outcome stands for all runs that the factor was learned from. `stepnc kbe add` takes its
file, `review` proposes the correction, and a person accepts it.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from math import log, sqrt
from pathlib import Path
from uuid import uuid4

import numpy as np
import pyarrow as pa

from extras.learning.dataset_folder import IN_METADATA
from extras.learning.model_file import save_model
from extras.learning.models import (
    IN_MEMORY,
    Baseline,
    ForceFactor,
    LearnedModel,
    ModelKind,
    Pieces,
    fitted_law,
    force_factor_of,
    quantiles_of,
    require_trainable,
    trained,
)
from extras.learning.scores import (
    FITTED,
    MEAN,
    PHYSICS_ALONE,
    CurvePoint,
    ScoredModel,
    scores_of,
)
from extras.learning.source import RowSource
from extras.learning.table import (
    CUTTING,
    PHYSICS,
    TARGETS,
    Features,
    Floats,
    LearningTable,
    features_of,
    joined,
    learning_table,
    require_columns,
)
from extras.learning.verbs.learn.request import LearnFiles, LearnRequest
from extras.learning.verbs.learn.result import LearnResult
from kbe.rows import OUTCOME
from service.files import require_places, write_atomically
from service.programs.reading import read_program
from service.progress import Tell, silent
from service.rendering.columns import dump, plain
from service.requests.fields import member_of
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    ProcessOutcome,
)
from stepnc_model.plurals import counted
from stepnc_model.programs.tool import tool_of

MOST_FACTOR = 5.0
"""Factor, up or down, from which one is a mistake."""


def write_outcome(
    path: Path,
    factor: ForceFactor,
    *,
    program: Path,
    names: Mapping[str, Sequence[str]],
    run: str = "",
) -> None:
    """Write the outcome of a factor as `stepnc kbe add` reads it.

    Parameters
    ----------
    program : Path
        Program of the runs, which mills with one tool.
    names : mapping
        Machines and materials of the runs, by column.
    run : str
        Id of the outcome; empty: a new one.

    Raises
    ------
    StepNcError
        When the runs are of several machines or materials, the program has several tools, or
        the factor cannot be.
    """
    one = {}
    for column in ("machine", "material"):
        values = sorted(set(names[column]))
        if len(values) != 1:
            raise StepNcError(
                f"a factor on k_c belongs to one {column}, but the runs have "
                f"{', '.join(values)}"
            )
        one[column] = values[0]
    if not 1.0 / MOST_FACTOR < factor.factor < MOST_FACTOR:
        raise StepNcError(
            f"factor {factor.factor:.3g} on k_c: it must be {1.0 / MOST_FACTOR:g} to "
            f"{MOST_FACTOR:g}"
        )
    outcome = _outcome(factor, program, run or f"learned-{uuid4().hex[:12]}", one)
    write_atomically(path, dump([plain(OUTCOME.row(outcome))]).encode())


def _outcome(
    factor: ForceFactor, path: Path, run: str, names: dict[str, str]
) -> ProcessOutcome:
    program = read_program(path, units="iso")
    steps = [
        each
        for each in program.workingsteps
        if isinstance(each.operation, MillingTypeOperation)
    ]
    tools = {tool_of(program, each.tool_ref).id for each in steps}
    if len(tools) != 1:
        raise StepNcError(
            f"{path}: a factor on k_c belongs to one tool, but the program mills with "
            f"{', '.join(sorted(tools)) or 'none'}"
        )
    step = steps[0]
    feature = program.get(step.features[0]) if step.features else None
    nothing = EvaluatedQuantity()
    # The base of knowledge takes the readings of a ratio for correlated revolutions of one cut;
    # so the deviation of a reading is such that their mean has the error of the fit, or more.
    error = factor.factor_error / factor.factor
    return replace(
        EMPTY,
        context=Context(tool=tools.pop(), **names),
        program=program.name,
        workingstep=step.id,
        feature=FeatureFacts(
            id=str(getattr(feature, "its_id", "")),
            kind="" if feature is None else feature.express_name(),
        ),
        step_depth=nothing,
        force_ratio=ForceRatio(
            log_mean=log(factor.factor),
            log_deviation=error * sqrt(factor.runs),
            readings=factor.runs,
        ),
        run=run,
        recorded_at=datetime.now(UTC),
    )


EMPTY = ProcessOutcome(
    context=Context(machine="", material="", tool=""),
    program="",
    workingstep="",
    feature=FeatureFacts(id="", kind=""),
    is_finishing=False,
    mode="TC",
    specific_force=None,
    cutting_speed=None,
    step_depth=EvaluatedQuantity(),
    feed_per_tooth=EvaluatedQuantity(),
    immersion=None,
    strategy="",
    roughness=EvaluatedQuantity(),
    time=EvaluatedQuantity(),
    force=EvaluatedQuantity(),
    feed=EvaluatedQuantity(),
    force_bound=None,
    force_ratio=None,
    trace="",
    run="",
    recorded_at=datetime.min.replace(tzinfo=UTC),
    recorded_by="stepnc learn",
)
"""Outcome in which nothing was measured."""


FEWEST_OF_CURVE = 20
"""Rows from which a learning curve begins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LearningRows:
    """Rows of a source that train and test."""

    source: RowSource
    features: Features
    columns: tuple[str, ...]
    """Columns that are read."""
    names: Mapping[str, tuple[str, ...]]
    """Parts, machines and materials."""
    request: LearnRequest
    manifest: str
    """Digest of the manifest; empty: there is none."""

    @property
    def place(self) -> str:
        """Origin of the rows, for messages."""
        return str(self.source.path)

    def pieces(self, first: int, last: int) -> Iterator[LearningTable]:
        """Yield rows from number ``first``, counted from 0, to before ``last``, in pieces."""
        at = first
        for table in self.source.pieces(first, last, self.columns):
            yield learning_table(
                table, self.features, self.request.target, place=self.place, first=at
            )
            at += table.num_rows

    def training(self, count: int) -> Pieces:
        """Targets of the model: the rows' own, or over the physics."""
        if not self.request.is_on_physics:
            return lambda: self.pieces(0, count)
        return lambda: (each.over_physics for each in self.pieces(0, count))


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingFacts:
    """Facts from one pass over the training rows."""

    low: Floats
    """Least value of each feature, (F,)."""
    high: Floats
    mean: float
    """Mean of the target."""


def run(request: LearnRequest, files: LearnFiles, *, tell: Tell = silent) -> LearnResult:
    """Train a model on the first rows of a data set and test it on the next ones.

    Raises
    ------
    StepNcError
        When the request, the data set or its target is not usable, or a file not writable.
    """
    require_places([files.output, files.report, files.outcome])
    if (files.outcome is None) is not (files.program is None):
        raise StepNcError("--outcome and --program belong together")
    if files.outcome is not None and not request.is_on_physics:
        raise StepNcError("--outcome: a factor on k_c needs --on-physics")
    result = _learned(files.dataset, request)
    if files.outcome is not None and files.program is not None:
        _write_factor(result, files.outcome, files, files.program)
        tell(f"outcome: {files.outcome}; `stepnc kbe add {files.outcome}` takes it")
    for text in result.warnings:
        tell(f"scikit-learn: {text}")
    if files.output is not None:
        save_model(result.model, files.output)
        tell(f"model: {files.output}")
    return result


def _write_factor(result: LearnResult, outcome: Path, files: LearnFiles, program: Path) -> None:
    """Write the factor on k_c for the knowledge base."""
    if result.factor is None:
        raise StepNcError(
            f"{files.dataset}: no factor on k_c: it needs the target total_power_w and a "
            "column cutting_power_w that varies"
        )
    write_outcome(outcome, result.factor, program=program, names=result.names)


def _learned(path: Path, request: LearnRequest) -> LearnResult:
    """Model with its scores, and those of what is simpler."""
    kind = member_of(ModelKind, request.model, "model")
    target = request.target
    if target not in TARGETS:
        raise StepNcError(f"unknown target '{target}'; known: {', '.join(TARGETS)}")
    if request.is_on_physics and target not in PHYSICS:
        raise StepNcError(f"--on-physics: {target} has no physics; {', '.join(PHYSICS)} have")
    require_trainable(kind, request.train)
    if request.test > IN_MEMORY:
        raise StepNcError(f"--test {request.test}: it must be at most {IN_MEMORY}")
    rows = _rows(path, request)
    facts = _facts(rows)
    model_of = _trainer(rows, kind, facts)
    test = joined(list(rows.pieces(request.train, request.train + request.test)))
    _require_learnable(test.target, f"{path}: {target} of the test rows")
    model, warned = model_of(request.train)
    predicted = _prediction(model, test)
    residuals = quantiles_of(test.target / predicted - 1.0)
    factor = force_factor_of(rows.pieces(0, request.train)) if request.is_on_physics else None
    named = {kind.value: predicted, **_baselines(model, test, factor)}
    scored = tuple(
        ScoredModel(name=name, scores=scores_of(test.target, each, seed=request.seed))
        for name, each in named.items()
    )
    physics = next((each.scores.r2 for each in scored if each.name == PHYSICS_ALONE), None)
    return LearnResult(
        model=replace(model, residuals=residuals),
        test=request.test,
        scored=scored,
        ceiling=None if request.is_on_physics else physics,
        curve=tuple(_curve(model_of, test, request)) if request.has_curve else (),
        warnings=warned,
        factor=factor,
        names=rows.names,
        actual=test.target,
        predicted=predicted,
    )


def _rows(path: Path, request: LearnRequest) -> LearningRows:
    """Rows of a data set, which are enough and have the columns.

    Raises
    ------
    StepNcError
        When there are fewer, or a column is missing.
    """
    source, wanted, place = RowSource(path), request.train + request.test, str(path)
    exact = PHYSICS.get(request.target, "")
    needed = (request.target, *([exact] if request.is_on_physics else []))
    count, first = 0, pa.table({})

    def pieces() -> Iterator[pa.Table]:
        nonlocal count, first
        for table in source.pieces(0, wanted):
            require_columns(table, needed, place=place)
            first = first if count else table
            count += table.num_rows
            yield table

    features, names = features_of(pieces(), place=place)
    if count < wanted:
        raise StepNcError(
            f"{path}: {counted(count, 'row')}, but --train {request.train} and --test "
            f"{request.test} need {wanted}: make more, or ask for less"
        )
    has_physics = bool(exact) and exact in first.column_names
    manifest = (first.schema.metadata or {}).get(IN_METADATA)
    return LearningRows(
        source=source,
        features=features,
        columns=(
            *features.columns,
            request.target,
            *([exact] if has_physics else []),
            *([CUTTING] if CUTTING in first.column_names and request.target != CUTTING else []),
        ),
        names=names,
        request=request,
        manifest="" if manifest is None else sha256(manifest).hexdigest(),
    )


def _facts(rows: LearningRows) -> TrainingFacts:
    """Bounds and mean of the training rows.

    Raises
    ------
    StepNcError
        When their target is constant.
    """
    low = np.full(len(rows.features.columns), np.inf)
    high, least, most, total = -low, np.inf, -np.inf, 0.0
    for piece in rows.pieces(0, rows.request.train):
        low = np.minimum(low, piece.values.min(axis=0))
        high = np.maximum(high, piece.values.max(axis=0))
        least = min(least, float(piece.target.min()))
        most = max(most, float(piece.target.max()))
        total += float(piece.target.sum())
    what = f"{rows.place}: {rows.request.target} of the training rows"
    _require_learnable(np.array([least, most]), what)
    return TrainingFacts(low=low, high=high, mean=total / rows.request.train)


def _require_learnable(target: Floats, what: str) -> None:
    """Refuse a target that is constant.

    Raises
    ------
    StepNcError
        With the value.
    """
    if np.ptp(target) <= 1e-12 * abs(float(target[0])):
        raise StepNcError(f"{what}: all are {target[0]:g}: there is nothing to learn")


Trainer = Callable[[int], tuple[LearnedModel, tuple[str, ...]]]
"""Trains the model with some of the first rows; with what scikit-learn warned of."""


def _trainer(rows: LearningRows, kind: ModelKind, facts: TrainingFacts) -> Trainer:
    request, features = rows.request, rows.features
    law = fitted_law(features, rows.pieces(0, request.train))
    low, high = (dict(zip(features.numbers, each.tolist(), strict=False))
                 for each in (facts.low, facts.high))  # fmt: skip

    def train(count: int) -> tuple[LearnedModel, tuple[str, ...]]:
        pieces = rows.training(count)
        predictor, warned = trained(kind, features, pieces, rows=count, seed=request.seed)
        return LearnedModel(
            kind=kind,
            target=request.target,
            features=features,
            physics=PHYSICS[request.target] if request.is_on_physics else "",
            low=low,
            high=high,
            rows=count,
            predictor=predictor,
            baseline=Baseline(mean=facts.mean, law=law),
            residuals=(),
            manifest=rows.manifest,
        ), warned

    return train


def _prediction(model: LearnedModel, rows: LearningTable) -> Floats:
    """Predictions of rows; of those on the physics, times the physics."""
    found = np.asarray(model.predictor.predict(rows.values), dtype=np.float64)
    return found * rows.physics if model.physics and rows.physics is not None else found


def _baselines(
    model: LearnedModel, test: LearningTable, factor: ForceFactor | None
) -> dict[str, Floats]:
    """Predictions of the test rows by what is simpler."""
    found = {MEAN: np.full(len(test), model.baseline.mean)}
    if model.kind is not ModelKind.POWER_LAW or model.physics:
        name = "power-law alone" if model.physics else ModelKind.POWER_LAW.value
        found[name] = model.baseline.law.predict(test.values)
    if test.physics is not None:
        found[PHYSICS_ALONE] = test.physics
        if factor is not None and test.cutting is not None:
            found[FITTED] = factor.predict(test.physics, test.cutting)
    return found


def _curve(
    model_of: Trainer, test: LearningTable, request: LearnRequest
) -> Iterator[CurvePoint]:
    """Scores after more and more training rows, each twice as many as before."""
    sizes = [request.train]
    while sizes[0] // 2 >= FEWEST_OF_CURVE:
        sizes.insert(0, sizes[0] // 2)
    for size in sizes:
        predicted = _prediction(model_of(size)[0], test)
        scores = scores_of(test.target, predicted, seed=request.seed)
        yield CurvePoint(rows=size, scores=scores)
