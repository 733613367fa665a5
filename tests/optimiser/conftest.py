"""Plans for the parts of the examples, each made once."""

import pytest

from optimiser.advice import Plan
from optimiser.formulate import Task
from tests.optimiser.plans import measured


@pytest.fixture(scope="session")
def bracket() -> Plan:
    return measured("bracket", Task())


@pytest.fixture(scope="session")
def shaft() -> Plan:
    return measured("shaft", Task())


@pytest.fixture(scope="session")
def paper() -> Plan:
    return measured("paper002", Task())
