"""The evaluation table as a user asks for it."""

from pathlib import Path

import pytest

from kbe.evaluation import Grouping, RowFilter, SortKey
from kbe.queries import Selection
from kbe.remarks import EvaluationGrade
from kbe.statistics import Evaluated
from service.knowledge import evaluation_table as evaluated
from service.knowledge import verbs as knowledge
from service.knowledge.evaluation_table import summary, table
from service.knowledge.review import review
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from stepnc_model.outcome import ProcessOutcome


def test_the_table_has_a_row_for_each_feature_of_the_shop(
    shop_file: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    found = table(str(shop_file), EvaluationRequest())
    features = {
        (each.context.machine, each.feature.id, each.context.material) for each in shop_outcomes
    }
    assert {(row.key.machine, row.key.feature, row.key.material) for row in found.rows} == (
        features
    )
    assert found.outcomes == 1200
    assert sum(side.outcomes for row in found.rows for side in row.sides) == 1200
    assert all(side.factor is not None for row in found.rows for side in row.sides)


def test_filters_and_order_are_those_of_the_request(shop_file: Path) -> None:
    everything = table(str(shop_file), EvaluationRequest())
    violated = table(
        str(shop_file), EvaluationRequest(only=RowFilter.VIOLATED, sort=SortKey.FORCE)
    )
    assert 0 < len(violated.rows) < len(everything.rows)
    assert violated.left_out == len(everything.rows) - len(violated.rows)
    assert all(
        any(side.grade is EvaluationGrade.VIOLATED for side in row.sides)
        for row in violated.rows
    )
    kinds = table(
        str(shop_file),
        EvaluationRequest(machine="hmc8", grouping=Grouping.KIND),
    )
    assert {row.key.machine for row in kinds.rows} == {"hmc8"}
    assert {row.key.feature for row in kinds.rows} == {row.kind for row in kinds.rows}


def test_a_factor_is_learned_from_all_of_its_context(shop_file: Path) -> None:
    whole = table(str(shop_file), EvaluationRequest())
    part = table(str(shop_file), EvaluationRequest(feature_kind="slot"))
    factors = {
        side.context: side.factor.centre
        for row in whole.rows
        for side in row.sides
        if side.factor is not None
    }
    for row in part.rows:
        for side in row.sides:
            assert side.factor is not None
            # Time goes on between the two.
            assert side.factor.centre == pytest.approx(factors[side.context], rel=1e-6)


def test_what_was_accepted_is_no_longer_pending(kb: str) -> None:
    slots = EvaluationRequest(feature_kind="slot")
    before = table(kb, slots)
    assert any(side.is_pending for row in before.rows for side in row.sides)
    found = review(kb, ReviewRequest())
    ids = [each.entry.id for each in found if each.entry is not None]
    knowledge.accept(kb, ids, by="A. Smith")
    after = table(kb, slots)
    assert not any(side.is_pending for row in after.rows for side in row.sides)


def test_the_summary_counts_what_the_table_counts(shop_file: Path) -> None:
    selection = Selection(machine="vmc22")
    groups = summary(str(shop_file), selection).groups
    rows = table(str(shop_file), EvaluationRequest(machine="vmc22")).rows
    assert sum(group.outcomes for group in groups) == sum(
        side.outcomes for row in rows for side in row.sides
    )
    drills = [group for group in groups if group.context.tool == "DRILL 8.5"]
    for group in drills:
        [side] = [
            side
            for row in rows
            for side in row.sides
            if side.context == group.context
        ]  # fmt: skip
        assert group.outcomes == side.outcomes
        assert group.force.mean == pytest.approx(
            side.deviations[Evaluated.FORCE].mean, rel=1e-9
        )


def test_much_is_not_read_without_a_word(
    shop_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    table(str(shop_file), EvaluationRequest(), tell=told.append)
    assert told == []
    monkeypatch.setattr(evaluated, "MANY", 1000)
    table(str(shop_file), EvaluationRequest(), tell=told.append)
    assert told == ["reading 1200 outcomes; use --summary for a fast overview"]
