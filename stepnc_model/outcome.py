"""Outcomes: one workingstep of one run, as predicted and as measured.

The nouns of process control and knowledge base. The attributes are the columns of [1]_,
Table 1, and the four quantities that it evaluates: surface quality, machining time, actual
cutting force and actual feed. Units mm, s, N; speeds mm/s; roughness Ra in mm; k_c in N/mm².
``None`` means: not known, or not measured.

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
    """Context that a correction applies to."""

    machine: str
    material: str
    tool: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatedQuantity:
    """One evaluated quantity, as planned and as it was."""

    predicted: float | None = None
    measured: float | None = None

    @property
    def deviation(self) -> float | None:
        """Measured over predicted, less one; None when either is missing or predicted is 0."""
        if self.predicted is None or self.measured is None or self.predicted == 0.0:
            return None
        return self.measured / self.predicted - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceRatio:
    """Measured over expected cutting force at the feed that was really run.

    Expected with the catalogue's k_c, whatever correction the plan used, so that outcomes of
    all plans tell of the same factor.
    """

    log_mean: float
    """mean of ln(measured / expected)"""
    log_deviation: float
    """standard deviation of one reading"""
    readings: int
    """revolutions that were counted"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureFacts:
    """The geometrical columns of [1]_, Table 1."""

    id: str
    kind: str
    """EXPRESS name, ``closed_pocket``"""
    length: float | None = None
    """L, mm"""
    width: float | None = None
    """X, mm"""
    total_depth: float | None = None
    """a_t, mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessOutcome:
    """One workingstep of one run."""

    context: Context
    program: str
    workingstep: str
    feature: FeatureFacts
    is_finishing: bool
    mode: str
    """TC, QC or EC: what the feed was chosen for"""
    specific_force: float | None
    """k_c1.1 of the catalogue, N/mm²"""
    cutting_speed: float | None
    """V_c, mm/s"""
    step_depth: EvaluatedQuantity
    """a_s, mm"""
    feed_per_tooth: EvaluatedQuantity
    """f_z, mm"""
    immersion: FaceMillingImmersion | None
    """type of face milling, d_s1 to d_s3; None: no milling"""
    strategy: str
    """EXPRESS name of the machining strategy; empty when there is none"""
    roughness: EvaluatedQuantity
    time: EvaluatedQuantity
    force: EvaluatedQuantity
    """greatest mean of a revolution, N"""
    feed: EvaluatedQuantity
    """mean while it cut, mm/s"""
    force_bound: float | None
    """Force bound, N that this workingstep was to keep"""
    force_ratio: ForceRatio | None
    trace: str
    """where the samples are kept; empty: nowhere"""
    run: str
    """which run; one id for all its workingsteps"""
    recorded_at: datetime
    """with zone"""
    recorded_by: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedCorrection:
    """Correction learned from outcomes: a factor on k_c.

    ``ln factor`` follows Student's t with the given centre, scale and degrees of freedom: what
    the next run is expected to show, not only where the mean lies.
    """

    context: Context
    log_centre: float
    log_scale: float
    degrees: float
    """of freedom, positive"""
    outcomes: int
    """that it was learned from"""
    confidence: float
    """probability that the factor lies within ±10 % of its centre"""
    proposed_at: datetime
    accepted_by: str = ""
    """empty: a proposal only"""
    accepted_at: datetime | None = None
