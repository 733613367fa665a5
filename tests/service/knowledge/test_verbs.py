"""What a user does with the knowledge base."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from math import exp
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.stats import t as student

from kbe.errors import StoreNotEmpty, StoreUnavailable, UnknownCorrection
from kbe.queries import EVERYTHING, Selection, Standing
from kbe.store import open_store
from service.knowledge import verbs as knowledge
from service.knowledge.place import usual_place
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import Context, LearnedCorrection, ProcessOutcome

AT = datetime(2026, 3, 5, 12, 0, tzinfo=UTC)
CONTEXT = Context(machine="vmc15", material="C45", tool="ENDMILL 18")

PROPOSAL = LearnedCorrection(
    context=CONTEXT,
    log_centre=0.12,
    log_scale=0.03,
    degrees=7.5,
    outcomes=8,
    confidence=0.97,
    proposed_at=AT,
)


@pytest.fixture(autouse=True)
def _own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


def proposed(kb: str, correction: LearnedCorrection = PROPOSAL) -> int:
    with open_store(kb) as store:
        return store.propose(correction)


def test_a_plan_gets_the_quantile_of_what_was_accepted(kb: str) -> None:
    knowledge.accept(kb, [proposed(kb)], by="A. Smith")
    found = knowledge.accepted_factors(
        kb, machine="vmc15", material="C45", tools=["DRILL", CONTEXT.tool, CONTEXT.tool]
    )
    [factor] = found
    assert factor.tool == CONTEXT.tool
    assert factor.factor == pytest.approx(exp(0.12 + 0.03 * student.ppf(0.9, 7.5)), rel=1e-9)
    assert factor.centre == pytest.approx(exp(0.12), rel=1e-12)
    assert (factor.accepted_by, factor.outcomes) == ("A. Smith", 8)
    at_centre = knowledge.accepted_factors(
        kb, machine="vmc15", material="C45", tools=[CONTEXT.tool], quantile=0.5
    )
    assert at_centre[0].factor == factor.centre


def test_what_is_proposed_or_withdrawn_is_not_planned_with(kb: str) -> None:
    def factors() -> int:
        return len(
            knowledge.accepted_factors(
                kb, machine="vmc15", material="C45", tools=[CONTEXT.tool]
            )
        )

    number = proposed(kb)
    assert factors() == 0
    knowledge.accept(kb, [number], by="A. Smith")
    assert factors() == 1
    [entry] = knowledge.withdraw(kb, [number], by="B. Jones")
    assert (entry.standing, entry.decided_by) == (Standing.WITHDRAWN, "B. Jones")
    assert factors() == 0


def test_a_plan_without_its_knowledge_base_fails(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="check the name"):
        knowledge.accepted_factors(
            str(tmp_path / "none.db"), machine="m", material="m", tools=["t"]
        )


def test_recording_makes_the_usual_knowledge_base(
    shop_outcomes: tuple[ProcessOutcome, ...],
) -> None:
    place = usual_place("")
    assert knowledge.newest(place, EVERYTHING, limit=5).total == 0
    assert not Path(place).parent.exists()
    knowledge.record(place, shop_outcomes[:6])
    assert knowledge.newest(place, EVERYTHING, limit=5).total == 6


def test_recording_does_not_make_folders_that_may_be_mistakes(
    tmp_path: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    with pytest.raises(StoreUnavailable, match="folder does not exist"):
        knowledge.record(str(tmp_path / "none" / "kb.db"), shop_outcomes[:1])


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=25)
@given(
    limit=st.integers(0, 1300),
    machine=st.sampled_from([None, "vmc15", "hmc8", "lathe"]),
    begin=st.integers(0, 30) | st.none(),
    finish=st.integers(0, 30) | st.none(),
)
def test_the_newest_are_the_last_of_all_turned_round(
    shop_file: Path,
    shop_outcomes: tuple[ProcessOutcome, ...],
    limit: int,
    machine: str | None,
    begin: int | None,
    finish: int | None,
) -> None:
    first = shop_outcomes[0].recorded_at
    since = None if begin is None else first + timedelta(days=begin)
    until = None if finish is None else first + timedelta(days=finish)
    selection = Selection(machine=machine, since=since, until=until)
    meant = [
        each
        for each in shop_outcomes
        if machine in {None, each.context.machine}
        and (since is None or each.recorded_at >= since)
        and (until is None or each.recorded_at < until)
    ]
    found = knowledge.newest(str(shop_file), selection, limit=limit)
    assert found.total == len(meant)
    assert list(found.outcomes) == meant[::-1][:limit]


def test_a_run_is_told_in_the_order_of_time(
    shop_file: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    found = knowledge.outcomes_of_run(str(shop_file), "000007")
    assert found == tuple(each for each in shop_outcomes if each.run == "000007")
    assert knowledge.outcomes_of_run(str(shop_file), "7") == ()


def test_the_beginning_of_a_recent_run_will_do(
    kb: str, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    for run in ("abcd-1", "abcx-2"):
        knowledge.record(kb, [replace(shop_outcomes[-1], run=run)])
    [found] = knowledge.outcomes_of_run(kb, "abcd")
    assert found.run == "abcd-1"
    assert knowledge.outcomes_of_run(kb, "abc") == ()
    assert knowledge.outcomes_of_run(kb, "abce") == ()
    knowledge.record(kb, [replace(shop_outcomes[-1], run="abcd-3")])
    with pytest.raises(StepNcError, match=r"several runs begin with 'abcd': abcd-1, abcd-3"):
        knowledge.outcomes_of_run(kb, "abcd")


def test_one_unknown_correction_and_nothing_is_decided(kb: str) -> None:
    number = proposed(kb)
    for decide in (knowledge.accept, knowledge.withdraw):
        with pytest.raises(UnknownCorrection, match="no correction 99"):
            decide(kb, [number, 99], by="A. Smith")
    assert [each.standing for each in knowledge.corrections(kb)] == [Standing.PROPOSED]


def test_a_backup_restores_what_was_there(kb: str, tmp_path: Path) -> None:
    knowledge.accept(kb, [proposed(kb)], by="A. Smith")
    copy = tmp_path / "copy.db"
    made = knowledge.back_up(kb, copy)
    assert (made.outcomes, made.corrections, made.decisions) == (1200, 1, 1)
    place = usual_place("")
    assert knowledge.restore(copy, place) == made == knowledge.check(place)
    assert knowledge.corrections(place) == knowledge.corrections(kb)
    proposed(kb)
    with pytest.raises(StoreNotEmpty):
        knowledge.restore(copy, kb)


def test_an_absent_usual_file_is_an_empty_knowledge_base(tmp_path: Path) -> None:
    place = usual_place("")
    assert not knowledge.contexts(place)
    assert not knowledge.corrections(place)
    assert knowledge.outcomes_of_run(place, "1") == ()
    with knowledge.selected_outcomes(place, EVERYTHING) as found:
        assert list(found) == []
    with pytest.raises(StoreUnavailable):
        knowledge.check(place)
    with pytest.raises(StoreUnavailable):
        knowledge.contexts(str(tmp_path / "named.db"))
    assert not Path(place).exists()


def test_a_password_is_not_shown() -> None:
    assert knowledge.shown("postgresql://me:secret@host/db") == "postgresql://me@host/db"


def test_an_outcome_without_zone_is_the_callers_mistake(
    kb: str, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    naive = replace(shop_outcomes[0], recorded_at=datetime(2026, 3, 5))
    with pytest.raises(ValueError, match="has no time zone"):
        knowledge.record(kb, [shop_outcomes[0], naive])
    assert knowledge.newest(kb, EVERYTHING, limit=1).total == 1200
