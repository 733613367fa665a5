"""Outcomes: predicted and measured results of one workingstep of one run.

These are the data classes of process control and knowledge base. The attributes are the columns
of [1]_, Table 1, and the four quantities that it evaluates: surface quality, machining time,
actual cutting force and actual feed. Units mm, s, N; speeds mm/s; roughness Ra in mm; k_c in
N/mm². ``None`` means not known or not measured.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Table 1 and "Knowledge-based evaluation".
"""

from dataclasses import dataclass
from datetime import datetime

from stepnc_model.entities.optimisation import FaceMillingImmersion


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """Machine, material and tool that a correction applies to."""

    machine: str
    material: str
    tool: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatedQuantity:
    """Evaluated quantity with its predicted and measured values."""

    predicted: float | None = None
    measured: float | None = None

    @property
    def deviation(self) -> float | None:
        """Measured / predicted − 1; None if either is missing or predicted is 0."""
        if self.predicted is None or self.measured is None or self.predicted == 0.0:
            return None
        return self.measured / self.predicted - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceRatio:
    """Ratio of measured to expected cutting force at the actual feed.

    The expected force uses the catalogue's k_c, whatever correction the plan used, so that
    outcomes of all plans estimate the same factor.
    """

    log_mean: float
    """Mean of ln(measured / expected)."""
    log_deviation: float
    """Standard deviation of a single reading of ln(measured / expected)."""
    readings: int
    """Number of revolutions that were counted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureFacts:
    """Geometrical data of a feature, [1]_, Table 1."""

    id: str
    kind: str
    """EXPRESS name of the feature, such as ``closed_pocket``."""
    length: float | None = None
    """Length L of the feature, mm."""
    width: float | None = None
    """Width X of the feature, mm."""
    total_depth: float | None = None
    """Total depth a_t of the feature, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessOutcome:
    """Predicted and measured results of one workingstep of one run."""

    context: Context
    program: str
    workingstep: str
    feature: FeatureFacts
    is_finishing: bool
    mode: str
    """Goal of the feed optimisation: TC, QC or EC."""
    specific_force: float | None
    """Specific cutting force k_c1.1 of the catalogue, N/mm²."""
    cutting_speed: float | None
    """Cutting speed V_c, mm/s."""
    step_depth: EvaluatedQuantity
    """Depth of one pass a_s, mm."""
    feed_per_tooth: EvaluatedQuantity
    """Feed per tooth f_z, mm."""
    immersion: FaceMillingImmersion | None
    """Type of face milling, d_s1 to d_s3; None if not milled."""
    strategy: str
    """EXPRESS name of the machining strategy; empty if there is none."""
    roughness: EvaluatedQuantity
    time: EvaluatedQuantity
    force: EvaluatedQuantity
    """Greatest mean cutting force over a revolution, N."""
    feed: EvaluatedQuantity
    """Mean feed while cutting, mm/s."""
    force_bound: float | None
    """Upper bound on the cutting force of this workingstep, N."""
    force_ratio: ForceRatio | None
    trace: str
    """Location of the recorded samples; empty if not kept."""
    run: str
    """Identifier of the run, shared by all its workingsteps."""
    recorded_at: datetime
    """Time of recording, with time zone."""
    recorded_by: str
    sequence: int = 0
    """Number of earlier outcomes of this workingstep in the run: 0 unless it is run again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedCorrection:
    """Correction learned from outcomes: a factor on k_c.

    ``ln factor`` follows Student's t with the given centre, scale and degrees of freedom: the
    distribution expected for the next run, not only for the mean.
    """

    context: Context
    log_centre: float
    log_scale: float
    degrees: float
    """Degrees of freedom, positive."""
    outcomes: int
    """Number of outcomes that the correction was learned from."""
    confidence: float
    """Probability that the factor lies within ±10 % of its centre."""
    proposed_at: datetime
    accepted_by: str = ""
    """Person who accepted the correction; empty for a proposal."""
    accepted_at: datetime | None = None
