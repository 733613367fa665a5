"""What the outputs say of required limits that could not be looked at."""

from dataclasses import replace

import pytest

from optimiser.advice import Plan
from optimiser.cuts.source import from_features
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from service.cli.commands import print_result
from service.programs.advice_records import changes_of
from service.verbs.optimise.plan_record import unchecked_words
from service.verbs.optimise.plan_result import ProgramAdvice
from simulator.library import load_machine, load_material
from simulator.spec import Certainty, MaterialMatch
from tests.optimiser.plans import edited


@pytest.fixture(scope="module")
def plan() -> Plan:
    """C45 without its ISO group."""
    material = replace(load_material("c45"), iso_group="")
    return optimise_program(
        edited("paper002"),
        machine=load_machine("vmc15"),
        material=MaterialMatch(material=material, certainty=Certainty.EXACT, reason="asked"),
        task=OptimisationTask(source=from_features),
    )


def test_the_first_line_says_what_is_unchecked(
    plan: Plan, capsys: pytest.CaptureFixture[str]
) -> None:
    print_result(ProgramAdvice(plan=plan))
    first = capsys.readouterr().out.splitlines()[0]
    assert first.endswith("2 required limits are unchecked in 1 workingstep")


def test_the_json_lists_each_with_its_datum(plan: Plan) -> None:
    found = ProgramAdvice(plan=plan).record()
    assert found["is_checked"] is False
    (step,) = found["workingsteps"]
    assert {each["name"] for each in step["unchecked"]} == {"feed_per_tooth", "axial_depth"}
    assert all("iso_group" in each["datum"] for each in step["unchecked"])
    assert step["chatter_risk"]["depth_mm"] > step["chatter_risk"]["stable_mm"]


def test_the_report_and_the_record_say_so_too(plan: Plan) -> None:
    assert "Not fully checked" in ProgramAdvice(plan=plan).page()
    (change,) = changes_of(plan)
    assert change.record is not None
    assert "unchecked: feed per tooth, give iso_group" in change.record.description


def test_a_checked_plan_says_nothing(plan: Plan) -> None:
    checked = replace(plan, advices=tuple(replace(each, unchecked=()) for each in plan.advices))
    assert unchecked_words(checked) == ""
    assert ProgramAdvice(plan=checked).record()["is_checked"] is True
    assert "Not fully checked" not in ProgramAdvice(plan=checked).page()
