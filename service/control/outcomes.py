"""Conversion of a controlled run into outcomes for the knowledge base, one per workingstep."""

from dataclasses import dataclass
from datetime import datetime
from math import isfinite, pi

import numpy as np

from controller.record import RunRecord
from controller.signals.estimate import force_ratio
from optimiser.advice import Advice, EvaluatedSetting
from optimiser.bounds.roughness import roughness_forecast, roughness_load
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.region import region_of
from service.control.expected_results import PlannedWorkingstep
from service.control.run import ControlRun
from service.programs.advice_records import immersion
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.errors import SchemaError
from stepnc_model.outcome import Context, EvaluatedQuantity, FeatureFacts, ProcessOutcome
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep

INSPECTION = 0.05
"""Standard deviation of an inspected roughness, as a share; typical of a stylus instrument."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingContext:
    """Author, time and id under which outcomes are recorded."""

    run: str
    at: datetime
    """Time of recording, with zone."""
    by: str
    trace: str = ""
    seed: int = 0
    """Seed of the simulated inspection of surfaces."""


def outcomes_of(run: ControlRun, recording: RecordingContext) -> tuple[ProcessOutcome, ...]:
    """Return the outcomes of all workingsteps in which material was cut.

    A virtual machine leaves no surface to measure: its roughness follows from the actual feed
    by the model, with the error of an inspection. Of a recorded run nothing is known of it.
    """
    random = np.random.default_rng(recording.seed)
    errors = 1.0 + INSPECTION * random.standard_normal(len(run.steps))
    return tuple(
        _outcome(run, step, recording, float(error))
        for (advice, record), error in zip(run.steps, errors, strict=True)
        if (step := _cut_step(run, advice, record)) is not None
    )


@dataclass(frozen=True, slots=True)
class _CutStep:
    """Workingstep that was cut, with its advice, cut, setting and record."""

    advice: Advice
    cut: Cut
    state: EvaluatedSetting
    record: RunRecord
    planned: PlannedWorkingstep


def _cut_step(run: ControlRun, advice: Advice | None, record: RunRecord) -> _CutStep | None:
    """Collect the data of a workingstep; None if nothing was cut or no plan is known."""
    if advice is None or advice.cut is None or advice.before is None or not record.revolutions:
        return None
    planned = run.planned[record.workingstep]
    return _CutStep(advice, advice.cut, advice.before, record, planned)


def _outcome(
    run: ControlRun, step: _CutStep, recording: RecordingContext, error: float
) -> ProcessOutcome:
    """Build the outcome of a workingstep; the error is a factor on the inspected roughness."""
    cut, setting, record = step.cut, step.state.setting, step.record
    material, tool = run.material.material, step.advice.tool.id
    per_tooth = record.feed / (cut.tool.teeth * setting.speed)
    roughness = None if run.recorded else _roughness(step, per_tooth)
    return ProcessOutcome(
        context=Context(machine=run.machine.name, material=material.name, tool=tool),
        program=run.program.name,
        workingstep=step.advice.workingstep.id,
        feature=_feature(run.program, step.advice.workingstep, cut),
        is_finishing=cut.is_finish_operation,
        mode=run.criterion.value,
        specific_force=material.kienzle.k_c11,
        cutting_speed=pi * cut.diameter * setting.speed,
        step_depth=EvaluatedQuantity(predicted=setting.depth),
        feed_per_tooth=EvaluatedQuantity(predicted=setting.feed, measured=per_tooth),
        immersion=_immersion(cut),
        strategy=_strategy(run.program, step.advice.workingstep),
        roughness=EvaluatedQuantity(
            predicted=_roughness(step, setting.feed),
            measured=None if roughness is None else roughness * error,
        ),
        time=EvaluatedQuantity(predicted=step.planned.time, measured=record.time),
        force=EvaluatedQuantity(
            predicted=step.planned.force * step.advice.force_factor, measured=record.peak
        ),
        feed=EvaluatedQuantity(predicted=step.planned.feed, measured=record.feed),
        force_bound=record.set_point if isfinite(record.set_point) else None,
        force_ratio=force_ratio(record.ratio),
        trace=recording.trace,
        run=recording.run,
        recorded_at=recording.at,
        recorded_by=recording.by,
    )


def _roughness(step: _CutStep, feed_per_tooth: float) -> float | None:
    """Expected Ra of a finished surface, mm; ideal where no study tells; None if unknown."""
    load, at = roughness_load(step.cut), step.advice.conditions
    if load is None or at is None or not step.cut.is_finishing:
        return None
    speed = step.state.setting.speed
    found = roughness_forecast(step.cut, at, feed=feed_per_tooth, speed=speed)
    return load.value(feed_per_tooth, 1.0, 1.0) if found is None else found.median


def _immersion(cut: Cut) -> FaceMillingImmersion | None:
    if cut.kind is not CutKind.MILLING or cut.engagement is None:
        return None
    return FaceMillingImmersion(immersion(cut.engagement))


def _feature(program: Program, step: ResolvedWorkingstep, cut: Cut) -> FeatureFacts:
    """Id, kind and size of the feature; the length is that of a rectangle of equal area."""
    if not step.features:
        return FeatureFacts(id="", kind="", total_depth=cut.total_depth)
    ref = step.features[0]
    entity = program.get(ref)
    length = width = None
    try:
        region = region_of(program, ref)
    except SchemaError:
        # The feature is not a region: it is turned or has a free form.
        region = None
    if region is not None and region.area > 0.0:
        length, width = region.area / region.width, region.width
    return FeatureFacts(
        id=_id(entity, ref),
        kind=entity.express_name(),
        length=length,
        width=width,
        total_depth=cut.total_depth,
    )


def _id(entity: Entity, ref: Ref[Entity]) -> str:
    return str(getattr(entity, "its_id", "")) or str(ref)


def _strategy(program: Program, step: ResolvedWorkingstep) -> str:
    """EXPRESS name of the machining strategy; empty if the operation has none."""
    ref = getattr(step.operation, "its_machining_strategy", None)
    return "" if ref is None else program.get(ref).express_name()
