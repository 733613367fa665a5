"""The review: what is learned, what is proposed again, what nobody needs to look at."""

from dataclasses import replace
from datetime import timedelta
from math import log
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.acceptance import AcceptanceBounds
from kbe.queries import Selection, Standing
from service.knowledge import verbs as knowledge
from service.knowledge.review import (
    Acceptance,
    Reviewed,
    ReviewResult,
    is_changed,
    narrowed_to,
    review,
)
from service.requests.knowledge import ReviewRequest
from stepnc_model.outcome import Context, ForceRatio, LearnedCorrection, ProcessOutcome
from tests.service.shop import BEGIN, FACTORS

TOOL = "ENDMILL 18"
MINE = ReviewRequest(machine="vmc15", material="C45", tool=TOOL)
ALL = ReviewRequest()
AUTOMATIC = Acceptance(by="A. Smith")

PROPOSAL = LearnedCorrection(
    context=Context(machine="m", material="m", tool="t"),
    log_centre=0.1,
    log_scale=0.03,
    degrees=7.5,
    outcomes=8,
    confidence=0.97,
    proposed_at=BEGIN,
)


def one(found: tuple[Reviewed, ...]) -> Reviewed:
    [only] = found
    return only


def test_the_truth_of_the_shop_lies_in_what_is_learned(kb: str) -> None:
    found = review(kb, ALL)
    assert len(found) == 3 * 2 * 4
    for each in found:
        context, learned = each.learned.context, each.learned.correction
        # Where edges wear, the factor is that of worn edges.
        if context.machine == "hmc8" or (
            context.machine == "vmc15" and context.tool == "DRILL 8.5"
        ):
            continue
        truth = log(FACTORS[context.machine, context.material])
        assert learned is not None
        assert learned.log_centre == pytest.approx(truth, abs=0.06)
        assert each.change is ReviewResult.PROPOSED
        assert each.accepted is None


def test_the_same_outcomes_propose_nothing_twice(kb: str) -> None:
    first = one(review(kb, MINE))
    again = one(review(kb, MINE))
    assert first.entry is not None
    assert again.entry is not None
    assert (first.change, again.change) == (ReviewResult.PROPOSED, ReviewResult.UNCHANGED)
    assert again.entry.id == first.entry.id
    assert len(knowledge.corrections(kb)) == 1


def test_more_outcomes_propose_anew(kb: str, shop_outcomes: tuple[ProcessOutcome, ...]) -> None:
    first = one(review(kb, MINE))
    last = [each for each in shop_outcomes if each.context == first.learned.context][-1]
    later = replace(last, run="later", recorded_at=last.recorded_at + timedelta(days=1))
    knowledge.record(kb, [later])
    assert one(review(kb, MINE)).change is ReviewResult.PROPOSED


@given(st.floats(-0.3, 0.3), st.integers(-3, 3))
def test_changed_is_half_a_per_cent_or_more_outcomes(step: float, more: int) -> None:
    other = replace(PROPOSAL, log_centre=0.1 + step, outcomes=8 + more)
    assert is_changed(other, PROPOSAL) == (abs(step) > log(1.005) or more > 0) or (
        # Down by half a per cent is not up by half a per cent.
        log(0.995) <= step <= -log(1.005)
    )


def test_what_keeps_the_bounds_is_accepted_by_nobody_and_says_so(kb: str) -> None:
    found = one(review(kb, MINE, AUTOMATIC))
    assert found.change is ReviewResult.ACCEPTED
    assert found.objections == ()
    [entry] = knowledge.corrections(kb)
    assert entry == found.entry
    assert entry.decided_by == "A. Smith (automatically)"
    assert one(review(kb, MINE, AUTOMATIC)).change is ReviewResult.UNCHANGED
    assert one(review(kb, MINE, AUTOMATIC)).accepted == entry.correction


def test_an_objection_leaves_it_to_a_person(kb: str) -> None:
    strict = replace(AUTOMATIC, bounds=AcceptanceBounds(fewest_outcomes=1000))
    found = one(review(kb, MINE, strict))
    assert found.change is ReviewResult.PROPOSED
    assert "fewer than 1000" in str(found.objections[0])


def test_what_a_person_refused_is_not_accepted_automatically(kb: str) -> None:
    found = one(review(kb, MINE))
    assert found.entry is not None
    knowledge.withdraw(kb, [found.entry.id], by="B. Jones")
    again = one(review(kb, MINE, AUTOMATIC))
    assert again.change is ReviewResult.UNCHANGED
    assert again.entry is not None
    assert again.entry.standing is Standing.WITHDRAWN


def test_outcomes_without_a_ratio_teach_nothing(
    tmp_path: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    place = str(tmp_path / "new.db")
    wild = ForceRatio(log_mean=9.0, log_deviation=0.1, readings=400)
    first = shop_outcomes[0]
    knowledge.record(
        place, [replace(first, force_ratio=None), replace(first, force_ratio=wild, sequence=1)]
    )
    found = one(review(place, ALL))
    assert found.change is ReviewResult.NOTHING_TO_LEARN
    assert found.entry is None
    assert sum(found.learned.report.left_out.values()) == 2
    assert knowledge.corrections(place) == ()


@given(
    st.sampled_from([None, "a", "b"]), st.sampled_from([None, "a"]), st.sampled_from(["a", "b"])
)
def test_a_selection_within_a_context(
    machine: str | None, tool: str | None, given_tool: str
) -> None:
    context = Context(machine="a", material="m", tool=given_tool)
    found = narrowed_to(context, Selection(machine=machine, tool=tool, program="p"))
    if machine == "b" or (tool, given_tool) == ("a", "b"):
        assert found is None
    else:
        assert found == Selection(machine="a", material="m", tool=given_tool, program="p")


def test_filters_limit_what_is_learned_from(
    kb: str, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    assert review(kb, replace(ALL, machine="lathe")) == ()
    assert review(kb, replace(ALL, run="none")) == ()
    found = review(kb, replace(ALL, run="000003"))
    tools = {each.context.tool for each in shop_outcomes if each.run == "000003"}
    assert {each.learned.context.tool for each in found} == tools
    assert {each.learned.report.runs for each in found} == {1}
