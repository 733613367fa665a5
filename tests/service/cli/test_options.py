"""What the commands share."""

from service import errors as exit_codes
from service.cli.interrupts import INTERRUPTED
from service.requests.fields import fields_of
from service.simulation.run_files import CodeOfRun
from stepnc_model.post.dialect import Dialect


def test_exit_codes_can_be_told_apart_and_usage_is_that_of_argparse() -> None:
    names = ("OK", "USAGE", "BAD_INPUT", "INFEASIBLE", "LIMIT_EXCEEDED")
    codes = {INTERRUPTED, *(getattr(exit_codes, name) for name in names)}
    assert len(codes) == len(names) + 1
    assert exit_codes.USAGE == 2


def test_every_control_is_named() -> None:
    (field,) = (each for each in fields_of(CodeOfRun) if each.name == "dialect")
    assert all(control.value in field.about.text for control in Dialect)
