"""The closed loop on a real LinuxCNC: a step that it takes back, and faults that end safely."""

from pathlib import Path

import pytest

from benchmarks.linuxcnc_faults import FAULTS, Fault, ended, short_program
from benchmarks.linuxcnc_loop import SET_POINT, runs
from controller.laws.choice import LawName

pytestmark = [pytest.mark.usefixtures("linuxcnc"), pytest.mark.slow]


def test_the_loop_takes_back_a_step_that_it_does_not_know() -> None:
    step = "hardness +40 %"
    open_loop, closed = runs((LawName.NONE, LawName.LOG_PI), (step,))
    # Without the loop all of the cut after the step is over the set point.
    assert open_loop.over > 5.0
    assert open_loop.peak == pytest.approx(1.4 * 190.0, rel=0.1)
    assert closed.over < 0.2 * open_loop.over
    assert closed.excess < 0.2 * open_loop.excess
    assert closed.peak < 1.2 * SET_POINT
    assert closed.least < 1.0


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_ends_in_a_safe_feed_and_is_told(fault: Fault, tmp_path: Path) -> None:
    found = ended(fault, short_program(tmp_path))
    assert found.feed <= fault.bound
    assert fault.words in found.event
