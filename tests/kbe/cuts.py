"""Outcomes to learn from and to evaluate, with what does not matter filled in."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    LearnedCorrection,
    ProcessOutcome,
)

START = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
CONTEXT = Context(machine="vmc15", material="C45", tool="MILL 18")
UNKNOWN = EvaluatedQuantity()

SLOT = ProcessOutcome(
    context=CONTEXT,
    program="bracket.stpnc",
    workingstep="WS SLOT 2",
    feature=FeatureFacts(id="Slot_2", kind="slot", length=150.0, width=100.0, total_depth=20.0),
    is_finishing=False,
    mode="TC",
    specific_force=1000.0,
    cutting_speed=583.0,
    step_depth=EvaluatedQuantity(predicted=3.0, measured=3.0),
    feed_per_tooth=EvaluatedQuantity(predicted=0.4, measured=0.33),
    immersion=FaceMillingImmersion.FULL_IMMERSION,
    strategy="unidirectional",
    roughness=UNKNOWN,
    time=UNKNOWN,
    force=UNKNOWN,
    feed=UNKNOWN,
    force_bound=None,
    force_ratio=None,
    trace="",
    run="1",
    recorded_at=START,
    recorded_by="test",
)
"""the first row of the paper's Table 1, with nothing measured yet"""


def after(days: float) -> datetime:
    """So long after the first outcome."""
    return START + timedelta(days=days)


def in_run(number: int, cut: ProcessOutcome = SLOT) -> ProcessOutcome:
    """The same cut in the run of a day."""
    return replace(cut, run=f"run {number}", recorded_at=after(number))


def with_ratio(
    cut: ProcessOutcome, log_mean: float, *, deviation: float = 0.0, readings: int = 400
) -> ProcessOutcome:
    """The same cut with a measured force ratio."""
    ratio = ForceRatio(log_mean=log_mean, log_deviation=deviation, readings=readings)
    return replace(cut, force_ratio=ratio)


def deviating(share: float) -> EvaluatedQuantity:
    """A quantity that was off its plan by a share."""
    return EvaluatedQuantity(predicted=100.0, measured=100.0 * (1.0 + share))


def correction(
    log_centre: float,
    *,
    log_scale: float = 0.05,
    degrees: float = 8.0,
    outcomes: int = 12,
    confidence: float = 0.9,
) -> LearnedCorrection:
    """A correction of the context of all these outcomes."""
    return LearnedCorrection(
        context=CONTEXT,
        log_centre=log_centre,
        log_scale=log_scale,
        degrees=degrees,
        outcomes=outcomes,
        confidence=confidence,
        proposed_at=START,
    )
