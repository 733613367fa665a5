"""What is plugged together: the program's course, its plan, its workingsteps."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from optimiser.modes import Mode
from service.control.expected_results import PlannedWorkingstep, planned_steps
from service.control.run import Session, prepare
from service.control.setup import (
    advices_in_order,
    hardness_against,
    plan_as_it_is,
    preview_of,
    steps_of,
)
from simulator.errors import UnknownMaterial
from simulator.library import load_material, material_path
from simulator.spec import Certainty, MaterialMatch
from stepnc_model.errors import StepNcError
from tests.asking import AskedControl


@pytest.fixture(scope="module")
def session(controlled: Callable[..., AskedControl]) -> Session:
    return prepare(*controlled())


def matched(name: str) -> MaterialMatch:
    return MaterialMatch(material=load_material(name), certainty=Certainty.EXACT, reason="")


def test_hardness_is_the_ratio_of_kienzle_forces() -> None:
    """C45 has k_c1.1 1500 and m_c 0.22, Inconel 718 3300 and 0.24; a chip of 0.1 mm."""
    ratio = hardness_against(matched("c45"))
    assert ratio("c45") == 1.0
    assert ratio("inconel718") == pytest.approx(3300.0 / 1500.0 * 0.1 ** (0.22 - 0.24))
    with pytest.raises(StepNcError, match="unknown material 'butter'"):
        ratio("butter")


def test_a_disturbance_names_a_material_and_reads_no_file() -> None:
    """Its words come from requests too: ``material:c45.toml@1s`` would read any file."""
    ratio = hardness_against(matched("c45"))
    for path in (str(material_path("c45")), "../../x.toml"):
        with pytest.raises(UnknownMaterial):
            ratio(path)


def test_the_law_is_told_of_forces_where_the_override_acts(session: Session) -> None:
    course = session.machine.course
    preview = preview_of(course)
    assert preview.until[-1] == course.duration
    assert not preview.force[~course.can_override].any()
    assert np.array_equal(preview.force[course.can_override], course.force[course.can_override])


def test_workingsteps_know_their_limits_and_their_cut(session: Session) -> None:
    planned = planned_steps(session.machine.course)
    (step,) = steps_of(planned, session.advices)
    assert step.reference.workingstep == "MILL SLOT"
    assert step.reference.bounds
    assert step.exponent == pytest.approx(1.0 - session.plan.material.material.kienzle.m_c)
    assert step.diameter == pytest.approx(10.0, rel=0.5)


def test_what_nothing_is_known_of_is_not_touched() -> None:
    (step,) = steps_of({1: PlannedWorkingstep()}, [None])
    assert step.reference.inhibition == "the program states no limits"


def test_the_plan_leaves_the_program_as_it_is(session: Session) -> None:
    plan = plan_as_it_is(
        session.program,
        session.virtual,
        material=session.plan.material,
        mode=Mode.TC,
        knowledge="",
    )
    for advice in plan.advices:
        assert advice.before is not None
        assert advice.after is not None
        assert advice.after.setting == advice.before.setting


def test_workingsteps_with_one_id_have_their_own_limits_in_order(session: Session) -> None:
    (first,) = session.plan.advices
    second, name = replace(first, reason="another"), first.workingstep.id
    found = advices_in_order((name, "", name, name), (first, second))
    assert found == (first, None, second, second)
