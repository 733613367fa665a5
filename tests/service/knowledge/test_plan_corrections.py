"""What ``optimise`` takes from the knowledge base, and what it writes of it."""

import os
from dataclasses import replace
from datetime import UTC, datetime
from math import exp, log
from pathlib import Path

import pytest

from kbe.store import open_store
from optimiser.planning.formulate import OptimisationTask
from service.programs.reading import read_program
from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing.outcome_record import read_outcomes
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import Context, LearnedCorrection
from tests.asking import AskedAdvice, asked_advice
from tests.every_case import every_case

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"
NOW = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
LEARNED = LearnedCorrection(
    context=Context(machine="vmc15", material="c45", tool="MILL 18MM"),
    log_centre=log(1.3),
    log_scale=0.05,
    degrees=6.0,
    outcomes=3,
    confidence=0.9,
    proposed_at=NOW,
)


@pytest.fixture
def place(tmp_path: Path) -> str:
    """A knowledge base with one accepted correction."""
    place = str(tmp_path / "knowledge.db")
    with open_store(place) as store:
        store.accept(store.propose(LEARNED), by="Ada", at=NOW)
        other = replace(LEARNED, context=replace(LEARNED.context, machine="other"))
        store.accept(store.propose(other), by="Ada", at=NOW)
    return place


def request(folder: Path, **more: str | float) -> AskedAdvice:
    output = folder / "out.stpnc"
    words = {"machine": "vmc15", "material": "c45", "output": output, **more}
    return asked_advice(PART, **words)  # type: ignore[arg-type]


def test_a_plan_takes_the_quantile_of_the_accepted_factor_and_says_so(
    place: str, tmp_path: Path
) -> None:
    plan = optimise(*request(tmp_path, knowledge=place)).plan
    # Student's t with 6 degrees of freedom: 1.440 at 0.9 (any table).
    assert plan.advices[0].force_factor == pytest.approx(1.3)
    assert plan.advices[0].safety_factor == pytest.approx(exp(0.05 * 1.440), 1e-3)
    said = [finding.message for finding in plan.findings if "learned" in finding.message]
    assert said == [
        "tool 'MILL 18MM': learned k_c × 1.300 from 3 outcomes, accepted by Ada on 2026-03-02; "
        "bounds are kept at its 90 % quantile, × 1.397"
    ]


def test_the_median_is_the_centre(place: str, tmp_path: Path) -> None:
    plan = optimise(*request(tmp_path, knowledge=place, safety=0.5)).plan
    assert plan.advices[0].force_factor == pytest.approx(1.3)


def test_the_force_is_kept_with_the_learned_factor(place: str, tmp_path: Path) -> None:
    learned = optimise(*request(tmp_path, knowledge=place, safety=0.5)).plan.advices[0]
    catalogue = optimise(*request(tmp_path, safety=0.5)).plan.advices[0]
    assert learned.after is not None
    assert catalogue.after is not None
    assert learned.after.time > catalogue.after.time


def test_what_was_taken_is_written_to_the_file(place: str, tmp_path: Path) -> None:
    done = optimise(*request(tmp_path, knowledge=place))
    assert done.written is not None
    (recorded,) = read_outcomes(read_program(done.written, units="iso")).corrections
    assert recorded.context == LEARNED.context
    assert recorded.factor == pytest.approx(1.3)
    assert recorded.accepted_by == "Ada"


def test_without_a_knowledge_base_nothing_is_corrected(tmp_path: Path) -> None:
    plan = optimise(*request(tmp_path)).plan
    assert plan.advices[0].force_factor == OptimisationTask().force_factor("MILL 18MM") == 1.0


def test_the_environment_may_name_it(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(os.environ, "STEPNC_KB", place)
    assert optimise(*request(tmp_path, safety=0.5)).plan.advices[0].force_factor > 1.29


def test_another_machine_learns_nothing_from_this_one(place: str, tmp_path: Path) -> None:
    plan = optimise(*request(tmp_path, knowledge=place, machine="paper002")).plan
    assert plan.advices[0].force_factor == 1.0


def test_a_knowledge_base_that_is_not_there_is_refused(tmp_path: Path) -> None:
    missing = str(tmp_path / "none.db")
    with pytest.raises(StepNcError, match="no such file"):
        optimise(*request(tmp_path, knowledge=missing))
    assert not (tmp_path / "out.stpnc").exists()
    assert not Path(missing).exists()


@every_case("safety", [0.49, 0.9995, float("nan")])
def test_an_impossible_quantile_is_refused(tmp_path: Path, safety: float) -> None:
    with pytest.raises(StepNcError, match=r"safety .*: it must be 0\.5 to 0\.999"):
        optimise(*request(tmp_path, safety=safety))
    assert not (tmp_path / "out.stpnc").exists()
