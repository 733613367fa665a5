"""Outcomes, corrections and reviews as JSON."""

import json
from datetime import datetime
from typing import Any

import pytest

from kbe.queries import EVERYTHING
from kbe.rows import OUTCOME
from service.knowledge import verbs as knowledge
from service.knowledge.review import review
from service.outputs.output_format import OutputFormat
from service.requests.knowledge import ReviewRequest
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.list.result import OutcomesResult
from service.verbs.kbe.review.result import ReviewReport
from service.verbs.kbe.show.result import RunResult
from service.verbs.result import Result
from stepnc_model.outcome import ProcessOutcome


def sent(result: Result) -> Any:
    """A result as another program gets it."""
    return json.loads(result.printed(OutputFormat.JSON))


def test_a_listing_reads_back_equal(kb: str, shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    found = knowledge.newest(kb, EVERYTHING, limit=3)
    told = sent(OutcomesResult(outcomes=found.outcomes, total=found.total))
    assert told["total"] == 1200
    for row in told["outcomes"]:
        row["recorded_at"] = datetime.fromisoformat(row["recorded_at"])
    read = [
        OUTCOME.noun([row[leaf.name] for leaf in OUTCOME.leaves]) for row in told["outcomes"]
    ]
    assert read == list(shop_outcomes[:-4:-1])


def test_a_run_has_its_deviations(shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    told = sent(RunResult(outcomes=shop_outcomes[:6]))
    assert told["run"] == "000000"
    first = told["outcomes"][0]
    assert first["deviations"]["force"] == pytest.approx(
        first["force_measured_n"] / first["force_predicted_n"] - 1.0, rel=1e-12
    )
    assert first["deviations"]["roughness"] is None


def test_a_review_and_its_corrections_agree(kb: str) -> None:
    request = ReviewRequest(tool="DRILL 8.5")
    told = sent(ReviewReport(contexts=review(kb, request)))["contexts"]
    stored = sent(CorrectionsResult(entries=knowledge.corrections(kb)))["corrections"]
    assert [each["correction"] for each in told] == stored
    assert {each["change"] for each in told} == {"proposed"}
    assert {each["in_force"] for each in told} == {None}
    assert {each["tool"] for each in told} == {"DRILL 8.5"}
    knowledge.accept(kb, [stored[0]["id"]], by="B. Jones")
    again = sent(ReviewReport(contexts=review(kb, request)))["contexts"]
    assert again[0]["in_force"]["accepted_by"] == "B. Jones"
    assert again[0]["in_force"]["factor"] == stored[0]["factor"]
