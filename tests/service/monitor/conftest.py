"""An agent that plays a run in real time."""

from collections.abc import Iterator

import pytest

from tests.service.monitor.played import PlayedAgent, looped
from tests.simulator.agent.conftest import serve

__all__ = ["serve"]


@pytest.fixture
def played() -> Iterator[PlayedAgent]:
    with PlayedAgent(*looped()) as agent:
        yield agent
