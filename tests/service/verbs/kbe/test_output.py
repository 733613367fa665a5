"""Outcomes and corrections on a terminal, in the user's units."""

from dataclasses import replace
from datetime import UTC, datetime

import pytest

from kbe.backup import Content
from kbe.queries import Standing, StoredCorrection
from service.verbs.kbe.content import ContentResult
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.list.result import OutcomesResult
from service.verbs.kbe.quantities import EVALUATED, comparison_text
from service.verbs.kbe.show.result import RunResult
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.cuts import SLOT, correction

CUT = replace(
    SLOT,
    roughness=EvaluatedQuantity(predicted=0.0016, measured=0.0020),
    feed=EvaluatedQuantity(predicted=10.0, measured=5.0),
    time=EvaluatedQuantity(predicted=50.0, measured=55.0),
)


def test_the_edge_speaks_micrometres_and_millimetres_a_minute() -> None:
    told_of = {heading: of(CUT) for heading, of in EVALUATED.items()}
    assert told_of["Ra µm"].measured == pytest.approx(2.0)
    assert told_of["feed mm/min"] == EvaluatedQuantity(predicted=600.0, measured=300.0)


def test_a_quantity_is_told_with_its_deviation() -> None:
    assert (
        comparison_text(EvaluatedQuantity(predicted=50.0, measured=55.0)) == "50 -> 55 (+10 %)"
    )
    assert comparison_text(EvaluatedQuantity(predicted=50.0)) == "50 -> –"
    assert comparison_text(EvaluatedQuantity()) == ""


def test_a_listing_has_a_line_for_each(shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    out = str(OutcomesResult(outcomes=(CUT, shop_outcomes[0]), total=7)).splitlines()
    assert "Slot_2" not in out[2]
    assert "600 -> 300 (-50 %)" in out[2]
    assert out[-1].startswith("2 of 7 outcomes")


def test_a_run_is_told_in_full() -> None:
    evil = replace(CUT, workingstep="a\nb\x1b[2J")
    out = str(RunResult(outcomes=[evil]))
    assert "a b�[2J" in out
    for name in ("Ra µm", "time s", "force N", "feed mm/min", "step depth mm"):
        assert name in out
    assert "L 150, X 100, a_t 20 mm" in out
    assert "cutting speed, m/min: 35" in out


def test_corrections_tell_who_decided() -> None:
    at = datetime(2026, 3, 5, 12, 0, tzinfo=UTC)
    entry = StoredCorrection(
        id=3,
        correction=correction(0.1),
        standing=Standing.WITHDRAWN,
        decided_by="B. Jones",
        decided_at=at,
    )
    out = str(CorrectionsResult(entries=[entry]))
    assert "withdrawn" in out
    assert "B. Jones" in out
    assert f"{at.astimezone():%Y-%m-%d %H:%M}" in out
    assert "1.11 (" in out


def test_the_correction_that_plans_take_is_told_from_those_before() -> None:
    entries = [
        StoredCorrection(
            id=number,
            correction=correction(0.1),
            standing=Standing.ACCEPTED,
            decided_by="Ada",
            decided_at=datetime(2026, 3, day, tzinfo=UTC),
        )
        for number, day in ((1, 7), (2, 5))
    ]
    first, second = str(CorrectionsResult(entries=entries)).splitlines()[-2:]
    assert "in force" in first
    assert "accepted" in second


def test_content_is_counted() -> None:
    content = Content(outcomes=5, corrections=2, decisions=1, fingerprint="f")
    found = ContentResult(place="kb.db", content=content)
    assert str(found).startswith("kb.db: 5 outcomes, 2 corrections, 1 decision\n")
    assert found.record() == {
        "place": "kb.db",
        "outcomes": 5,
        "corrections": 2,
        "decisions": 1,
        "fingerprint": "f",
    }
