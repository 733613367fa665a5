"""What the commands share."""

from service.cli import options as cli_options
from service.cli.interrupts import INTERRUPTED
from stepnc_model.post.dialect import Dialect


def test_exit_codes_can_be_told_apart_and_none_is_that_of_usage() -> None:
    names = ("OK", "BAD_INPUT", "INFEASIBLE", "LIMIT_EXCEEDED")
    codes = {INTERRUPTED, *(getattr(cli_options, name) for name in names)}
    assert len(codes) == len(names) + 1
    assert 2 not in codes


def test_every_control_is_named() -> None:
    assert all(control.value in cli_options.CONTROLS for control in Dialect)
