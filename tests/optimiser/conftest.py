"""Plans for the parts of the examples, each made once."""

import pytest

from optimiser.advice import Plan
from optimiser.planning.formulate import OptimisationTask
from tests.optimiser.plans import measured


@pytest.fixture(scope="session")
def bracket() -> Plan:
    return measured("bracket", OptimisationTask())


@pytest.fixture(scope="session")
def shaft() -> Plan:
    return measured("shaft", OptimisationTask())


@pytest.fixture(scope="session")
def paper() -> Plan:
    return measured("paper002", OptimisationTask())
