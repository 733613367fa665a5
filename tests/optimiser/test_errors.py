"""Errors of the optimiser belong to the one tree and say what is needed."""

import pytest

from optimiser.errors import Infeasible, OptimisationError, SolverFailed
from stepnc_model.errors import StepNcError


@pytest.mark.parametrize("error", [OptimisationError, Infeasible, SolverFailed])
def test_every_error_is_in_the_tree(error: type[Exception]) -> None:
    assert issubclass(error, StepNcError)


def test_infeasible_tells_its_sentence_and_keeps_the_names() -> None:
    error = Infeasible("a cap and a floor", limits=("motor_power", "chip_thickness"))
    assert str(error) == "a cap and a floor"
    assert error.limits == ("motor_power", "chip_thickness")


def test_failed_solver_says_what_it_said() -> None:
    error = SolverFailed("unbounded")
    assert error.status == "unbounded"
    assert "unbounded" in str(error)
