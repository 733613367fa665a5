"""Outcomes of runs of the sample parts on a machine whose k_c is 1.2 times the catalogue's."""

import re
from datetime import UTC, datetime
from math import exp, pi
from pathlib import Path

import pytest

from service.control.outcomes import RecordingContext, outcomes_of
from service.control.run import ControlRun, control
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import Context, FeatureFacts, ProcessOutcome
from tests.asking import asked_control

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"
RECORDING = RecordingContext(
    run="r1", at=datetime(2026, 3, 2, tzinfo=UTC), by="test", trace="t.csv"
)


@pytest.fixture(scope="module")
def run() -> ControlRun:
    asked = asked_control(
        PART, machine="vmc15", material="c45", law="none", disturbances=("kc:1.2",), seed=3
    )
    return control(*asked)


@pytest.fixture(scope="module")
def outcome(run: ControlRun) -> ProcessOutcome:
    (found,) = outcomes_of(run, RECORDING)
    return found


def test_an_outcome_names_its_context_and_its_run(outcome: ProcessOutcome) -> None:
    assert outcome.context == Context(machine="vmc15", material="c45", tool="MILL 18MM")
    assert (outcome.program, outcome.workingstep) == (PART.name, "ROUGH THE FACE")
    assert (outcome.run, outcome.recorded_by, outcome.trace) == ("r1", "test", "t.csv")
    assert outcome.recorded_at == RECORDING.at
    assert outcome.mode == "TC"


def test_the_columns_of_the_papers_table_are_those_of_its_example(
    outcome: ProcessOutcome,
) -> None:
    # Paper 002, Table 2: 3 mm deep, a workpiece of 300 mm, an 18 mm mill.
    assert outcome.feature == FeatureFacts(
        id=outcome.feature.id, kind="planar_face", length=300.0, width=18.0, total_depth=3.0
    )
    assert outcome.immersion is FaceMillingImmersion.FULL_IMMERSION
    assert outcome.step_depth.predicted == 3.0
    assert not outcome.is_finishing
    assert outcome.strategy == "bidirectional_milling"
    # 35 m/min, the cutting speed of HSS there.
    assert outcome.cutting_speed == pytest.approx(35_000.0 / 60.0, rel=1e-3)
    assert outcome.cutting_speed == pytest.approx(pi * 18.0 * 618.94 / 60.0, rel=1e-4)


def test_the_force_ratio_tells_the_hidden_factor(outcome: ProcessOutcome) -> None:
    ratio = outcome.force_ratio
    assert ratio is not None
    assert exp(ratio.log_mean) == pytest.approx(1.2, rel=0.01)
    assert ratio.readings > 100
    assert outcome.force.deviation == pytest.approx(0.2, abs=0.03)


def test_without_control_time_and_feed_are_as_planned(outcome: ProcessOutcome) -> None:
    assert outcome.time.deviation == pytest.approx(0.0, abs=1e-6)
    assert outcome.feed.deviation == pytest.approx(0.0, abs=1e-6)
    assert outcome.feed_per_tooth.deviation == pytest.approx(0.0, abs=1e-6)


def test_the_same_seed_inspects_the_same_surface(run: ControlRun) -> None:
    assert outcomes_of(run, RECORDING) == outcomes_of(run, RECORDING)


FEED = re.compile(r"(?<=MILLING_TECHNOLOGY\()(\$,\.TCP\.,[\d.]+,\$,)?(0\.\d+)")


@pytest.fixture(scope="module")
def hurried(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bracket at six times its feeds: the same workingsteps in less time."""
    text = PART.with_name("bracket.stpnc").read_text(encoding="ascii")
    text, count = FEED.subn(lambda it: f"{it[1] or ''}{6.0 * float(it[2]):.6g}", text)
    assert count == 10
    path = tmp_path_factory.mktemp("bracket") / "bracket.stpnc"
    path.write_text(text, encoding="ascii")
    return path


def test_holes_and_finishes_of_the_bracket_are_told_apart(hurried: Path) -> None:
    asked = asked_control(hurried, machine="vmc15", material="c45", law="none")
    found = outcomes_of(control(*asked), RECORDING)
    by_step = {outcome.workingstep: outcome for outcome in found}
    assert len(found) == 16
    assert {name for name, each in by_step.items() if each.is_finishing} == {
        "FINISH FACE",
        "FINISH CONTOUR",
        "FINISH POCKET",
        "FINISH OPEN POCKET",
    }
    assert by_step["FINISH FACE"].roughness.predicted is None  # its parallel land makes it
    finish = by_step["FINISH CONTOUR"].roughness
    assert finish.predicted is not None
    assert finish.measured == pytest.approx(finish.predicted, rel=0.25)
    drilled = by_step["DRILL HOLE 1"]
    assert drilled.feature.kind == "round_hole"
    assert drilled.immersion is None
    assert drilled.roughness.measured is None
