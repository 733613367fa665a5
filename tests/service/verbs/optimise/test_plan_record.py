"""The JSON that others parse: fixed keys, units in the keys, no NaN."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from optimiser.advice import tightest
from service.rendering.columns import dump
from service.verbs.optimise import program as advising
from service.verbs.optimise.plan_result import ProgramAdvice
from tests.asking import asked_advice

PARTS = Path(__file__).parents[4] / "examples" / "parts"

LIMIT_KEYS = {"name", "value", "bound", "unit"}
STATE_KEYS = {
    "feed_mm_min", "spindle_rpm", "feed_per_tooth_mm", "axial_depth_mm", "passes",
    "plunge_feed_mm_min", "plunge_feed_per_tooth_mm",
}  # fmt: skip
STEP_KEYS = {
    "id", "operation", "tool", "programmed", "advised", "active_limit", "limits",
    "motor_power_kw", "cutting_force_n", "roughness_ra_um", "time_s", "stability", "plunge",
}  # fmt: skip
PLAN_KEYS = {"program", "mode", "machine", "workingsteps", "total_time_s", "findings"}
TIMES = {"before", "after"}


def advised(name: str, **wishes: Any) -> dict[str, Any]:
    request = asked_advice(file=PARTS / name, dry_run=True, **wishes)
    text = dump(advising.advise_program(*request).record())
    return dict(json.loads(text, parse_constant=refused))


def refused(word: str) -> None:
    raise AssertionError(f"{word} is no JSON")


@pytest.mark.parametrize("mode", ["TC", "QC", "EC"])
@pytest.mark.parametrize("name", ["bracket.stpnc", "paper002.stpnc", "shaft.stpnc"])
def test_a_plan_has_every_key(name: str, mode: str) -> None:
    plan = advised(name, mode=mode)
    assert plan.keys() >= PLAN_KEYS
    assert plan["total_time_s"].keys() == TIMES
    assert plan["workingsteps"]
    for step in plan["workingsteps"]:
        assert step.keys() >= STEP_KEYS
        assert step["time_s"].keys() == TIMES
        assert step["programmed"] is None or step["programmed"].keys() == STATE_KEYS
        assert step["advised"] is None or step["advised"].keys() == STATE_KEYS
        assert all(limit.keys() >= LIMIT_KEYS for limit in step["limits"])


def test_the_paper_is_advised_as_printed_in_shop_units() -> None:
    """Ridwan, Xu and Liu 2010, Table 2 and Fig. 11: 0.29 kW, 90 %, 3 mm, 35 m/min, 18 mm.

    By hand: 0.9 · 290 W / (1000 N/mm² · 18 mm · 3 mm) = 4.833 mm/s = 290.0 mm/min.
    """
    plan = advised("paper002.stpnc", machine="paper002")
    (step,) = plan["workingsteps"]
    best = step["advised"]
    assert best["feed_per_tooth_mm"] == pytest.approx(0.1171, rel=0.002)
    assert best["feed_mm_min"] == pytest.approx(290.0, rel=0.002)
    assert best["spindle_rpm"] == pytest.approx(618.9, rel=0.002)
    assert step["motor_power_kw"] == pytest.approx(0.29, rel=0.002)
    assert step["active_limit"] == "motor_power"
    assert best["axial_depth_mm"] == pytest.approx(3.0)
    assert best["passes"] == 1
    assert step["programmed"]["feed_per_tooth_mm"] == pytest.approx(0.05)


def test_the_active_limit_is_at_its_bound() -> None:
    for step in advised("bracket.stpnc")["workingsteps"]:
        if step["status"] != "advised":
            continue
        active = [each for each in step["limits"] if each["name"] == step["active_limit"]]
        assert min(abs(each["margin"]) for each in active) == pytest.approx(0.0, abs=1e-6)


def test_no_load_exceeds_its_greatest_value() -> None:
    for step in advised("bracket.stpnc")["workingsteps"]:
        if step["status"] != "advised":
            continue
        greatest = [each for each in step["limits"] if each["sense"] == "at most"]
        assert all(each["value"] <= each["bound"] * (1.0 + 1e-6) for each in greatest)


def test_totals_are_the_sum_of_the_workingsteps_that_were_timed() -> None:
    plan = advised("paper002.stpnc")
    steps = plan["workingsteps"]
    for when in ("before", "after"):
        total = sum(step["time_s"][when] for step in steps)
        assert plan["total_time_s"][when] == pytest.approx(total)


def test_a_number_that_is_no_number_is_no_json() -> None:
    plan = advising.advise_program(
        *asked_advice(file=PARTS / "paper002.stpnc", dry_run=True)
    ).plan
    advice = plan.advices[0]
    assert advice.after is not None
    broken = replace(advice, after=replace(advice.after, time=float("nan")))
    with pytest.raises(ValueError, match="JSON compliant"):
        dump(ProgramAdvice(plan=replace(plan, advices=(broken,))).record())


def test_each_limit_is_told_once_for_each_sense() -> None:
    plan = advising.advise_program(
        *asked_advice(file=PARTS / "bracket.stpnc", dry_run=True)
    ).plan
    for advice in plan.advices:
        state = advice.after or advice.before
        assert state is not None
        told = tightest(state.loads)
        pairs = [(load.limit.name, load.limit.sense) for load in told]
        assert len(pairs) == len(set(pairs))
        for load in state.loads:
            worst = told[pairs.index((load.limit.name, load.limit.sense))]
            assert worst.margin <= load.margin


def test_an_estimated_stability_is_told_with_its_band() -> None:
    found = [step["stability"] for step in advised("bracket.stpnc")["workingsteps"]]
    estimated = [each for each in found if each and each["basis"] == "estimated"]
    assert estimated
    for each in estimated:
        low, high = each["band_mm"]
        assert low <= each["stable_at_any_speed_mm"] <= high
    thin = [each for each in found if each and each["basis"] == "not_used"]
    assert all(each["stable_at_any_speed_mm"] is None for each in thin)
    # Drilling and reaming.
    assert None in found
