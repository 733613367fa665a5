"""Outcomes, corrections and reviews as JSON."""

import json
from datetime import datetime

import pytest

from kbe.backup import Content
from kbe.rows import OUTCOME
from kbe.selection import EVERYTHING
from service.knowledge import verbs as knowledge
from service.knowledge.output import (
    content_json,
    corrections_json,
    listing_json,
    run_json,
)
from service.knowledge.review import review
from service.knowledge.review_output import review_json
from service.requests.knowledge import ReviewRequest
from stepnc_model.outcome import ProcessOutcome


def test_a_listing_reads_back_equal(kb: str, shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    told = json.loads(listing_json(knowledge.newest(kb, EVERYTHING, limit=3)))
    assert told["total"] == 1200
    for row in told["outcomes"]:
        row["recorded_at"] = datetime.fromisoformat(row["recorded_at"])
    found = [
        OUTCOME.noun([row[leaf.name] for leaf in OUTCOME.leaves]) for row in told["outcomes"]
    ]
    assert found == list(shop_outcomes[:-4:-1])


def test_a_run_has_its_deviations(shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    told = json.loads(run_json(shop_outcomes[:6]))
    assert told["run"] == "000000"
    first = told["outcomes"][0]
    assert first["deviations"]["force"] == pytest.approx(
        first["force_measured_n"] / first["force_predicted_n"] - 1.0, rel=1e-12
    )
    assert first["deviations"]["roughness"] is None


def test_a_review_and_its_corrections_agree(kb: str) -> None:
    request = ReviewRequest(tool="DRILL 8.5")
    told = json.loads(review_json(review(kb, request)))["contexts"]
    stored = json.loads(corrections_json(knowledge.corrections(kb)))["corrections"]
    assert [each["correction"] for each in told] == stored
    assert {each["change"] for each in told} == {"proposed"}
    assert {each["in_force"] for each in told} == {None}
    assert {each["tool"] for each in told} == {"DRILL 8.5"}
    knowledge.accept(kb, [stored[0]["id"]], by="B. Jones")
    again = json.loads(review_json(review(kb, request)))["contexts"]
    assert again[0]["in_force"]["accepted_by"] == "B. Jones"
    assert again[0]["in_force"]["factor"] == stored[0]["factor"]


def test_content_is_counted() -> None:
    content = Content(outcomes=5, corrections=2, decisions=1, fingerprint="f")
    assert json.loads(content_json(content, place="kb.db")) == {
        "place": "kb.db",
        "outcomes": 5,
        "corrections": 2,
        "decisions": 1,
        "fingerprint": "f",
    }
