"""No control."""

import pytest

from controller.laws.open_loop import OpenLoop
from tests.controller.trial import Trial, run


def test_force_follows_the_depth() -> None:
    """500 N for each mm, at override 1."""
    done = run(OpenLoop(), Trial(noise=0.1))
    assert done.force[[0, 59, 119, 179]] == pytest.approx([1000.0, 1000.0, 2000.0, 500.0])
    assert (done.command == 1.0).all()


def test_guard_has_the_last_word() -> None:
    assert run(OpenLoop(), Trial(band=(0.1, 0.6))).command[-1] == 0.6
