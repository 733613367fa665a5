"""A shop's year, made up: three machines, two materials, four features, one run after another.

The truth behind it: each machine and material has a factor on k_c; edges wear from run to run
and are changed; the plan does not know; the controller holds the force at its bound by the
feed. Seeded: the same number of runs gives the same outcomes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import islice
from math import exp, log
from random import Random

from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    ProcessOutcome,
)

BEGIN = datetime(2026, 1, 5, 6, 0, tzinfo=UTC)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """One operation at one feature, as planned."""

    feature: FeatureFacts
    tool: str
    is_finishing: bool
    immersion: FaceMillingImmersion | None
    strategy: str
    depth: float
    feed_per_tooth: float
    teeth: int
    diameter: float
    time: float
    force: float
    bound: float | None


POCKET = FeatureFacts(
    id="Pocket_1", kind="closed_pocket", length=120.0, width=150.0, total_depth=25.0
)
SLOT = FeatureFacts(id="Slot_2", kind="slot", length=150.0, width=100.0, total_depth=20.0)
FACE = FeatureFacts(id="Face_3", kind="planar_face", length=160.0, width=110.0, total_depth=4.0)
HOLE = FeatureFacts(id="Hole_4", kind="round_hole", total_depth=30.0)

FULL = FaceMillingImmersion.FULL_IMMERSION
ONE_SIDE = FaceMillingImmersion.UNIDIRECTIONAL_PART_IMMERSION

CUTS = (
    Cut(
        feature=FACE, tool="FACE MILL 50", is_finishing=False, immersion=ONE_SIDE,
        strategy="bidirectional", depth=2.0, feed_per_tooth=0.15, teeth=5, diameter=50.0,
        time=64.0, force=1400.0, bound=1600.0,
    ),
    Cut(
        feature=POCKET, tool="ENDMILL 18", is_finishing=False, immersion=FULL,
        strategy="contour_parallel", depth=5.0, feed_per_tooth=0.12, teeth=4, diameter=18.0,
        time=210.0, force=950.0, bound=1000.0,
    ),
    Cut(
        feature=POCKET, tool="ENDMILL 10", is_finishing=True, immersion=ONE_SIDE,
        strategy="contour_parallel", depth=25.0, feed_per_tooth=0.05, teeth=4, diameter=10.0,
        time=75.0, force=180.0, bound=600.0,
    ),
    Cut(
        feature=SLOT, tool="ENDMILL 18", is_finishing=False, immersion=FULL,
        strategy="unidirectional", depth=3.0, feed_per_tooth=0.16, teeth=4, diameter=18.0,
        time=130.0, force=920.0, bound=1000.0,
    ),
    Cut(
        feature=SLOT, tool="ENDMILL 18", is_finishing=True, immersion=ONE_SIDE,
        strategy="unidirectional", depth=1.5, feed_per_tooth=0.06, teeth=4, diameter=18.0,
        time=40.0, force=240.0, bound=600.0,
    ),
    Cut(
        feature=HOLE, tool="DRILL 8.5", is_finishing=False, immersion=None, strategy="",
        depth=30.0, feed_per_tooth=0.09, teeth=2, diameter=8.5, time=12.0, force=600.0,
        bound=None,
    ),
)  # fmt: skip

MACHINES = ("vmc15", "vmc22", "hmc8")
MATERIALS = {"C45": (1700.0, 160.0), "AlMgSi1": (700.0, 420.0)}
"""k_c1.1 in N/mm², V_c in m/min"""

FACTORS = {
    ("vmc15", "C45"): 1.14, ("vmc15", "AlMgSi1"): 1.02, ("vmc22", "C45"): 0.97,
    ("vmc22", "AlMgSi1"): 0.68, ("hmc8", "C45"): 1.06, ("hmc8", "AlMgSi1"): 0.99,
}  # fmt: skip
"""true k_c over the catalogue's"""

EDGE_LIFE = 12
"""runs of one edge"""
WEAR = 0.012
"""rise of the force from run to run of one edge"""


DRILL = "DRILL 8.5"
DULL = 0.006
"""rise of the force from run to run of a drill that nobody changes"""


def shop(runs: int = 200, *, seed: int = 14649) -> Iterator[ProcessOutcome]:
    """Outcomes of so many runs, by time; six a run."""
    random = Random(seed)
    at = BEGIN
    done = dict.fromkeys(MACHINES, 0)
    for number in range(runs):
        machine = random.choice(MACHINES)
        material = random.choice(list(MATERIALS))
        done[machine] += 1
        dull = exp(DULL * min(done[machine], 60)) if machine == "vmc15" else 1.0
        wear = exp(WEAR * (done[machine] % EDGE_LIFE)) if machine == "hmc8" else 1.0
        factor = FACTORS[machine, material] * wear * exp(random.gauss(0.0, 0.03))
        for cut in CUTS:
            at += timedelta(seconds=round(cut.time) + 30)
            own = factor * (dull if cut.tool == DRILL else 1.0)
            yield _outcome(
                cut, (machine, material), own, run=f"{number:06d}", at=at, random=random
            )
        at += timedelta(minutes=random.randrange(20, 300))


def outcomes(count: int) -> Iterator[ProcessOutcome]:
    """So many, of as many runs as that takes."""
    return islice(shop(count // len(CUTS) + 1), count)


def _outcome(
    cut: Cut, of: tuple[str, str], factor: float, *, run: str, at: datetime, random: Random
) -> ProcessOutcome:
    machine, material = of
    k_c, speed = MATERIALS[material]
    tools_own = factor * exp(random.gauss(0.0, 0.02))
    held = min(1.0, (cut.bound or 1e9) / (cut.force * tools_own))
    # The controller never holds quite what it should on the old machine.
    slip = 1.09 if machine == "hmc8" and random.random() < 0.08 else 1.0
    slow = held ** (1.0 / 0.8)
    fine = cut.is_finishing
    return ProcessOutcome(
        context=Context(machine=machine, material=material, tool=cut.tool),
        program="bracket.stpnc",
        workingstep=f"WS {'FINISH' if fine else 'ROUGH'} {cut.feature.id}",
        feature=cut.feature,
        is_finishing=fine,
        mode="QC" if fine else "TC",
        specific_force=k_c,
        cutting_speed=speed * 1000.0 / 60.0,
        step_depth=EvaluatedQuantity(predicted=cut.depth, measured=cut.depth),
        feed_per_tooth=EvaluatedQuantity(
            predicted=cut.feed_per_tooth, measured=cut.feed_per_tooth * slow
        ),
        immersion=cut.immersion,
        strategy=cut.strategy,
        roughness=EvaluatedQuantity(
            predicted=0.0016 if fine else None,
            measured=0.0016 * exp(random.gauss(0.04, 0.08)) if fine else None,
        ),
        time=EvaluatedQuantity(
            predicted=cut.time, measured=cut.time * (0.85 / slow + 0.15) * 1.02
        ),
        force=EvaluatedQuantity(
            predicted=cut.force, measured=cut.force * tools_own * held * slip
        ),
        feed=EvaluatedQuantity(predicted=16.0, measured=16.0 * slow),
        force_bound=cut.bound,
        force_ratio=ForceRatio(
            log_mean=log(tools_own) + random.gauss(0.0, 0.005),
            log_deviation=0.06,
            readings=round(cut.time * 20.0),
        ),
        trace=f"traces/{run}.parquet",
        run=run,
        recorded_at=at,
        recorded_by="virtual machine",
    )
