"""A real LinuxCNC, where it is installed or may be."""

import pytest

from extras.linuxcnc.bench import reason_why_not
from simulator.library import load_machine
from simulator.spec import Machine
from tests.debian import installed


@pytest.fixture(scope="session")
def linuxcnc() -> None:
    """LinuxCNC is there; else the test is skipped, and says why."""
    installed("milltask", "linuxcnc-uspace")
    installed("gcc", "gcc")
    if reason := reason_why_not():
        pytest.skip(reason)


@pytest.fixture(scope="session")
def mill() -> Machine:
    return load_machine("vmc15")
